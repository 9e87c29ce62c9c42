#include "fit/odd_lights.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "capture/photometric_stereo.h"
#include "surface/error.h"
#include "surface/median.h"
#include "surface/parallel.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

// Light times strength, and what varies slowly over the picture, to the second degree.
using Unknowns = Eigen::Matrix<double, 8, 1>;
using Normal = Eigen::Matrix<double, 8, 8>;
using Eigen::Vector2d;

constexpr std::size_t kFewestPhotos = 8;
constexpr std::size_t kFewestPixels = 100;
constexpr int kMostPixels = 4000;
constexpr int kParts = 4;         // along each side, left out in turn
constexpr double kDark = 0.03;    // [1] of what the pixel would reflect: shadow
constexpr double kTukey = 4.685;  // [standard deviations] (Beaton and Tukey 1974)
constexpr int kSweeps = 8;
constexpr double kSuspect = 4, kLeastSuspect_deg = 8;  // [scatters] left out of the second look
constexpr double kOdd = 5, kLeastOdd_deg = 12;         // [scatters], what is told
constexpr double kSure = 5;                            // [standard errors]
constexpr double kMostScatter_deg = 6;                 // beyond, the painting tells nothing
constexpr double kLeastUnclipped = 0.7;  // [1] of a photograph: what is left over is chosen by its shading
constexpr double kAsClear = 0.5;         // [1] of what the relief explains of other photographs
constexpr std::size_t kNeighbours = 4;   // by direction: what is off in all of them is no slip
constexpr double kExplained = 4, kLeastExplained_deg = 5;  // [scatters] off another photograph's light
constexpr double kFarBetter = 3;  // times nearer that it must be than the photograph's own
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180 / std::numbers::pi;

struct Pixel {
    dvec2 place{0};  // [1] -1 to 1 along the longer side
    int part = 0;
    dvec3 g{0};  // ρd times the normal
    bool valid = false;
    std::vector<double> values;  // of each photograph; NaN where clipped or not there
};

std::vector<Pixel> pixels_of(const Survey& survey, const Transfer& transfer, std::size_t photos, int width,
                             int height) {
    const int step = std::max(1, (survey.sample_count() + kMostPixels - 1) / kMostPixels);
    const auto channels = static_cast<std::size_t>(survey.channels);
    const double half = std::max(width, height) / 2.0;
    std::vector<Pixel> pixels;
    for (int k = 0; k < survey.sample_count(); k += step) {
        const glm::ivec2 at = survey.positions[static_cast<std::size_t>(k)];
        Pixel pixel;
        pixel.place = {(at.x - width / 2.0) / half, (height / 2.0 - at.y) / half};
        pixel.part = std::min(kParts * at.y / height, kParts - 1) * kParts +
                     std::min(kParts * at.x / width, kParts - 1);
        for (std::size_t i = 0; i < photos; ++i) {
            const float stored = survey.sample(k)[i * channels + channels / 2];
            pixel.values.push_back(std::isfinite(stored) && stored < kClipped
                                       ? static_cast<double>(transfer.decode(stored))
                                       : kUnknown);
        }
        pixels.push_back(std::move(pixel));
    }
    return pixels;
}

// g of each pixel from the photographs that are used.
void find_surface(std::vector<Pixel>& pixels, const std::vector<Light>& lights,
                  const std::vector<bool>& used) {
    parallel_for(0, static_cast<int>(pixels.size()), 16, [&](int begin, int end) {
        PixelSamples samples;
        samples.resize(static_cast<int>(lights.size()), 1);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            samples.light[i] = dvec3(lights[i].direction);
            samples.irradiance[i] = static_cast<double>(lights[i].gain.g);
        }
        for (int k = begin; k < end; ++k) {
            Pixel& pixel = pixels[static_cast<std::size_t>(k)];
            for (std::size_t i = 0; i < lights.size(); ++i) {
                const bool known = used[i] && !std::isnan(pixel.values[i]);
                samples.value[i] = known ? pixel.values[i] : 0;
                samples.sigma[i] = known ? 1 : 0;
            }
            const LambertEstimate estimate = photometric_stereo(samples);
            pixel.valid = estimate.valid && estimate.diffuse.x > 0;
            pixel.g = estimate.diffuse.x * estimate.normal;
        }
    });
}

Unknowns row_of(const Pixel& pixel) {
    const dvec2 at = pixel.place;
    const double z = pixel.g.z;
    Unknowns row;
    row << pixel.g.x, pixel.g.y, z, z * at.x, z * at.y, z * at.x * at.x, z * at.x * at.y, z * at.y * at.y;
    return row / glm::length(pixel.g);
}

struct Sums {
    Normal matrix = Normal::Zero();
    Unknowns right = Unknowns::Zero();
    double squares = 0;

