// sphere_lights.cpp: see sphere_lights.h.
#include "capture/sphere_lights/sphere_lights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kFarthest = 0.5;       // [1] standard error / distance from which on a position is none
constexpr double kUnknown = 60;         // [deg] standard error of a direction that may as well be any other
constexpr double kWorstDirection = 10;  // [deg] standard error from which on a light is left out
constexpr double kHighest = 10;     // [radii] of a sphere above or below the painting's plane, for a doubt
constexpr double kRadiiDiffer = 4;  // [standard errors] between spheres of one size

// The directions that single spheres say, averaged with their weights.
void directions_from_spheres(SphereCalibration& c, const std::vector<SphereView>& views,
                             const FocalVerdict& verdict) {
    const double inverse_sigma = inverse_focal_sigma(verdict, c.camera);
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        dvec3 sum(0);
        dvec2 offset(0);  // of the spheres from the picture's middle, weighted as their directions
        double weights = 0;
        std::string reasons;
        CalibratedLight& light = c.lights[i];
        for (const SphereView& sphere : views) {
            const Highlight& highlight = sphere.highlights[i];
            const auto point = highlight.state == HighlightState::found
                                   ? sphere_point(sphere.image, c.camera, highlight.place_px)
                                   : std::nullopt;
            if (!point) {
                reasons +=
                    fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", sphere.name, reason_of(highlight));
                continue;
            }
            const double sigma =
                direction_sigma(sphere.image, c.camera, highlight.place_px, highlight.sigma_px);
            const double weight = 1 / (sigma * sigma);
            sum += weight * point->mirrored();
            offset += weight * (sphere.image.centre_px - c.camera.principal_px);
            weights += weight;
            ++light.spheres_used;
        }
        light.reason = reasons;
        if (light.spheres_used > 0) {
            keep_direction(light, sum, std::sqrt(1 / weights));
            // All lights alike, and so no reason to leave out one.
            light.direction_sigma_deg = std::hypot(light.direction_sigma_deg,
                                                   kDegrees * glm::length(offset) / weights * inverse_sigma);
        }
        if (!light.direction)
            c.warnings.push_back(fmt::format("{}: rejected: {}", light.name, light.reason));
        else if (!reasons.empty())
            c.warnings.push_back(fmt::format("{}: {}; its light comes from the other sphere{} alone",
                                             light.name, reasons, light.spheres_used > 1 ? "s" : ""));
    }
}

// Where the painting's frame lies in that of the spheres.
struct SphereFrame {
    dvec3 offset{0};  // of the spheres' frame
    double mm_per_pixel = 1;
    dvec3 to_surface(const dvec3& point) const { return point + offset; }
};

SphereFrame frame_of(const SphereCalibration& c, const PositionResult& result, double height_mm) {
    const dvec2 origin = (c.origin_px - c.camera.principal_px) * dvec2(1, -1);
    SphereFrame frame;
    frame.mm_per_pixel = (1 + result.inverse_distance_mm() * height_mm) / result.px_per_mm;
    frame.offset = dvec3(-origin * frame.mm_per_pixel, height_mm);
    return frame;
}

// [mm] How high the spheres' centres are above the painting by the camera's distance; nothing without.
std::optional<Known> height_by_distance(const MeasuredLengths& lengths, const PositionResult& result,
                                        const Known& radius_px) {
    const double inverse = result.inverse_distance_mm();
    if (!lengths.camera_distance_mm || !lengths.sphere_radius_mm || !(inverse > 1e-9)) return std::nullopt;
    const double relative = std::hypot(radius_px.sigma / radius_px.value,
                                       result.inverse_focal.sigma / result.inverse_focal.value);
    return Known{
        *lengths.camera_distance_mm - 1 / inverse,
        std::hypot(relative / inverse, MeasuredLengths::kDistanceSigma * *lengths.camera_distance_mm)};
}

// As given; else of what the distance says, and that spheres lie on the painting's plane, the more certain
// more.
Known height_of(const MeasuredLengths& lengths, const PositionResult& result, const Known& radius_px,
                bool distance_agrees) {
    const Known lying = lengths.height();
    const std::optional<Known> told = height_by_distance(lengths, result, radius_px);
    if (lengths.sphere_height_mm || !told || !distance_agrees) return lying;
    const double a = 1 / (lying.sigma * lying.sigma), b = 1 / (told->sigma * told->sigma);
    return {(a * lying.value + b * told->value) / (a + b), 1 / std::sqrt(a + b)};
}

// Standard error of a direction from that of the position, across it.
double across_sigma(const glm::dmat3& covariance, const dvec3& position) {
    const dvec3 d = glm::normalize(position);
    const double across =
        covariance[0][0] + covariance[1][1] + covariance[2][2] - glm::dot(d, covariance * d);
    return std::sqrt(std::max(across, 0.0) / 2) / glm::length(position);
}

