#include "fit/light_checks/light_outliers.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "fit/light_checks/per_photo_light.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

using Eigen::Vector2d;

constexpr std::size_t kFewestPhotos = 8;
constexpr std::size_t kFewestForHeights = 10;  // of five numbers
constexpr double kTukey = 4.685;               // [standard deviations] (Beaton and Tukey 1974)
constexpr int kSweeps = 8;
constexpr double kSuspect = 4, kLeastSuspect_deg = 8;  // [scatters] left out of the second look
constexpr double kOdd = 5, kLeastOdd_deg = 12;         // [scatters], what is told
constexpr double kSure = 5;                            // [standard errors]
constexpr double kMostScatter_deg = 6;                 // beyond, the painting tells nothing
constexpr double kAsClear = 0.5;                       // [1] of what the relief explains of other photographs
constexpr std::size_t kNeighbours = 4;                 // by direction: what is off in all of them is no slip
constexpr double kExplained = 4, kLeastExplained_deg = 5;  // [scatters] off another photograph's light
constexpr double kFarBetter = 3;     // times nearer that it must be than the photograph's own
constexpr double kLeastPlane = 0.2;  // [1] of a light in the picture's plane, for it to have a side
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// [deg] Between two lights of one height whose sides differ by an angle [rad]; `plane` [1] is the length of
// what they have in the picture's plane.
double on_sphere_deg(double angle, double plane) {
    return 2 * std::asin(std::min(plane, 1.0) * std::sin(angle / 2)) * kDegrees;
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
    double off_deg(const ShownLight& shown, const Light& light) const {
        const Vector2d listed = plane_of(light);
        return on_sphere_deg(angle_between(shown.side, (*this)(listed)), listed.norm());
    }
};

// How far from above lights are listed, by what photographs show of it and from which side [rad].
struct HeightMap {
    std::array<double, 5> c{0, 1, 0, 0, 0};

    static std::array<double, 5> terms(const ShownLight& shown) {
        const double z = shown.zenith_rad;
        return {1, z, z * z, shown.side.x(), shown.side.y()};
    }
    double operator()(const ShownLight& shown) const {
        const auto t = terms(shown);
        return std::inner_product(c.begin(), c.end(), t.begin(), 0.0);
    }
    // [deg] How much higher than listed a photograph shows its light.
    double higher_deg(const ShownLight& shown, const Light& light) const {
        return (std::acos(std::clamp(static_cast<double>(light.direction.z), -1.0, 1.0)) - (*this)(shown)) *
               kDegrees;
    }
};

struct Judged {
    std::vector<std::optional<ShownLight>> shown;
    DirectionMap map;
    HeightMap heights;
    std::vector<double> off_deg, higher_deg;  // by side and by height; NaN where nothing is shown
    double scatter_deg = 0, height_scatter_deg = 0;
};

// Medians of what the used photographs are off, from 0.
double scatter_of(const std::vector<double>& off_deg, const std::vector<bool>& used) {
    std::vector<double> known;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i] && !std::isnan(off_deg[i])) known.push_back(std::abs(off_deg[i]));
    return known.empty() ? 0 : 1.4826 * median(known);
}

void measure_off(Judged& judged, const std::vector<Light>& lights, const std::vector<bool>& used) {
    judged.off_deg.assign(lights.size(), kUnknown);
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (judged.shown[i]) judged.off_deg[i] = judged.map.off_deg(*judged.shown[i], lights[i]);
    judged.scatter_deg = scatter_of(judged.off_deg, used);
}

void measure_heights(Judged& judged, const std::vector<Light>& lights, const std::vector<bool>& used) {
    judged.higher_deg.assign(lights.size(), kUnknown);
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (judged.shown[i]) judged.higher_deg[i] = judged.heights.higher_deg(*judged.shown[i], lights[i]);
    judged.height_scatter_deg = scatter_of(judged.higher_deg, used);
}

