#include "capture/spheres/sphere_outline.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <numbers>

#include "capture/spheres/outline_profiles.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kSample = EdgeProfile::kSample;
constexpr double kNear = 1.25;          // [pixels] from the expected outline, within which its edge is sought
constexpr double kFaintestEdge = 0.25;  // [1] of the strong edges; fainter ones are left out
constexpr double kLeastCoverage = 0.2;
constexpr double kShapeSystematic =
    0.25;  // [pixels] half the length's error against the width, for the same reason

struct OutlineEdge {
    dvec2 place;
    dvec2 outwards;
    double strength = 0;  // [1 per pixel] of the contrast along the profile, mean of all photographs
};

// The step of at most `reach` in each coordinate that agrees best: from a coarse grid to a fine one.
dvec3 best_step(const std::vector<EdgeProfile>& profiles, double reach) {
    dvec3 best(0);
    double most = contrast_of(profiles, best).agreement();
    for (double grid = std::max(0.5, reach / 4); grid > 0.1; grid /= 2) {
        const int half = grid >= reach / 4 ? static_cast<int>(reach / grid) : 2;
        const dvec3 middle = best;
        for (int i = -half; i <= half; ++i)
            for (int j = -half; j <= half; ++j)
                for (int k = -half; k <= half; ++k) {
                    const dvec3 step = middle + grid * dvec3(i, j, k);
                    const double value = contrast_of(profiles, step).agreement();
                    if (value > most) {
                        most = value;
                        best = step;
                    }
                }
    }
    return best;
}

// The peaks of the profiles next to the outline.
std::vector<OutlineEdge> edges_near(const std::vector<EdgeProfile>& profiles, const dvec3& step) {
    std::vector<OutlineEdge> edges;
    std::vector<double> strengths;
    for (const EdgeProfile& profile : profiles) {
        const double expected = glm::dot(dvec3(profile.outwards, 1), step);
        const auto half = static_cast<double>(profile.slope.size() / 2);
        double nearest = kNear;
        std::optional<OutlineEdge> edge;
        for (std::size_t k = 1; k + 1 < profile.slope.size(); ++k) {
            const double here = profile.slope[k], before = profile.slope[k - 1], after = profile.slope[k + 1];
            if (here < before || here < after) continue;
            const double curvature = before - 2 * here + after;
            const double at =
                (static_cast<double>(k) - half + (curvature < 0 ? (before - after) / (2 * curvature) : 0)) *
                kSample;
            if (std::abs(at - expected) >= nearest) continue;
            nearest = std::abs(at - expected);
            edge = OutlineEdge{profile.middle + at * profile.outwards, profile.outwards, here};
        }
        if (!edge) continue;
        edges.push_back(*edge);
        strengths.push_back(edge->strength);
    }
    if (edges.empty()) return edges;
    const auto strong = strengths.begin() + static_cast<std::ptrdiff_t>(strengths.size() * 4 / 5);
    std::nth_element(strengths.begin(), strong, strengths.end());
    std::erase_if(edges, [&](const OutlineEdge& edge) { return edge.strength < kFaintestEdge * *strong; });
    return edges;
}

double robust_sigma(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle / 0.6745;
}

// Fits centre and radius; false where the edges leave them open.
bool fit(const std::vector<OutlineEdge>& edges, const SphereCamera& camera, SphereOutline& outline,
         double widest) {
    SphereImage& sphere = outline.sphere;
    std::vector<double> residuals(edges.size());
    for (int iteration = 0; iteration < 30; ++iteration) {
        for (std::size_t i = 0; i < edges.size(); ++i)
            residuals[i] = outside_px(sphere, camera, edges[i].place);
        const double sigma = std::clamp(robust_sigma(residuals), 0.05, widest);
        glm::dmat3 normal(0);
        dvec3 right(0);
        double used = 0;
        outline.edges_px.clear();
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const double u = residuals[i] / (4.685 * sigma);
            if (std::abs(u) >= 1) continue;
            const double weight = (1 - u * u) * (1 - u * u);
            const dvec3 slope(edges[i].outwards, 1);  // of where the outline is, by centre and radius
            normal += weight * glm::outerProduct(slope, slope);
            right += weight * residuals[i] * slope;
            used += weight;
            outline.edges_px.push_back(edges[i].place);
        }
        if (used < 8 || !(glm::determinant(normal) > 1e-6 * used * used * used)) return false;
        const glm::dmat3 inverse = glm::inverse(normal);
        const dvec3 step = inverse * right;
        sphere.centre_px += dvec2(step);
        sphere.radius_px += step.z;
        if (!(sphere.radius_px > 2)) return false;
        outline.residual_px = sigma;
        // Neighbouring edges share their pixels: two or so make one.
        sphere.centre_sigma_px = sigma * std::sqrt(2 * std::max(inverse[0][0], inverse[1][1]));
        sphere.radius_sigma_px = sigma * std::sqrt(2 * inverse[2][2]);
        if (glm::length(step) < 1e-4) break;
    }
    return true;
}