// Lights that one sphere alone shows lie on its ray, as far from the origin as the others do.
void directions_at_distance(SphereCalibration& c, const std::vector<SphereView>& views,
                            const SphereFrame& frame, const PositionResult& result, double distance_mm,
                            double radius_mm) {
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (!light.direction || result.lights[i]) continue;
        for (std::size_t b = 0; b < views.size(); ++b) {
            const Highlight& h = views[b].highlights[i];
            if (h.state != HighlightState::found) continue;
            const auto point = sphere_point(views[b].image, c.camera, h.place_px);
            if (!point) continue;
            const dvec3 from = frame.to_surface(result.sphere_centres_mm[b]) + radius_mm * point->normal,
                        d = point->mirrored();
            const double along = -glm::dot(from, d), across = glm::dot(from, from) - along * along;
            if (distance_mm * distance_mm <= across) continue;
            light.direction =
                glm::normalize(from + (along + std::sqrt(distance_mm * distance_mm - across)) * d);
            // A third of the distance either way.
            light.direction_sigma_deg = std::hypot(
                light.direction_sigma_deg, kDegrees * glm::length(glm::cross(from, d)) / (3 * distance_mm));
            break;
        }
    }
}

// [mm] Where each light would be if one of what contradicts each other were wrong: one list for each way.
std::vector<std::vector<std::optional<dvec3>>> alternatives(const SphereCalibration& c,
                                                            const PositionInput& input,
                                                            const FocalVerdict& verdict,
                                                            const MeasuredLengths& lengths,
                                                            const Known& radius_px) {
    std::vector<std::vector<std::optional<dvec3>>> ways;
    const std::optional<Known> depth = lengths.depth();
    for (const Known& inverse_focal : verdict.alternatives()) {
        PositionInput other = input;
        other.depth_mm.reset();
        other.inverse_focal = Known{inverse_focal.value, 0.1 * inverse_focal.sigma};
        const PositionResult result = light_positions(other);
        const auto add = [&](double height_mm, double scale) {
            if (std::abs(height_mm) > kHighest * input.sphere_radius_mm) return;  // spheres do not float
            const SphereFrame frame = frame_of(c, result, height_mm / scale);
            ways.emplace_back(result.lights.size());
            for (std::size_t i = 0; i < result.lights.size(); ++i)
                if (result.lights[i])
                    ways.back()[i] = scale * frame.to_surface(result.lights[i]->position_mm);
        };
        const double height = lengths.height().value;
        add(height, 1);
        if (!verdict.doubts_lengths()) continue;
        if (const auto told = height_by_distance(lengths, result, radius_px)) add(told->value, 1);
        const double inverse = result.inverse_distance_mm();
        if (depth && inverse > 1e-9) add(height, depth->value * inverse);  // spheres of another radius
    }
    return ways;
}

// What contradicts each other is part of the errors.
void widen(SphereCalibration& c, const std::vector<std::vector<std::optional<dvec3>>>& ways, double doubt) {
    int rejected = 0;
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (!light.direction) continue;
        double farthest = 0;
        dvec3 moved(0);
        for (const auto& way : ways) {
            if (!way[i]) continue;
            const dvec3 d = glm::normalize(*way[i]);
            farthest = std::max(farthest, std::atan2(glm::length(glm::cross(d, *light.direction)),
                                                     glm::dot(d, *light.direction)));
            if (light.position_mm) moved = glm::max(moved, glm::abs(*way[i] - *light.position_mm));
        }
        const dvec3 direction = *light.direction;
        light.direction.reset();
        keep_direction(light, direction, std::hypot(light.direction_sigma_deg / kDegrees, doubt * farthest));
        for (int k = 0; k < 3; ++k)
            light.position_sigma_mm[k] = std::hypot(light.position_sigma_mm[k], doubt * moved[k]);
        if (light.direction) continue;
        light.position_mm.reset();
        ++rejected;
    }
    if (rejected > 0)
        c.warnings.push_back(fmt::format(
            "{} of {} lights are left out, being uncertain by more than {:g} degrees, because of what is "
            "contradictory",
            rejected, c.lights.size(), kWorstDirection));
}

// Positions of the lights that two spheres or more show; the distances of those that have one.
std::vector<double> place_lights(SphereCalibration& c, const PositionResult& result, const SphereFrame& frame,
                                 const Known& height, bool in_mm, const std::string& why_far) {
    std::vector<double> distances;
    std::vector<std::string> distant;
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (!light.direction || !result.lights[i]) continue;
        const LocatedLight& located = *result.lights[i];
        const dvec3 position = frame.to_surface(located.position_mm);
        glm::dmat3 covariance = located.covariance_mm2;
        covariance[2][2] += height.sigma * height.sigma;
        for (int k = 0; k < 3; ++k) light.position_sigma_mm[k] = std::sqrt(std::max(covariance[k][k], 0.0));
        if (!result.converged || glm::length(light.position_sigma_mm) > kFarthest * glm::length(position)) {
            distant.push_back(light.name);  // and keeps the direction that the spheres say
            continue;
        }
        light.direction.reset();
        keep_direction(light, position, across_sigma(covariance, position));
        if (!light.direction) {
            c.warnings.push_back(fmt::format("{}: rejected: {}", light.name, light.reason));
            continue;
        }
        distances.push_back(glm::length(position));
        if (in_mm) light.position_mm = position;
    }
    if (!distant.empty())
        c.warnings.push_back(fmt::format(
            "{} of {} lights: the spheres do not tell how far away they are{} (the first: {}); they "
            "have a direction only",
            distant.size(), c.lights.size(), why_far, distant.front()));
    return distances;
}