    Sums& operator+=(const Sums& o) {
        matrix += o.matrix, right += o.right, squares += o.squares;
        return *this;
    }
    // [1] Part of what is left over without a side that it explains.
    double explained() const {
        const double all = squares - right.dot(Eigen::LDLT<Normal>(matrix).solve(right));
        const Eigen::Matrix<double, 6, 6> even = matrix.bottomRightCorner<6, 6>();
        const Eigen::Matrix<double, 6, 1> even_right = right.tail<6>();
        const double without = squares - even_right.dot(even.ldlt().solve(even_right));
        return without > 0 ? std::clamp(1 - all / without, 0.0, 1.0) : 0;
    }
    // [unit vector] Where in the picture's plane the light comes from.
    std::optional<Vector2d> side() const {
        const Eigen::LDLT<Normal> solver(matrix);
        if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) return std::nullopt;
        const Unknowns x = solver.solve(right);
        const Vector2d s = x.head<2>();
        if (!(s.norm() > 0) || !std::isfinite(s.norm())) return std::nullopt;
        return s.normalized();
    }
};

// [rad] Between two directions in the picture's plane.
double angle_between(const Vector2d& a, const Vector2d& b) {
    return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

// [deg] Between two lights of one height whose sides differ by an angle [rad]; `plane` [1] is the length of
// what they have in the picture's plane.
double on_sphere_deg(double angle, double plane) {
    return 2 * std::asin(std::min(plane, 1.0) * std::sin(angle / 2)) * kDegrees;
}

struct Shown {
    Vector2d side{1, 0};   // [unit vector]
    double sigma = 0;      // [rad]
    double explained = 0;  // [1]
};

// The light that one photograph shows, by regression with Tukey's weights.
std::optional<Shown> shown_by(std::size_t photo, const std::vector<Pixel>& pixels) {
    struct Sample {
        Unknowns row;
        double value;
        int part;
        double weight = 1;
    };
    std::vector<Sample> samples;
    std::vector<double> brightness;
    for (const Pixel& pixel : pixels)
        if (pixel.valid && !std::isnan(pixel.values[photo])) {
            const double value = pixel.values[photo] / glm::length(pixel.g);
            samples.push_back({row_of(pixel), value, pixel.part});
            brightness.push_back(value);
        }
    const auto valid = static_cast<double>(
        std::count_if(pixels.begin(), pixels.end(), [](const Pixel& p) { return p.valid; }));
    if (samples.size() < kFewestPixels || static_cast<double>(samples.size()) < kLeastUnclipped * valid)
        return std::nullopt;
    const double dark = kDark * median(brightness);
    std::erase_if(samples, [&](const Sample& s) { return s.value < dark; });
    if (samples.size() < kFewestPixels) return std::nullopt;
    std::array<Sums, kParts * kParts> parts;
    Sums all;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        all = {};
        parts = {};
        for (const Sample& s : samples) {
            Sums& part = parts[static_cast<std::size_t>(s.part)];
            part.matrix += s.weight * s.row * s.row.transpose();
            part.right += s.weight * s.value * s.row;
            part.squares += s.weight * s.value * s.value;
        }
        for (const Sums& part : parts) all += part;
        const Unknowns x = Eigen::LDLT<Normal>(all.matrix).solve(all.right);
        std::vector<double> residuals;
        for (const Sample& s : samples) residuals.push_back(std::abs(s.value - s.row.dot(x)));
        const double limit = kTukey * std::max(1.4826 * median(residuals), 1e-12);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double r = residuals[i] / limit, w = std::max(1 - r * r, 0.0);
            samples[i].weight = w * w;
        }
    }
    const std::optional<Vector2d> side = all.side();
    if (!side) return std::nullopt;
    double squares = 0;
    int count = 0;
    for (const Sums& part : parts) {
        if (!(part.matrix(0, 0) > 0)) continue;
        const auto without = Sums{all.matrix - part.matrix, all.right - part.right}.side();
        if (!without) return std::nullopt;
        const double turned = angle_between(*without, *side);
        squares += turned * turned, ++count;
    }
    if (count < kParts) return std::nullopt;
    return Shown{*side, std::sqrt(squares * (count - 1) / count), all.explained()};
}

Vector2d plane_of(const Light& light) {
    return {static_cast<double>(light.direction.x), static_cast<double>(light.direction.y)};
}

// An affine map of the x and y of directions, as listed, to those that photographs show.
struct DirectionMap {
    Eigen::Matrix<double, 2, 3> affine = (Eigen::Matrix<double, 2, 3>() << 1, 0, 0, 0, 1, 0).finished();