// What ambient light, gloss and a tilt make of all heights alike.
void fit_heights(Judged& judged, const std::vector<Light>& lights, const std::vector<bool>& used) {
    measure_heights(judged, lights, used);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        Eigen::Matrix<double, 5, 5> matrix = 1e-6 * Eigen::Matrix<double, 5, 5>::Identity();
        Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
        const double limit = kTukey * std::max(judged.height_scatter_deg, 0.5);
        std::size_t count = 0;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            if (!used[i] || !(std::abs(judged.higher_deg[i]) < limit)) continue;
            const double r = judged.higher_deg[i] / limit, weight = (1 - r * r) * (1 - r * r);
            const auto terms = HeightMap::terms(*judged.shown[i]);
            const Eigen::Map<const Eigen::Matrix<double, 5, 1>> t(terms.data());
            matrix += weight * t * t.transpose();
            right +=
                weight * std::acos(std::clamp(static_cast<double>(lights[i].direction.z), -1.0, 1.0)) * t;
            ++count;
        }
        if (count < kFewestForHeights) break;
        Eigen::Map<Eigen::Matrix<double, 5, 1>>(judged.heights.c.data()) = solve_symmetric(matrix, right).x;
        measure_heights(judged, lights, used);
    }
}

Judged judge(std::vector<ReliefPixel>& pixels, const std::vector<Light>& lights,
             const std::vector<bool>& used) {
    find_relief(pixels, lights, used);
    Judged judged;
    judged.shown.resize(lights.size());
    parallel_for(0, static_cast<int>(lights.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            judged.shown[i] = per_photo_light(i, pixels);
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
        judged.map.affine = solve_symmetric(matrix, right).x.transpose();
        measure_off(judged, lights, used);
    }
    fit_heights(judged, lights, used);
    return judged;
}

// The photographs that stand out, but no more than a third of all, are not used.
std::vector<bool> without_suspects(const Judged& judged) {
    const double limit = std::max(kSuspect * judged.scatter_deg, kLeastSuspect_deg);
    const double height_limit = std::max(kSuspect * judged.height_scatter_deg, kLeastSuspect_deg);
    std::vector<std::size_t> suspects;
    const auto off = [&](std::size_t i) {
        return std::max(judged.off_deg[i] / limit, std::abs(judged.higher_deg[i]) / height_limit);
    };
    for (std::size_t i = 0; i < judged.off_deg.size(); ++i)
        if (judged.shown[i] && off(i) > 1) suspects.push_back(i);
    std::stable_sort(suspects.begin(), suspects.end(),
                     [&](std::size_t a, std::size_t b) { return off(a) > off(b); });
    suspects.resize(std::min(suspects.size(), judged.off_deg.size() / 3));
    std::vector<bool> used(judged.off_deg.size(), true);
    for (const std::size_t i : suspects) used[i] = false;
    return used;
}

// [deg] What the photographs with the nearest lights are off.
double off_nearby(const std::vector<double>& off_deg, const std::vector<Light>& lights, std::size_t photo) {
    std::vector<std::pair<float, float>> others;  // nearness, and off
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (i != photo && !std::isnan(off_deg[i]))
            others.emplace_back(glm::dot(lights[i].direction, lights[photo].direction),
                                static_cast<float>(std::abs(off_deg[i])));
    std::sort(others.begin(), others.end(), std::greater<>());
    std::vector<float> off;
    for (std::size_t k = 0; k < std::min(kNeighbours, others.size()); ++k) off.push_back(others[k].second);
    return off.empty() ? 0 : static_cast<double>(median(std::move(off)));
}

// Whether a photograph stands out from all, and from those with the nearest lights, by more than its standard
// error leaves open.
bool stands_out(const std::vector<double>& off_deg, double scatter_deg, double sigma_deg,
                const std::vector<Light>& lights, std::size_t photo) {
    const double off = std::abs(off_deg[photo]);
    return off > std::max(kOdd * scatter_deg, kLeastOdd_deg) && off > kSure * sigma_deg &&
           off > kFarBetter * off_nearby(off_deg, lights, photo);
}

Vec3 light_at(const Vector2d& side, double zenith_rad) {
    return Vec3(
        glm::dvec3(std::sin(zenith_rad) * side.x(), std::sin(zenith_rad) * side.y(), std::cos(zenith_rad)));
}

// What is odd about the light of a photograph: its side, or else its height.
std::optional<LightOutlier> oddity(const Judged& judged, const std::vector<Light>& lights,
                                   std::size_t photo) {
    const ShownLight& shown = *judged.shown[photo];
    const Light& light = lights[photo];
    const double plane = plane_of(light).norm(), side_sigma_deg = plane * shown.sigma_rad * kDegrees;
    if (judged.scatter_deg <= kMostScatter_deg &&
        stands_out(judged.off_deg, judged.scatter_deg, side_sigma_deg, lights, photo)) {
        const Vector2d side = judged.map.back(shown.side, plane);
        return LightOutlier{
            photo, judged.off_deg[photo], side_sigma_deg,
            Vec3(static_cast<float>(side.x()), static_cast<float>(side.y()), light.direction.z)};
    }
    const double zenith_sigma_deg = shown.zenith_sigma_rad * kDegrees;
    if (judged.height_scatter_deg <= kMostScatter_deg && judged.scatter_deg <= kMostScatter_deg &&
        plane > kLeastPlane &&
        stands_out(judged.higher_deg, judged.height_scatter_deg, zenith_sigma_deg, lights, photo)) {
        LightOutlier odd{photo, std::abs(judged.higher_deg[photo]), zenith_sigma_deg,
                         light_at(plane_of(light) / plane, judged.heights(shown))};
        odd.higher_deg = judged.higher_deg[photo];
        return odd;
    }
    return std::nullopt;
}

// [deg] How far what an odd photograph shows is from another's light.
double off_from(const Judged& judged, const LightOutlier& odd, const Light& other) {
    const ShownLight& shown = *judged.shown[odd.photo];
    const double aside = judged.map.off_deg(shown, other);
    return odd.higher_deg ? std::hypot(aside, judged.heights.higher_deg(shown, other)) : aside;
}

// Pairs of odd photographs that each other's light explains.
void find_exchanged(const Judged& judged, const std::vector<Light>& lights, std::vector<LightOutlier>& odd) {
    for (LightOutlier& a : odd)
        for (LightOutlier& b : odd) {
            if (a.photo >= b.photo || a.exchanged_with || b.exchanged_with) continue;
            if (a.higher_deg.has_value() != b.higher_deg.has_value()) continue;
            const double of_a = off_from(judged, a, lights[b.photo]);
            const double of_b = off_from(judged, b, lights[a.photo]);
            const double scatter =
                a.higher_deg ? std::hypot(judged.scatter_deg, judged.height_scatter_deg) : judged.scatter_deg;
            const double near = std::max(kExplained * scatter, kLeastExplained_deg);
            if (std::max(of_a, of_b) > near || kFarBetter * of_a > a.off_deg || kFarBetter * of_b > b.off_deg)
                continue;
            a.exchanged_with = b.photo, a.exchanged_off_deg = of_a;
            b.exchanged_with = a.photo, b.exchanged_off_deg = of_b;
        }
}

}  // namespace

