#include "datasets/positions.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <numbers>

#include "surface/base/json_text.h"
#include "surface/base/noise.h"
#include "surface/file/atomic_file.h"
#include "surface/maps/photography_json.h"

namespace tangi {

namespace fs = std::filesystem;
using glm::dmat3;
using glm::dvec2;
using glm::dvec3;
using procedural::hash;
using procedural::Seed;

namespace {

constexpr double kRadiansOfDegree = std::numbers::pi / 180;
constexpr double kMostSigmas = 2.5;

// How far a camera is off, in standard deviations.
struct Misplacement {
    dvec2 shift{0}, tilt{0};
    double roll = 0, zoom = 0, exposure = 0;
};

Misplacement misplacement(Seed seed) {
    const auto pair = [&](std::uint64_t which) {
        const auto [a, b] = procedural::normal_pair(hash(seed, which));
        return glm::clamp(dvec2(a, b), dvec2(-kMostSigmas), dvec2(kMostSigmas));
    };
    const dvec2 turns = pair(2), rest = pair(3);
    return {pair(0), pair(1), turns.x, turns.y, rest.x};
}

// About the camera's axes, first around its own axis, then up and down, then sideways.
dmat3 rotation_of(double roll, double x, double y) {
    const dmat3 about_z(std::cos(roll), std::sin(roll), 0, -std::sin(roll), std::cos(roll), 0, 0, 0, 1);
    const dmat3 about_x(1, 0, 0, 0, std::cos(x), std::sin(x), 0, -std::sin(x), std::cos(x));
    const dmat3 about_y(std::cos(y), 0, -std::sin(y), 0, 1, 0, std::sin(y), 0, std::cos(y));
    return about_y * about_x * about_z;
}

// Point of the painting's plane [mm] -> pixel of a pinhole camera that looks at `target_mm` from a distance.
Homography to_pixel(const PaintingView& view, const dvec2& target_mm, double distance_mm) {
    const dvec3 x = view.rotation[0], y = view.rotation[1];  // the plane's axes in the camera's frame
    const dmat3 projected(dvec3(distance_mm * dvec2(x), -x.z), dvec3(distance_mm * dvec2(y), -y.z),
                          dvec3(0, 0, distance_mm));
    const dmat3 from_target(1, 0, 0, 0, 1, 0, -target_mm.x, -target_mm.y, 1);
    const double pixels = 1 / view.mm_per_pixel;
    const dmat3 in_pixels(pixels, 0, 0, 0, -pixels, 0, (view.width - 1) / 2.0, (view.height - 1) / 2.0, 1);
    return in_pixels * projected * from_target;
}

// [mm] of the painting's plane -> its pixel.
Homography painting_pixels(const PaintingOptions& o) {
    const double pixels = 1 / o.mm_per_pixel;
    return {pixels, 0, 0, 0, -pixels, 0, (o.width - 1) / 2.0, (o.height - 1) / 2.0, 1};
}

// All positions, if their pictures were to cover the painting less `margin` pixels on each side.
std::vector<CameraPosition> positions_within(double margin, const PaintingOptions& painting,
                                             const PositionsOptions& o) {
    const dvec2 counts(o.columns, o.rows);
    const dvec2 area = dvec2(painting.width, painting.height) - 2 * margin;
    const dvec2 size = glm::floor(area / (counts - (counts - 1.0) * o.overlap));
    if (size.x < 16 || size.y < 16)
        fail("a painting of {} x {} pixels is too small for {} x {} positions; give a larger one",
             painting.width, painting.height, o.columns, o.rows);
    std::vector<CameraPosition> positions;
    for (int row = 0; row < o.rows; ++row)
        for (int column = 0; column < o.columns; ++column) {
            const Misplacement off = misplacement(hash(hash(painting.seed, 0x706f73), positions.size()));
            CameraPosition position;
            position.name = fmt::format("r{}_c{}", row, column);
            position.column = column, position.row = row;
            PaintingView& view = position.view;
            view.width = static_cast<int>(size.x), view.height = static_cast<int>(size.y);
            view.mm_per_pixel = painting.mm_per_pixel * (1 + o.position_zoom * off.zoom);
            const dvec2 tilt = o.position_tilt_deg * kRadiansOfDegree * off.tilt;
            view.rotation = rotation_of(o.position_roll_deg * kRadiansOfDegree * off.roll, tilt.x, tilt.y);
            const dvec2 steps = dvec2(column, row) - (counts - 1.0) / 2.0;
            dvec2 target = painting.mm_per_pixel * (1 - o.overlap) * size * steps;
            target =
                dvec2(target.x, -target.y) + o.position_shift * size.x * painting.mm_per_pixel * off.shift;
            const double distance = o.camera_distance * size.x * view.mm_per_pixel;
            view.to_mm = glm::inverse(to_pixel(view, target, distance));
            position.to_painting = normalised(painting_pixels(painting) * view.to_mm);
            position.exposure = std::exp(o.position_exposure * off.exposure);
            positions.push_back(std::move(position));
        }
    return positions;
}

// [pixels] by which a picture lies outside of the painting, at most.
double overshoot(const CameraPosition& position, const PaintingOptions& painting) {
    double most = 0;
    const double right = position.view.width - 0.5, bottom = position.view.height - 0.5;
    for (const dvec2& corner : {dvec2(-0.5), dvec2(right, -0.5), dvec2(right, bottom), dvec2(-0.5, bottom)}) {
        const dvec2 p = mapped(position.to_painting, corner) + 0.5;
        most = std::max({most, -p.x, -p.y, p.x - painting.width, p.y - painting.height});
    }
    return most;
}

nlohmann::json as_json(const CameraPosition& p) {
    return {{"name", p.name},
            {"column", p.column},
            {"row", p.row},
            {"width", p.view.width},
            {"height", p.view.height},
            {"mm_per_pixel", p.view.mm_per_pixel},
            {"to_painting", to_json(p.to_painting)},
            {"rotation", to_json(p.view.rotation)},
            {"exposure", p.exposure}};
}

}  // namespace

std::vector<CameraPosition> camera_positions(const PaintingOptions& painting,
                                             const PositionsOptions& options) {
    validate(painting);
    validate(options);
    double margin = 0;
    // What is taken off makes pictures smaller, and what their cameras are off by with them.
    for (const CameraPosition& p : positions_within(0, painting, options))
        margin = std::max(margin, std::ceil(overshoot(p, painting)));
    return positions_within(margin, painting, options);
}

nlohmann::json write_positions(const fs::path& folder, const PaintingOptions& painting,
                               const PositionsOptions& options, const GeneratorOptions& photos,
                               const Progress& progress) {
    require_valid(photos);
    const std::vector<CameraPosition> positions = camera_positions(painting, options);
    nlohmann::json list = nlohmann::json::array();
    for (const CameraPosition& position : positions) {
        const auto number = static_cast<double>(list.size()), all = static_cast<double>(positions.size());
        const Progress part([&](std::string_view, double done) {
            return !progress || progress(position.name, (number + done) / all);
        });
        GeneratorOptions own = photos;
        own.seed = hash(photos.seed, list.size() + 1) >> 12;  // other noise; JSON keeps 52 bits
        own.white_level *= position.exposure;
        const PaintingTruth truth = procedural_painting(painting, position.view, part);
        write_stack(folder / position.name, truth, own, part);
        list.push_back(as_json(position));
    }
    if (options.whole_truth) {
        const PaintingTruth truth = procedural_painting(painting, progress);
        write_truth(folder / "gt", truth, {}, photos);
    }
    return {{"width", painting.width},
            {"height", painting.height},
            {"mm_per_pixel", painting.mm_per_pixel},
            {"positions", list},
            {"options", to_json(options)}};
}

}  // namespace tangi