    Vector2d operator()(const Vector2d& v) const { return affine * v.homogeneous(); }
    // A side that is shown, of a light whose part in the picture's plane has this length, as it is listed.
    Vector2d back(const Vector2d& side, double plane) const {
        const Eigen::Matrix2d linear = affine.leftCols<2>();
        if (!(std::abs(linear.determinant()) > 0.05)) return plane * side;
        return plane * (linear.inverse() * (plane * side - affine.col(2))).normalized();
    }
    // [deg] How far from a light is what a photograph shows.
    double off_deg(const Shown& shown, const Light& light) const {
        const Vector2d listed = plane_of(light);
        return on_sphere_deg(angle_between(shown.side, (*this)(listed)), listed.norm());
    }
};

struct Judged {
    std::vector<std::optional<Shown>> shown;
    DirectionMap map;
    std::vector<double> off_deg;  // NaN where nothing is shown
    double scatter_deg = 0;
};

// Medians of what the used photographs are off, from 0.
double scatter_of(const std::vector<double>& off_deg, const std::vector<bool>& used) {
    std::vector<double> known;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i] && !std::isnan(off_deg[i])) known.push_back(off_deg[i]);
    return known.empty() ? 0 : 1.4826 * median(known);
}

void measure_off(Judged& judged, const std::vector<Light>& lights, const std::vector<bool>& used) {
    judged.off_deg.assign(lights.size(), kUnknown);
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (judged.shown[i]) judged.off_deg[i] = judged.map.off_deg(*judged.shown[i], lights[i]);
    judged.scatter_deg = scatter_of(judged.off_deg, used);
}

Judged judge(std::vector<Pixel>& pixels, const std::vector<Light>& lights, const std::vector<bool>& used) {
    find_surface(pixels, lights, used);
    Judged judged;
    judged.shown.resize(lights.size());
    parallel_for(0, static_cast<int>(lights.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            judged.shown[i] = shown_by(i, pixels);
    });
    measure_off(judged, lights, used);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        Eigen::Matrix3d matrix = 1e-6 * Eigen::Matrix3d::Identity();
        Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
        const double limit = kTukey * std::max(judged.scatter_deg, 0.5);
        int count = 0;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            if (!used[i] || std::isnan(judged.off_deg[i]) || judged.off_deg[i] > limit) continue;
            const double r = judged.off_deg[i] / limit, weight = (1 - r * r) * (1 - r * r);
            const Vector2d listed = plane_of(lights[i]), to = listed.norm() * judged.shown[i]->side;
            matrix += weight * listed.homogeneous() * listed.homogeneous().transpose();
            right += weight * listed.homogeneous() * to.transpose();
            ++count;
        }
        if (count < static_cast<int>(kFewestPhotos) / 2) break;
        judged.map.affine = matrix.ldlt().solve(right).transpose();
        measure_off(judged, lights, used);
    }
    return judged;
}

// The photographs that stand out, but no more than a third of all, are not used.
std::vector<bool> without_suspects(const Judged& judged) {
    const double limit = std::max(kSuspect * judged.scatter_deg, kLeastSuspect_deg);
    std::vector<std::size_t> suspects;
    for (std::size_t i = 0; i < judged.off_deg.size(); ++i)
        if (judged.off_deg[i] > limit) suspects.push_back(i);
    std::stable_sort(suspects.begin(), suspects.end(),
                     [&](std::size_t a, std::size_t b) { return judged.off_deg[a] > judged.off_deg[b]; });
    suspects.resize(std::min(suspects.size(), judged.off_deg.size() / 3));
    std::vector<bool> used(judged.off_deg.size(), true);
    for (const std::size_t i : suspects) used[i] = false;
    return used;
}

// [deg] What the photographs with the nearest lights are off.
double off_nearby(const Judged& judged, const std::vector<Light>& lights, std::size_t photo) {
    std::vector<std::pair<float, float>> others;  // nearness, and off
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (i != photo && !std::isnan(judged.off_deg[i]))
            others.emplace_back(glm::dot(lights[i].direction, lights[photo].direction),
                                static_cast<float>(judged.off_deg[i]));
    std::sort(others.begin(), others.end(), std::greater<>());
    std::vector<float> off;
    for (std::size_t k = 0; k < std::min(kNeighbours, others.size()); ++k) off.push_back(others[k].second);
    return off.empty() ? 0 : static_cast<double>(median(std::move(off)));
}

// Whether a photograph stands out from all, and from those with the nearest lights, and shows its light as
// clearly as others do.
bool is_odd(const Judged& judged, const std::vector<Light>& lights, std::size_t photo,
            double middling_explained) {
    const double off_deg = judged.off_deg[photo];
    if (!(off_deg > std::max(kOdd * judged.scatter_deg, kLeastOdd_deg))) return false;
    const Shown& shown = *judged.shown[photo];
    return off_deg > kSure * plane_of(lights[photo]).norm() * shown.sigma * kDegrees &&
           shown.explained > kAsClear * middling_explained &&
           off_deg > kFarBetter * off_nearby(judged, lights, photo);
}