// Positions from two spheres or more, and directions seen from the origin. Without a known radius all is in
// radii.
void positions_from_spheres(SphereCalibration& c, const SphereCalibrationOptions& options,
                            const std::vector<SphereView>& views, const FocalVerdict& verdict) {
    const MeasuredLengths lengths = lengths_of(options, c.width, c.height);
    const double radius_mm = options.sphere_radius_mm.value_or(1);
    const Known radius_px = mean_radius_px(views);
    PositionInput input = position_input(c, views, radius_mm);
    // Highlights and lengths are in the adjustment themselves.
    std::vector<FocalEvidence> beforehand;
    for (const FocalEvidence& e : verdict.agree)
        if (e.source == FocalSource::given || e.source == FocalSource::outlines) beforehand.push_back(e);
    input.inverse_focal = judge(beforehand, diagonal_of(c)).inverse_focal;
    if (verdict.uses(FocalSource::lengths)) input.depth_mm = lengths.depth();
    const PositionResult result = light_positions(input);
    const Known height = height_of(lengths, result, radius_px, verdict.uses(FocalSource::lengths));
    const SphereFrame frame = frame_of(c, result, height.value);
    if (options.sphere_radius_mm) {
        for (const dvec3& centre : result.sphere_centres_mm)
            c.sphere_centres_mm.push_back(frame.to_surface(centre));
        if (c.camera.focal_px && result.inverse_distance_mm() > 1e-9)
            c.camera_position_mm =
                dvec3(dvec2(frame.offset), 1 / result.inverse_distance_mm() + height.value);
        c.mm_per_pixel = frame.mm_per_pixel;
    }
    c.residual_px = result.residual_px;
    c.residual_sigma = result.residual_sigma;
    const bool known = verdict.inverse_focal.sigma < 0.1 * verdict.inverse_focal.value;
    const std::vector<double> distances =
        place_lights(c, result, frame, height, options.sphere_radius_mm.has_value(),
                     known ? "" : ", the focal length being uncertain: give --focal-px or --focal-35mm");
    if (!distances.empty()) directions_at_distance(c, views, frame, result, median(distances), radius_mm);
    if (verdict.doubt() > 0) widen(c, alternatives(c, input, verdict, lengths, radius_px), verdict.doubt());
    if (!result.converged) c.poor.push_back("the lights' positions did not converge");
}

void compare_radii(SphereCalibration& c, const std::vector<SphereView>& views) {
    const auto [small, large] = std::minmax_element(
        views.begin(), views.end(),
        [](const SphereView& a, const SphereView& b) { return a.image.radius_px < b.image.radius_px; });
    if (large->image.radius_px - small->image.radius_px >
        kRadiiDiffer * std::hypot(small->image.radius_sigma_px, large->image.radius_sigma_px))
        c.poor.push_back(fmt::format(
            "{} and {} have radii of {:.1f} and {:.1f} pixels, and all spheres are taken to be of "
            "one size, in one plane: "
            "leave out those that are not, by naming the others with --sphere",
            small->name, large->name, small->image.radius_px, large->image.radius_px));
}

}  // namespace

void keep_direction(CalibratedLight& light, const dvec3& direction, double sigma_rad) {
    light.direction_sigma_deg = sigma_rad * kDegrees;
    if (!(direction.z > 0)) {
        light.reason =
            fmt::format("its light comes from below the painting's plane (z = {:.3f})", direction.z);
    } else if (light.direction_sigma_deg > kWorstDirection) {
        light.reason = light.direction_sigma_deg > kUnknown
                           ? "its light's direction is unknown"
                           : fmt::format("its light's direction is uncertain by {:.0f} degrees",
                                         light.direction_sigma_deg);
    } else {
        light.direction = glm::normalize(direction);
        light.reason.clear();
    }
}

void lights_from_spheres(SphereCalibration& c, const SphereCalibrationOptions& options,
                         const FocalVerdict& verdict) {
    const std::vector<SphereView> views = views_of(c, options);
    directions_from_spheres(c, views, verdict);
    tell_of_focal_length(c, views, verdict);
    if (views.size() < 2) {
        add_parallax(c, views.front());
        return;
    }
    compare_radii(c, views);
    positions_from_spheres(c, options, views, verdict);
}

}  // namespace tangi
