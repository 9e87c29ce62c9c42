// sphere_focal.cpp: see sphere_focal.h.
#include "capture/sphere_lights/sphere_focal.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kTurned = 1;      // [deg] that the unknown focal length may turn before it is told
constexpr double kTurnedPoor = 3;  // [deg] before it is poor
constexpr double kClearlyBetterMisfit = 0.8;  // [1] of the misfit of outlines
constexpr double kFarLights = 2;  // [1] diagonals of the picture, as far away as lights are at least, about
constexpr double kCertain = 2.5;  // [standard errors] of a focal length that is used
constexpr double kFar35mm =
    0.05;  // [1] relative error of a lens's nominal focal length, which grows as it focuses

FocalVerdict verdict_of(const SphereCalibration& c, const SphereCalibrationOptions& options,
                        const MeasuredLengths& lengths) {
    const std::vector<SphereView> views = views_of(c, options);
    std::vector<FocalEvidence> evidence;
    if (lengths.focal_px)
        evidence.push_back(
            {FocalSource::given, {1 / *lengths.focal_px, lengths.focal_sigma / *lengths.focal_px}});
    if (const auto told = evidence_of_lengths(lengths, mean_radius_px(views))) evidence.push_back(*told);
    for (const SphereView& view : views)
        if (view.elongation)
            if (const auto told = evidence_of_outline(
                    *view.elongation, glm::length(view.image.centre_px - c.camera.principal_px),
                    diagonal_of(c)))
                evidence.push_back(*told);
    if (views.size() > 1 && !views.front().highlights.empty()) {
        PositionInput input = position_input(c, views, 1);
        input.inverse_focal = any_lens(diagonal_of(c));
        const PositionResult result = light_positions(input);
        if (result.converged && result.inverse_focal.sigma > 0 &&
            result.inverse_focal.sigma < 0.7 * input.inverse_focal->sigma)
            evidence.push_back({FocalSource::highlights, result.inverse_focal});
    }
    return judge(evidence, diagonal_of(c));
}

// Far away where hardly anything is known.
std::optional<double> focal_of(const FocalVerdict& verdict, const MeasuredLengths& lengths) {
    if (verdict.uses(FocalSource::given)) return lengths.focal_px;
    const Known& inverse = verdict.inverse_focal;
    return inverse.value > kCertain * inverse.sigma ? std::optional(1 / inverse.value) : std::nullopt;
}

bool is_rejected(const FocalVerdict& verdict, FocalSource source) {
    return std::any_of(verdict.disagree.begin(), verdict.disagree.end(),
                       [&](const FocalEvidence& e) { return e.source == source; });
}

// [px] How far the edges lie from the outlines that the camera makes of spheres, the worse the fewer there
// are.
double misfit_px(const std::vector<FoundSphere>& spheres) {
    double sum = 0;
    for (const FoundSphere& sphere : spheres)
        if (sphere.outline_coverage > 0) sum += sphere.outline_residual_px / sphere.outline_coverage;
    return sum;
}

// A wrong lens makes outlines that edges are sought along in vain: where a camera far away fits them clearly
// better, evidence starts from there.
void measure_without_bias(SphereCalibration& c) {
    if (!c.camera.focal_px) return;
    const std::vector<FoundSphere> as_given = c.spheres;
    const std::optional<double> focal_px = std::exchange(c.camera.focal_px, std::nullopt);
    for (FoundSphere& sphere : c.spheres) measure_again(sphere, c.camera);
    if (misfit_px(c.spheres) < kClearlyBetterMisfit * misfit_px(as_given)) return;
    c.spheres = as_given;
    c.camera.focal_px = focal_px;
}

}  // namespace

double diagonal_of(const SphereCalibration& c) { return std::hypot(c.width, c.height); }

Known mean_radius_px(const std::vector<SphereView>& views) {
    Known radius;
    for (const SphereView& view : views) {
        radius.value += view.image.radius_px / static_cast<double>(views.size());
        // What makes one outline too small makes all so.
        radius.sigma = std::max(radius.sigma, view.image.radius_sigma_px);
    }
    return radius;
}

SphereView view_of(const FoundSphere& sphere, const std::optional<Lens>& lens) {
    SphereView view{sphere.name, sphere.image, sphere.elongation, sphere.highlights};
    if (!lens) return view;
    // A sphere is small against the picture: the distortion moves and enlarges it.
    constexpr double step = 0.5;
    const dvec2 at = sphere.image.centre_px;
    const dvec2 across = undistorted(*lens, at + dvec2(step, 0)) - undistorted(*lens, at - dvec2(step, 0));
    const dvec2 down = undistorted(*lens, at + dvec2(0, step)) - undistorted(*lens, at - dvec2(0, step));
    const double scale = std::sqrt(std::abs(across.x * down.y - across.y * down.x)) / (2 * step);
    view.elongation.reset();  // the distortion changes it as well
    view.image.centre_px = undistorted(*lens, at);
    view.image.radius_px *= scale;
    view.image.centre_sigma_px *= scale;
    view.image.radius_sigma_px *= scale;
    for (Highlight& highlight : view.highlights) {
        if (highlight.state != HighlightState::found) continue;
        highlight.place_px = undistorted(*lens, highlight.place_px);
        highlight.sigma_px *= scale;
    }
    return view;
}

