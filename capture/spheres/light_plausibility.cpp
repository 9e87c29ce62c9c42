// light_plausibility.cpp: see light_plausibility.h.
#include "capture/spheres/light_plausibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>
#include <vector>

#include "capture/registration/edge_field.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr std::size_t kFewest = 8;      // photographs
constexpr int kDeals = 99;              // random ones
constexpr double kAcross = 40;          // samples across the picture
constexpr double kLeastChange = 0.05;   // [1] rms relative change of a pixel that tells something
constexpr double kSteepest = 3;         // l.xy / l.z at most: beyond, shadows rule
constexpr double kFewestPixels = 0.25;  // [1] that change: edges that are not quite registered are fewer
constexpr float kLeastLevel = 4;  // [codes, or standard deviations of noise] below, what changes is rounding

using Row = std::vector<double>;

// Orthonormal, each of the length of the photographs: what a slope in x and one in y do, less their means.
std::vector<Row> basis_of(const std::vector<glm::dvec3>& directions) {
    std::vector<Row> basis;
    for (int axis = 0; axis < 2; ++axis) {
        Row row;
        for (const glm::dvec3& d : directions)
            row.push_back(std::clamp(d[axis] / std::max(d.z, 0.05), -kSteepest, kSteepest));
        const double mean = std::accumulate(row.begin(), row.end(), 0.0) / static_cast<double>(row.size());
        for (double& value : row) value -= mean;
        for (const Row& other : basis) {
            const double along = std::inner_product(row.begin(), row.end(), other.begin(), 0.0);
            for (std::size_t i = 0; i < row.size(); ++i) row[i] -= along * other[i];
        }
        const double length = std::sqrt(std::inner_product(row.begin(), row.end(), row.begin(), 0.0));
        if (!(length > 1e-6)) continue;
        for (double& value : row) value /= length;
        basis.push_back(std::move(row));
    }
    return basis;
}

// [reduced px] How far a place moved in a photograph.
glm::dvec2 shift_of(const GreyPhotos& photos, const CameraMotions& drifts, std::size_t photo,
                    const glm::ivec2& at) {
    const glm::dvec2 place(photos.full(at.x), photos.full(at.y)),
        middle((photos.width - 1) / 2.0, (photos.height - 1) / 2.0);
    return (drifts.photos[photo].to_photo(place, middle) - place) / static_cast<double>(photos.reduction);
}

// Mean of the 9 pixels around a place: what is left of the drift makes little of edges then.
double value_near(const Image<float>& photo, const glm::dvec2& place) {
    const int x = static_cast<int>(std::floor(place.x)), y = static_cast<int>(std::floor(place.y));
    const double u = place.x - x, v = place.y - y;
    double sum = 0;
    for (int dy = -1; dy <= 2; ++dy)
        for (int dx = -1; dx <= 2; ++dx)
            sum += (dx < 0   ? 1 - u
                    : dx > 1 ? u
                             : 1) *
                   (dy < 0   ? 1 - v
                    : dy > 1 ? v
                             : 1) *
                   static_cast<double>(photo.clamped(x + dx, y + dy));
    return sum / 9;
}

// [1] As stored: what is darker tells nothing of lights.
double least_level(const GreyPhotos& photos, const std::vector<std::size_t>& used) {
    std::vector<float> noise;
    for (const std::size_t i : used) noise.push_back(dark_noise(photos.mean[i]));
    return static_cast<double>(kLeastLevel * std::max(photos.step, median(noise)));
}

// Leaves out the places that are dark in the mean of all photographs.
void keep_lit(std::vector<Row>& rows, double least) {
    std::erase_if(rows, [&](const Row& row) {
        return std::accumulate(row.begin(), row.end(), 0.0) < least * static_cast<double>(row.size());
    });
}

