#include "capture/spheres/sphere_geometry.h"

#include <cmath>

#include "capture/spheres/alhazen.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

dvec3 SphereCamera::ray(const dvec2& pixel) const {
    if (!focal_px) return {0, 0, -1};
    return glm::normalize(dvec3(pixel.x - principal_px.x, principal_px.y - pixel.y, -*focal_px));
}

dvec3 centre_in_radius_units(const SphereImage& sphere, const SphereCamera& camera) {
    return {sphere.centre_px.x - camera.principal_px.x, camera.principal_px.y - sphere.centre_px.y,
            camera.focal_px ? -*camera.focal_px : 0};
}

double outside_px(const SphereImage& sphere, const SphereCamera& camera, const dvec2& pixel) {
    const double flat = glm::length(pixel - sphere.centre_px);
    if (!camera.focal_px) return flat - sphere.radius_px;
    // Tangents from the camera form a cone of half angle asin(radius / distance) around the centre's ray. The
    // angle beyond it becomes pixels by the slope of the angle along the radius, found by a difference.
    const dvec3 axis = glm::normalize(centre_in_radius_units(sphere, camera));
    const double cone =
        std::asin(std::min(1.0, sphere.radius_px / glm::length(centre_in_radius_units(sphere, camera))));
    const auto angle = [&](const dvec2& p) {
        const dvec3 ray = camera.ray(p);
        return std::atan2(glm::length(glm::cross(axis, ray)), glm::dot(axis, ray));
    };
    const dvec2 outwards = flat > 1e-9 ? (pixel - sphere.centre_px) / flat : dvec2(1, 0);
    const double slope = angle(pixel + 0.5 * outwards) - angle(pixel - 0.5 * outwards);
    return slope > 1e-12 ? (angle(pixel) - cone) / slope : flat - sphere.radius_px;
}

dvec2 outline_point(const SphereImage& sphere, const SphereCamera& camera, double angle) {
    const dvec2 outwards(std::cos(angle), -std::sin(angle));
    dvec2 pixel = sphere.centre_px + sphere.radius_px * outwards;
    if (camera.focal_px)
        for (int i = 0; i < 4; ++i) pixel -= outside_px(sphere, camera, pixel) * outwards;  // Newton
    return pixel;
}

std::optional<SpherePoint> sphere_point(const SphereImage& sphere, const SphereCamera& camera,
                                        const dvec2& pixel) {
    const dvec3 centre = centre_in_radius_units(sphere, camera), ray = camera.ray(pixel);
    // |t ray - from| = radius, the nearer of both solutions.
    const dvec3 from =
        camera.focal_px ? centre : dvec3(sphere.centre_px.x - pixel.x, pixel.y - sphere.centre_px.y, 0);
    const double along = glm::dot(ray, from);
    const double under_root = along * along - glm::dot(from, from) + sphere.radius_px * sphere.radius_px;
    if (!(under_root >= 0) || !(sphere.radius_px > 0)) return std::nullopt;
    SpherePoint point;
    const dvec3 from_centre = (along - std::sqrt(under_root)) * ray - from;
    point.normal = glm::normalize(from_centre);
    point.position = centre + from_centre;
    point.view = -ray;
    return point;
}

std::optional<dvec2> pixel_of_normal(const SphereImage& sphere, const SphereCamera& camera,
                                     const dvec3& normal) {
    const dvec3 point = centre_in_radius_units(sphere, camera) + sphere.radius_px * normal;
    const dvec3 view = camera.focal_px ? -glm::normalize(point) : dvec3(0, 0, 1);
    if (!(glm::dot(normal, view) > 0)) return std::nullopt;
    const double scale = camera.focal_px ? *camera.focal_px / -point.z : 1;
    return dvec2(camera.principal_px.x + scale * point.x, camera.principal_px.y - scale * point.y);
}

std::optional<dvec2> highlight_of_direction(const SphereImage& sphere, const SphereCamera& camera,
                                            const dvec3& direction) {
    const dvec3 light = glm::normalize(direction);
    if (!camera.focal_px) {
        const dvec3 half = light + dvec3(0, 0, 1);
        if (!(glm::length(half) > 1e-6)) return std::nullopt;
        return pixel_of_normal(sphere, camera, glm::normalize(half));
    }
    return highlight_of_position(sphere, camera,
                                 centre_in_radius_units(sphere, camera) + 1e9 * sphere.radius_px * light);
}

std::optional<dvec2> highlight_of_position(const SphereImage& sphere, const SphereCamera& camera,
                                           const dvec3& light) {
    const dvec3 centre = centre_in_radius_units(sphere, camera);
    double normal[3];
    const double c[3] = {centre.x, centre.y, 0}, l[3] = {light.x, light.y, light.z - centre.z};
    const double inverse_distance = camera.focal_px ? 1 / *camera.focal_px : 0;
    if (!mirror_normal(c, sphere.radius_px, l, inverse_distance, normal)) return std::nullopt;
    return pixel_of_normal(sphere, camera, {normal[0], normal[1], normal[2]});
}

double direction_sigma(const SphereImage& sphere, const SphereCamera& camera, const dvec2& highlight,
                       double highlight_sigma_px) {
    const auto at = sphere_point(sphere, camera, highlight);
    if (!at) return 3.14;
    const double step = 0.01;
    double variance = 0;
    const auto add = [&](const SphereImage& b, const dvec2& p, double sigma) {
        const auto moved = sphere_point(b, camera, p);
        const double slope =
            moved ? glm::length(moved->mirrored() - at->mirrored()) / step : 100 / sphere.radius_px;
        variance += slope * slope * sigma * sigma / 2;
    };
    // Moving the sphere moves the normal as moving the highlight does, but for perspective.
    const double both = std::hypot(highlight_sigma_px, sphere.centre_sigma_px);
    const dvec2 inwards = highlight.x > sphere.centre_px.x ? dvec2(-1, 1) : dvec2(1, 1);
    add(sphere, highlight + step * dvec2(inwards.x, 0), both);
    add(sphere, highlight + dvec2(0, highlight.y > sphere.centre_px.y ? -step : step), both);
    SphereImage larger = sphere;
    larger.radius_px += step;
    add(larger, highlight, sphere.radius_sigma_px);
    return std::sqrt(variance);
}

}  // namespace tangi