std::vector<SphereView> views_of(const SphereCalibration& c, const SphereCalibrationOptions& options) {
    std::vector<SphereView> views;
    for (const FoundSphere& sphere : c.spheres) views.push_back(view_of(sphere, options.lens));
    return views;
}

PositionInput position_input(const SphereCalibration& c, const std::vector<SphereView>& views,
                             double radius_mm) {
    PositionInput input{.camera = c.camera, .sphere_radius_mm = radius_mm, .spheres = {}, .highlights = {}};
    for (const SphereView& view : views) input.spheres.push_back(view.image);
    input.highlights.resize(c.lights.size());
    for (std::size_t i = 0; i < c.lights.size(); ++i)
        for (const SphereView& view : views) {
            const Highlight& h = view.highlights[i];
            input.highlights[i].push_back(h.state == HighlightState::found
                                              ? std::optional(MeasuredHighlight{h.place_px, h.sigma_px})
                                              : std::nullopt);
        }
    return input;
}

MeasuredLengths lengths_of(const SphereCalibrationOptions& options, int width, int height) {
    MeasuredLengths lengths{.focal_px = options.focal_px,
                            .sphere_radius_mm = options.sphere_radius_mm,
                            .camera_distance_mm = options.camera_distance_mm,
                            .sphere_height_mm = options.sphere_height_mm};
    if (options.focal_35mm) {
        lengths.focal_px = *options.focal_35mm / std::hypot(36.0, 24.0) * std::hypot(width, height);
        lengths.focal_sigma = kFar35mm;
    }
    return lengths;
}

FocalVerdict find_focal_length(SphereCalibration& c, const SphereCalibrationOptions& options) {
    const MeasuredLengths lengths = lengths_of(options, c.width, c.height);
    measure_without_bias(c);
    FocalVerdict verdict = verdict_of(c, options, lengths);
    // Outlines depend on it a little, and what they and the highlights say then does.
    for (int turn = 0; turn < 3; ++turn) {
        const std::optional<double> focal = focal_of(verdict, lengths);
        const double before = c.camera.focal_px ? 1 / *c.camera.focal_px : 0, now = focal ? 1 / *focal : 0;
        c.camera.focal_px = focal;
        if (std::abs(now - before) <= 0.02 * std::max(now, before)) break;
        for (FoundSphere& sphere : c.spheres) measure_again(sphere, c.camera);
        verdict = verdict_of(c, options, lengths);
    }
    const std::string contradiction =
        contradiction_of(verdict, lengths, mean_radius_px(views_of(c, options)));
    if (!contradiction.empty()) c.poor.push_back(contradiction);
    return verdict;
}

double inverse_focal_sigma(const FocalVerdict& verdict, const SphereCamera& camera) {
    const double here = camera.focal_px ? 1 / *camera.focal_px : 0;
    double farthest = 0;
    for (const Known& other : verdict.alternatives())
        farthest = std::max(farthest, std::abs(other.value - here));
    return std::hypot(verdict.inverse_focal.sigma, verdict.doubt() * farthest);
}

double turned_by_focal_length(const SphereView& sphere, const SphereCamera& camera,
                              const FocalVerdict& verdict) {
    return glm::length(sphere.image.centre_px - camera.principal_px) * inverse_focal_sigma(verdict, camera);
}

void tell_of_focal_length(SphereCalibration& c, const std::vector<SphereView>& views,
                          const FocalVerdict& verdict) {
    if (verdict.uses(FocalSource::given) || verdict.uses(FocalSource::lengths)) return;
    if (c.camera.focal_px) {
        c.warnings.push_back(fmt::format(
            "the focal length {}; by the spheres it is {:.0f} ± {:.0f} px: --focal-px or "
            "--focal-35mm makes it "
            "sure",
            is_rejected(verdict, FocalSource::given) ? "that is given is not used" : "is not given",
            *c.camera.focal_px, verdict.inverse_focal.sigma * *c.camera.focal_px * *c.camera.focal_px));
        return;
    }
    double turned = 0;
    for (const SphereView& view : views)
        turned = std::max(turned, kDegrees * turned_by_focal_length(view, c.camera, verdict));
    if (turned < kTurned) return;
    (turned > kTurnedPoor ? c.poor : c.warnings)
        .push_back(fmt::format("the focal length is not known, and the camera is taken to be far away; a "
                               "lens may turn directions by "
                               "{:.1f} degrees where the sphere lies: give --focal-px or --focal-35mm",
                               turned));
}

void add_parallax(SphereCalibration& c, const SphereView& sphere) {
    const double sigma_deg =
        kDegrees * glm::length(sphere.image.centre_px - c.origin_px) / (kFarLights * diagonal_of(c));
    for (CalibratedLight& light : c.lights)
        if (light.direction) light.direction_sigma_deg = std::hypot(light.direction_sigma_deg, sigma_deg);
    if (sigma_deg < kTurned) return;
    (sigma_deg > kTurnedPoor ? c.poor : c.warnings)
        .push_back(
            fmt::format("one sphere tells directions as seen from where it lies, {:.0f} pixels from the "
                        "painting's middle; seen from "
                        "there, lights two picture diagonals away are turned by {:.1f} degrees, nearer "
                        "ones by more: a second sphere "
                        "would tell how near they are",
                        glm::length(sphere.image.centre_px - c.origin_px), sigma_deg));
}

}  // namespace tangi