// Each photograph divided by its median; false where one is too dark for that.
bool normalise(std::vector<Row>& rows, std::size_t photos, double least) {
    for (std::size_t i = 0; i < photos; ++i) {
        std::vector<float> values;
        for (const Row& row : rows) values.push_back(static_cast<float>(row[i]));
        const double middle = values.empty() ? 0 : static_cast<double>(median(values));
        if (middle < least) return false;
        for (Row& row : rows) row[i] /= middle;
    }
    return true;
}

// Pixels, each less its mean over the photographs; those that hardly change are left out, and those that are
// as dark as what a code is worth. Nothing where hardly any are left.
std::vector<Row> changes_of(const GreyPhotos& photos, const CameraMotions& drifts,
                            const std::vector<std::size_t>& used, std::span<const ShadedCircle> without) {
    const int width = photos.mean[0].width(), height = photos.mean[0].height();
    const int step = std::max(1, static_cast<int>(std::min(width, height) / kAcross));
    std::vector<glm::ivec2> places;
    for (int y = step / 2; y < height; y += step)
        for (int x = step / 2; x < width; x += step) {
            const glm::dvec2 at(photos.full(x), photos.full(y));
            if (std::none_of(without.begin(), without.end(), [&](const ShadedCircle& circle) {
                    return glm::length(at - circle.centre_px) < circle.radius_px;
                }))
                places.emplace_back(x, y);
        }
    std::vector<Row> rows(places.size(), Row(used.size()));
    for (std::size_t i = 0; i < used.size(); ++i) {
        const Image<float>& photo = photos.mean[used[i]];
        for (std::size_t p = 0; p < places.size(); ++p)
            rows[p][i] =
                value_near(photo, glm::dvec2(places[p]) + shift_of(photos, drifts, used[i], places[p]));
    }
    const double least = least_level(photos, used);
    keep_lit(rows, least);
    if (!normalise(rows, used.size(), least)) return {};
    std::vector<Row> changes;
    for (Row& row : rows) {
        const double mean = std::accumulate(row.begin(), row.end(), 0.0) / static_cast<double>(row.size());
        if (!(mean > 0.02)) continue;
        double squares = 0;
        for (double& value : row) {
            value = std::clamp(value / mean - 1, -1.0, 1.0);  // a highlight counts as much as a shadow
            squares += value * value;
        }
        if (squares > kLeastChange * kLeastChange * static_cast<double>(row.size()))
            changes.push_back(std::move(row));
    }
    if (static_cast<double>(changes.size()) < kFewestPixels * static_cast<double>(places.size())) return {};
    return changes;
}

double explained(const std::vector<Row>& changes, const std::vector<Row>& basis,
                 const std::vector<std::size_t>& deal) {
    double sum = 0;
    for (const Row& row : changes)
        for (const Row& b : basis) {
            double along = 0;
            for (std::size_t i = 0; i < deal.size(); ++i) along += b[deal[i]] * row[i];
            sum += along * along;
        }
    return sum;
}

}  // namespace

std::optional<double> chance_of_directions(const GreyPhotos& photos, const CameraMotions& drifts,
                                           std::span<const std::optional<glm::dvec3>> directions,
                                           std::span<const ShadedCircle> without) {
    std::vector<std::size_t> used;
    std::vector<glm::dvec3> to_lights;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (!directions[i]) continue;
        used.push_back(i);
        to_lights.push_back(*directions[i]);
    }
    if (used.size() < kFewest) return std::nullopt;
    const std::vector<Row> basis = basis_of(to_lights), changes = changes_of(photos, drifts, used, without);
    if (basis.empty() || changes.empty()) return std::nullopt;
    std::vector<std::size_t> deal(used.size());
    std::iota(deal.begin(), deal.end(), std::size_t{0});
    const double here = explained(changes, basis, deal);
    std::mt19937 random(1);
    int as_well = 0;
    for (int turn = 0; turn < kDeals; ++turn) {
        for (std::size_t i = deal.size() - 1; i > 0; --i) std::swap(deal[i], deal[random() % (i + 1)]);
        as_well += explained(changes, basis, deal) >= here;
    }
    return as_well / static_cast<double>(kDeals);
}

}  // namespace tangi
