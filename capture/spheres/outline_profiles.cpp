#include "capture/spheres/outline_profiles.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "surface/base/parallel.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kProfileSample = EdgeProfile::kSample;
constexpr double kBounded = 0.15;    // [1 per pixel] slope of the logarithm that one photograph may count for
constexpr double kClearEdge = 0.06;  // [1 per pixel] mean of those that counts fully
constexpr double kOutside = 0.8;     // how much an edge beyond the outline counts against it
// [1] Edges outside as a part of those on the outline. Of spheres on a plain ground 0 to 0.3; on a painting
// that is textured to the pixel 0.85 and more, and the steepest places are those of its pattern.
constexpr double kQuiet = 0.5;

EdgeProfile profile_along(const SphereCrops& crops, const dvec2& middle, const dvec2& outwards,
                          double reach) {
    EdgeProfile profile{middle, outwards, {}, {}};
    if (!crops.holds(middle + reach * outwards) || !crops.holds(middle - reach * outwards)) return profile;
    const int half = static_cast<int>(std::ceil(reach / kProfileSample));
    constexpr std::size_t ends = 10;  // samples on which the contrast nearby rests
    std::vector<double> values(2 * (static_cast<std::size_t>(half) + ends) + 1);
    profile.slope.resize(static_cast<std::size_t>(2 * half + 1));
    profile.clear.resize(profile.slope.size());
    const double share = 1 / static_cast<double>(crops.photos.size());
    for (std::size_t photo = 0; photo < crops.photos.size(); ++photo) {
        for (std::size_t k = 0; k < values.size(); ++k) {
            const double offset =
                (static_cast<double>(k) - half - static_cast<double>(ends)) * kProfileSample;
            values[k] = crops.value(photo, crops.to_photo(photo, middle + offset * outwards));
        }
        for (std::size_t k = 0; k < profile.slope.size(); ++k) {
            const auto here = values.begin() + static_cast<std::ptrdiff_t>(k + ends);
            const auto [low, high] = std::minmax_element(here - ends, here + ends + 1);
            const double inner = (here[-2] + here[-3]) / 2, outer = (here[2] + here[3]) / 2;
            profile.slope[k] += share * std::abs(outer - inner) /
                                (5 * kProfileSample * (*high - *low + 3.0 * crops.step + 0.02 * *high));
            const double floor = 2.0 * crops.step + 0.001;
            const double logarithm =
                std::abs(std::log((outer + floor) / (inner + floor))) / (5 * kProfileSample);
            profile.clear[k] += share * std::min(logarithm, kBounded);
        }
    }
    for (double& value : profile.clear) value = std::min(value / kClearEdge, 1.0);
    return profile;
}

}  // namespace

double EdgeProfile::at(double offset) const {
    const double place = offset / kProfileSample + static_cast<double>(clear.size() / 2);
    if (place < 0 || place >= static_cast<double>(clear.size()) - 1) return 0;
    const auto k = static_cast<std::size_t>(place);
    return clear[k] + (place - static_cast<double>(k)) * (clear[k + 1] - clear[k]);
}

std::vector<EdgeProfile> profiles_around(const SphereCrops& crops, const SphereImage& sphere,
                                         const SphereCamera& camera, double reach) {
    const int angles = std::clamp(static_cast<int>(2 * std::numbers::pi * sphere.radius_px), 72, 360);
    std::vector<EdgeProfile> profiles(static_cast<std::size_t>(angles));
    parallel_for(0, angles, 8, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const double angle = 2 * std::numbers::pi * (i + 0.5) / angles;
            profiles[static_cast<std::size_t>(i)] = profile_along(crops, outline_point(sphere, camera, angle),
                                                                  {std::cos(angle), -std::sin(angle)}, reach);
        }
    });
    std::erase_if(profiles, [](const EdgeProfile& profile) { return profile.slope.empty(); });
    return profiles;
}

double OutlineContrast::agreement() const { return on - kOutside * outside; }

bool OutlineContrast::stands_out() const { return on > 0 && outside < kQuiet * on; }

OutlineContrast contrast_of(const std::vector<EdgeProfile>& profiles, const dvec3& step) {
    OutlineContrast sum;
    for (const EdgeProfile& profile : profiles) {
        const double offset = glm::dot(dvec3(profile.outwards, 1), step);
        for (const double beyond : {2.0, 3.0, 4.0}) sum.outside += profile.at(offset + beyond) / 3;
        sum.on += profile.at(offset);
    }
    const double count = std::max<double>(static_cast<double>(profiles.size()), 1);
    return {sum.on / count, sum.outside / count};
}

}  // namespace tangi