// Beside centre and radius the edges tell how long the outline is, more than the camera says already.
std::optional<Known> elongation_of(const SphereOutline& outline, const SphereCamera& camera) {
    const SphereImage& sphere = outline.sphere;
    const dvec2 from_middle = sphere.centre_px - camera.principal_px;
    const double offset = glm::length(from_middle);
    if (!(offset > 1)) return std::nullopt;
    glm::dmat4 normal(0);
    glm::dvec4 right(0);
    for (const dvec2& edge : outline.edges_px) {
        const dvec2 out = glm::normalize(edge - sphere.centre_px);
        const double along = glm::dot(out, from_middle) / offset;
        const glm::dvec4 row(1, out, 2 * along * along - 1);
        normal += glm::outerProduct(row, row);
        right += outside_px(sphere, camera, edge) * row;
    }
    const auto count = static_cast<double>(outline.edges_px.size());
    if (!(glm::determinant(normal) > 1e-6 * std::pow(count, 4))) return std::nullopt;
    const glm::dmat4 inverse = glm::inverse(normal);
    const double modelled = camera.focal_px ? std::hypot(offset / *camera.focal_px, 1) - 1 : 0;
    const double sigma = std::hypot(outline.residual_px * std::sqrt(2 * inverse[3][3]), kShapeSystematic);
    return Known{modelled + 2 * (inverse * right).w / sphere.radius_px, 2 * sigma / sphere.radius_px};
}

}  // namespace

std::optional<SphereOutline> refine_outline(const SphereCrops& crops, const SphereImage& start,
                                            const SphereCamera& camera) {
    SphereOutline outline{.sphere = start, .edges_px = {}};
    for (const double part : {0.05, 0.02, 0.01}) {
        const double reach = std::max(part * start.radius_px, part > 0.04 ? 2.0 : 0.75);
        const std::vector<EdgeProfile> profiles =
            profiles_around(crops, outline.sphere, camera, 2 * reach + 5);
        if (profiles.size() < 12) return std::nullopt;
        const dvec3 step = best_step(profiles, reach);
        const std::vector<OutlineEdge> edges = edges_near(profiles, step);
        outline.sphere.centre_px += dvec2(step);
        outline.sphere.radius_px += step.z;
        if (edges.size() < 12 || !fit(edges, camera, outline, 0.5)) return std::nullopt;
        const int angles =
            std::clamp(static_cast<int>(2 * std::numbers::pi * outline.sphere.radius_px), 72, 360);
        outline.coverage = static_cast<double>(outline.edges_px.size()) / angles;
    }
    const double moved = glm::length(outline.sphere.centre_px - start.centre_px) +
                         std::abs(outline.sphere.radius_px - start.radius_px);
    // Near its outline a sphere's normals turn as the root of the distance from it: a mirror shows there what
    // lies right behind it, and that changes within a pixel or two. So the steepest place lies a little
    // inside of the outline, by how much depends on what is mirrored.
    outline.sphere.centre_sigma_px = std::hypot(outline.sphere.centre_sigma_px, kCentreSystematic);
    outline.sphere.radius_sigma_px = std::hypot(outline.sphere.radius_sigma_px, kRadiusSystematic);
    outline.elongation = elongation_of(outline, camera);
    if (outline.coverage < kLeastCoverage || moved > std::max(0.25 * start.radius_px, 4.0))
        return std::nullopt;
    return outline;
}

}  // namespace tangi