// Pairs of odd photographs that each other's light explains.
void find_exchanged(const Judged& judged, const std::vector<Light>& lights, std::vector<OddLight>& odd) {
    const double near = std::max(kExplained * judged.scatter_deg, kLeastExplained_deg);
    for (OddLight& a : odd)
        for (OddLight& b : odd) {
            if (a.photo >= b.photo || a.exchanged_with || b.exchanged_with) continue;
            const double of_a = judged.map.off_deg(*judged.shown[a.photo], lights[b.photo]);
            const double of_b = judged.map.off_deg(*judged.shown[b.photo], lights[a.photo]);
            if (std::max(of_a, of_b) > near || kFarBetter * of_a > a.off_deg || kFarBetter * of_b > b.off_deg)
                continue;
            a.exchanged_with = b.photo, a.exchanged_off_deg = of_a;
            b.exchanged_with = a.photo, b.exchanged_off_deg = of_b;
        }
}

}  // namespace

LightOutliers odd_lights(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                         int width, int height) {
    TP_REQUIRE(survey.photos.size() == lights.size(), "one light a photograph");
    LightOutliers result;
    if (lights.size() < kFewestPhotos) return result;
    std::vector<Pixel> pixels = pixels_of(survey, transfer, lights.size(), width, height);
    Judged judged = judge(pixels, lights, std::vector<bool>(lights.size(), true));
    const std::vector<bool> used = without_suspects(judged);
    if (std::find(used.begin(), used.end(), false) != used.end()) judged = judge(pixels, lights, used);
    result.off_deg = judged.off_deg;
    result.scatter_deg = judged.scatter_deg;
    if (judged.scatter_deg > kMostScatter_deg) return result;
    std::vector<double> explained;
    for (const std::optional<Shown>& shown : judged.shown)
        if (shown) explained.push_back(shown->explained);
    if (explained.size() < kFewestPhotos) return result;
    const double middling = median(std::move(explained));
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (!is_odd(judged, lights, i, middling)) continue;
        const Shown& shown = *judged.shown[i];
        const double plane = plane_of(lights[i]).norm(), sigma_deg = plane * shown.sigma * kDegrees;
        const Vector2d side = judged.map.back(shown.side, plane);
        result.odd.push_back(
            {i, judged.off_deg[i], sigma_deg,
             Vec3(static_cast<float>(side.x()), static_cast<float>(side.y()), lights[i].direction.z)});
    }
    find_exchanged(judged, lights, result.odd);
    return result;
}

std::vector<std::string> doubts_of(const LightOutliers& outliers, const std::vector<std::string>& names) {
    std::vector<std::string> doubts;
    for (const OddLight& odd : outliers.odd) {
        const std::string& name = names[odd.photo];
        if (!odd.exchanged_with) {
            doubts.push_back(fmt::format(
                "{}: is shaded by a light {:.0f} ± {:.0f} degrees aside from the one listed for it (other "
                "photographs: {:.1f}), at about ({:.2f} {:.2f} {:.2f}) if it is as high; correct its line in "
                "the lights file, or take it out",
                name, odd.off_deg, odd.sigma_deg, outliers.scatter_deg, odd.shown.x, odd.shown.y,
                odd.shown.z));
            continue;
        }
        if (*odd.exchanged_with < odd.photo) continue;
        const auto other = std::find_if(outliers.odd.begin(), outliers.odd.end(),
                                        [&](const OddLight& o) { return o.photo == *odd.exchanged_with; });
        doubts.push_back(fmt::format(
            "{} and {}: each is shaded by the other's light (their own are off by {:.0f} and {:.0f} degrees, "
            "each other's by {:.1f} and {:.1f}; other photographs': {:.1f}); exchange their lights in the "
            "lights file",
            name, names[other->photo], odd.off_deg, other->off_deg, odd.exchanged_off_deg,
            other->exchanged_off_deg, outliers.scatter_deg));
    }
    return doubts;
}

nlohmann::json to_json(const LightOutliers& outliers, const std::vector<std::string>& names) {
    nlohmann::json odd = nlohmann::json::array();
    for (const OddLight& light : outliers.odd)
        odd.push_back({{"name", names[light.photo]},
                       {"off_deg", light.off_deg},
                       {"sigma_deg", light.sigma_deg},
                       {"shown", {light.shown.x, light.shown.y, light.shown.z}},
                       {"exchanged_with", light.exchanged_with ? nlohmann::json(names[*light.exchanged_with])
                                                               : nlohmann::json(nullptr)}});
    return {{"scatter_deg", outliers.scatter_deg}, {"odd", std::move(odd)}};
}

}  // namespace tangi
