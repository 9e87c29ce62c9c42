#include "capture/spheres/ball_geometry.h"

#include <cmath>

#include "capture/spheres/alhazen.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

dvec3 BallCamera::ray(const dvec2& pixel) const {
    if (!focal_px) return {0, 0, -1};
    return glm::normalize(dvec3(pixel.x - principal_px.x, principal_px.y - pixel.y, -*focal_px));
}

dvec3 centre_in_radius_units(const BallImage& ball, const BallCamera& camera) {
    return {ball.centre_px.x - camera.principal_px.x, camera.principal_px.y - ball.centre_px.y,
            camera.focal_px ? -*camera.focal_px : 0};
}

double outside_px(const BallImage& ball, const BallCamera& camera, const dvec2& pixel) {
    const double flat = glm::length(pixel - ball.centre_px);
    if (!camera.focal_px) return flat - ball.radius_px;
    // Tangents from the camera form a cone of half angle asin(radius / distance) around the centre's ray. The
    // angle beyond it becomes pixels by the slope of the angle along the radius, found by a difference.
    const dvec3 axis = glm::normalize(centre_in_radius_units(ball, camera));
    const double cone =
        std::asin(std::min(1.0, ball.radius_px / glm::length(centre_in_radius_units(ball, camera))));
    const auto angle = [&](const dvec2& p) {
        const dvec3 ray = camera.ray(p);
        return std::atan2(glm::length(glm::cross(axis, ray)), glm::dot(axis, ray));
    };
    const dvec2 outwards = flat > 1e-9 ? (pixel - ball.centre_px) / flat : dvec2(1, 0);
    const double slope = angle(pixel + 0.5 * outwards) - angle(pixel - 0.5 * outwards);
    return slope > 1e-12 ? (angle(pixel) - cone) / slope : flat - ball.radius_px;
}

dvec2 outline_point(const BallImage& ball, const BallCamera& camera, double angle) {
    const dvec2 outwards(std::cos(angle), -std::sin(angle));
    dvec2 pixel = ball.centre_px + ball.radius_px * outwards;
    if (camera.focal_px)
        for (int i = 0; i < 4; ++i) pixel -= outside_px(ball, camera, pixel) * outwards;  // Newton
    return pixel;
}

std::optional<BallPoint> ball_point(const BallImage& ball, const BallCamera& camera, const dvec2& pixel) {
    const dvec3 centre = centre_in_radius_units(ball, camera), ray = camera.ray(pixel);
    // |t ray - from| = radius, the nearer of both solutions.
    const dvec3 from =
        camera.focal_px ? centre : dvec3(ball.centre_px.x - pixel.x, pixel.y - ball.centre_px.y, 0);
    const double along = glm::dot(ray, from);
    const double under_root = along * along - glm::dot(from, from) + ball.radius_px * ball.radius_px;
    if (!(under_root >= 0) || !(ball.radius_px > 0)) return std::nullopt;
    BallPoint point;
    const dvec3 from_centre = (along - std::sqrt(under_root)) * ray - from;
    point.normal = glm::normalize(from_centre);
    point.position = centre + from_centre;
    point.view = -ray;
    return point;
}

std::optional<dvec2> pixel_of_normal(const BallImage& ball, const BallCamera& camera, const dvec3& normal) {
    const dvec3 point = centre_in_radius_units(ball, camera) + ball.radius_px * normal;
    const dvec3 view = camera.focal_px ? -glm::normalize(point) : dvec3(0, 0, 1);
    if (!(glm::dot(normal, view) > 0)) return std::nullopt;
    const double scale = camera.focal_px ? *camera.focal_px / -point.z : 1;
    return dvec2(camera.principal_px.x + scale * point.x, camera.principal_px.y - scale * point.y);
}

std::optional<dvec2> highlight_of_direction(const BallImage& ball, const BallCamera& camera,
                                            const dvec3& direction) {
    const dvec3 light = glm::normalize(direction);
    if (!camera.focal_px) {
        const dvec3 half = light + dvec3(0, 0, 1);
        if (!(glm::length(half) > 1e-6)) return std::nullopt;
        return pixel_of_normal(ball, camera, glm::normalize(half));
    }
    return highlight_of_position(ball, camera,
                                 centre_in_radius_units(ball, camera) + 1e9 * ball.radius_px * light);
}

std::optional<dvec2> highlight_of_position(const BallImage& ball, const BallCamera& camera,
                                           const dvec3& light) {
    const dvec3 centre = centre_in_radius_units(ball, camera);
    double normal[3];
    const double c[3] = {centre.x, centre.y, 0}, l[3] = {light.x, light.y, light.z - centre.z};
    const double inverse_distance = camera.focal_px ? 1 / *camera.focal_px : 0;
    if (!mirror_normal(c, ball.radius_px, l, inverse_distance, normal)) return std::nullopt;
    return pixel_of_normal(ball, camera, {normal[0], normal[1], normal[2]});
}

double direction_sigma(const BallImage& ball, const BallCamera& camera, const dvec2& highlight,
                       double highlight_sigma_px) {
    const auto at = ball_point(ball, camera, highlight);
    if (!at) return 3.14;
    const double step = 0.01;
    double variance = 0;
    const auto add = [&](const BallImage& b, const dvec2& p, double sigma) {
        const auto moved = ball_point(b, camera, p);
        const double slope =
            moved ? glm::length(moved->mirrored() - at->mirrored()) / step : 100 / ball.radius_px;
        variance += slope * slope * sigma * sigma / 2;
    };
    // Moving the ball moves the normal as moving the highlight does, but for perspective.
    const double both = std::hypot(highlight_sigma_px, ball.centre_sigma_px);
    const dvec2 inwards = highlight.x > ball.centre_px.x ? dvec2(-1, 1) : dvec2(1, 1);
    add(ball, highlight + step * dvec2(inwards.x, 0), both);
    add(ball, highlight + dvec2(0, highlight.y > ball.centre_px.y ? -step : step), both);
    BallImage larger = ball;
    larger.radius_px += step;
    add(larger, highlight, ball.radius_sigma_px);
    return std::sqrt(variance);
}

}  // namespace tangi