LightOutliers light_outliers(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                             int width, int height) {
    TP_REQUIRE(survey.photos.size() == lights.size(), "one light a photograph");
    LightOutliers result;
    if (lights.size() < kFewestPhotos) return result;
    std::vector<ReliefPixel> pixels = relief_pixels(survey, transfer, lights.size(), width, height);
    Judged judged = judge(pixels, lights, std::vector<bool>(lights.size(), true));
    const std::vector<bool> used = without_suspects(judged);
    if (std::find(used.begin(), used.end(), false) != used.end()) judged = judge(pixels, lights, used);
    result.off_deg = judged.off_deg;
    result.scatter_deg = judged.scatter_deg;
    result.height_scatter_deg = judged.height_scatter_deg;
    result.higher_deg = judged.higher_deg;
    std::vector<double> explained;
    for (const std::optional<ShownLight>& shown : judged.shown)
        if (shown) explained.push_back(shown->explained);
    if (explained.size() < kFewestPhotos) return result;
    const double middling = median(std::move(explained));
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (!judged.shown[i] || !(judged.shown[i]->explained > kAsClear * middling)) continue;
        if (auto odd = oddity(judged, lights, i)) result.odd.push_back(*odd);
    }
    find_exchanged(judged, lights, result.odd);
    return result;
}

}  // namespace tangi
