#include "capture/spheres/sphere_sizes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr double kGross = 1.3;  // a ratio of radii beyond which they are not those of the same spheres

constexpr double kForeshortened = 0.7;  // [1] cosine of 45 degrees

}  // namespace

double weight_of(const FoundSphere& sphere) {
    return sphere.outline_coverage * sphere.highlights_found() /
           std::max(static_cast<double>(sphere.highlights.size()), 1.0);
}

bool is_twin_size(double radius_px, double other_px) {
    return radius_px < kTwinSize * other_px && other_px < kTwinSize * radius_px;
}

bool cannot_both_be(const SphereImage& a, const SphereImage& b) {
    return glm::length(a.centre_px - b.centre_px) < kForeshortened * (a.radius_px + b.radius_px);
}

bool is_of_size(double radius_px, double expected_px) {
    return radius_px < kGross * expected_px && expected_px < kGross * radius_px;
}

void keep_one_size(SphereSearch& search, const std::optional<double>& expected_px) {
    std::vector<FoundSphere>& spheres = search.spheres;
    const auto of_size = [](double radius_px) {
        return
            [radius_px](const FoundSphere& sphere) { return is_of_size(sphere.image.radius_px, radius_px); };
    };
    std::string known_by = "as the numbers that are given say";
    double kept_px = 0, most = 0;
    if (expected_px && std::any_of(spheres.begin(), spheres.end(), of_size(*expected_px))) {
        kept_px = *expected_px;
    } else {
        known_by = "as those are of which most is seen";
        for (const FoundSphere& sphere : spheres) {
            double weight = 0;
            for (const FoundSphere& other : spheres)
                if (of_size(sphere.image.radius_px)(other)) weight += weight_of(other);
            if (weight > most) most = weight, kept_px = sphere.image.radius_px;
        }
    }
    std::erase_if(spheres, [&](const FoundSphere& sphere) {
        if (of_size(kept_px)(sphere)) return false;
        const glm::dvec2 at = sphere.image.centre_px;
        search.warnings.push_back(fmt::format(
            "something round at ({:.0f}, {:.0f}), {:.1f} pixels in radius, is taken for no mirror sphere: "
            "spheres are of one size, about {:.1f} pixels, {}; if it is one, give all spheres with --sphere, "
            "it "
            "with --sphere {:.0f},{:.0f},{:.0f}",
            at.x, at.y, sphere.image.radius_px, kept_px, known_by, at.x, at.y, sphere.image.radius_px));
        return true;
    });
}

}  // namespace tangi
