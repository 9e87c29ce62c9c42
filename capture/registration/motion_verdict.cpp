#include "capture/registration/motion_verdict.h"

#include <algorithm>
#include <cmath>

#include "capture/registration/shading_induced_motion.h"
#include "capture/stack/duplicate_photos.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

// Motions are measured by what they displace over the whole picture (rms): shift, zoom, roll and tilt alike.
constexpr double kMovedPx = 0.12;      // [pixels] typical motion beyond shading from which on a stack moved
constexpr double kJumpPx = 0.25;       // [pixels] of single photographs of a stack that did not
constexpr double kJumpScales = 5;      // [1] and of the typical motion
constexpr double kMovedErrors = 2;     // [1] and times the median photograph's error
constexpr double kJumpErrors = 5;      // [1] and times its own
constexpr double kTrustedAlone = 0.8;  // [1] correlation from which on one photograph's jump is believed
// [pixels] of shift, when l.xy / l.z changes by 1, that shadows and gloss at edges may feign for a whole
// stack: what was seen in generated stacks of other paintings.
constexpr double kTiedErrorPx = 0.04;
constexpr double kLeastErrorPx = 0.02;  // [pixels]
constexpr double kFlatErrorPx = 0.5;    // [pixels] with too few photographs to tell relief from motion
constexpr double kLeastCertainty = 6;   // [standard errors]
constexpr double kTellingMotion = 0.5;  // [1] of the median photograph's contrast must be expected of one ...
constexpr double kLowLight = 0.26;      // [1] ... whose light has this z, for it to be missed: 15 degrees

// [pixels] Standard error of one photograph's motion in the joint frame.
double own_error_px(const AlignedPicture& picture) {
    return std::hypot(rms_displacement(picture.covariance), picture.model_error_px, kLeastErrorPx);
}

// [pixels] Standard error of what is linear in the light, of one photograph against another: relief looks
// like it to first order, so that a whole stack shares an error of it.
double tied_error_px(const AlignedStack& stack, const Alignment& alignment, std::size_t i,
                     std::size_t reference) {
    const auto slopes = [&](std::size_t k) {
        const glm::dvec3& l = stack.lights[k];
        return glm::dvec2(l.x, l.y) / std::max(l.z, kLowLight);
    };
    const glm::dvec2 d = slopes(i) - slopes(reference);
    const auto& c = alignment.tied.covariance;
    MotionMatrix of_motion;
    for (std::size_t p = 0; p < kMotion; ++p)
        for (std::size_t q = 0; q < kMotion; ++q)
            of_motion[p][q] = d.x * d.x * c[2 * p][2 * q] + d.y * d.y * c[2 * p + 1][2 * q + 1] +
                              d.x * d.y * (c[2 * p][2 * q + 1] + c[2 * p + 1][2 * q]);
    return std::hypot(rms_displacement(of_motion), kTiedErrorPx * glm::length(d));
}

// What the motions have beyond the shifts that go with the light.
struct Rest {
    SharedShading shading;
    std::vector<MotionVector> motions;  // [pixels]
    MotionVector middle{};              // [pixels] their median
    double typical_px = 0;              // [pixels] median displacement from that

    MotionVector from_middle(std::size_t i) const {
        MotionVector d = motions[i];
        for (std::size_t p = 0; p < kMotion; ++p) d[p] -= middle[p];
        return d;
    }
};

// A highlight or shadow that shifts edges shifts them alike all over the picture, or nearly so: what zooms,
// turns or tilts it is the camera.
Rest rest_of(const AlignedStack& stack, const Alignment& alignment, const std::vector<bool>& counted) {
    Rest result;
    std::vector<glm::dvec2> shifts;
    for (const AlignedPicture& picture : alignment.pictures) {
        result.motions.push_back(motion_of(picture.homography, stack.frame));
        shifts.emplace_back(result.motions.back()[0], result.motions.back()[1]);
    }
    result.shading = shared_shading(shifts, stack.lights, counted);
    std::array<std::vector<double>, kMotion> values;
    for (std::size_t i = 0; i < result.motions.size(); ++i) {
        result.motions[i][0] = result.shading.rest[i].x;
        result.motions[i][1] = result.shading.rest[i].y;
        for (std::size_t p = 0; p < kMotion; ++p)
            if (counted[i]) values[p].push_back(result.motions[i][p]);
    }
    for (std::size_t p = 0; p < kMotion; ++p) result.middle[p] = median(std::move(values[p]));
    std::vector<double> lengths;
    for (std::size_t i = 0; i < result.motions.size(); ++i) {
        if (!counted[i]) continue;
        MotionVector d = result.from_middle(i);
        d[0] *= result.shading.taken_up, d[1] *= result.shading.taken_up;
        lengths.push_back(rms_displacement(d));
    }
    result.typical_px = median(std::move(lengths));
    return result;
}

}  // namespace

bool was_found(const AlignedPicture& picture) {
    return picture.certainty > kLeastCertainty && picture.correlation > kNothingAlike &&
           picture.last.model != MotionModel::none;
}

Registration camera_motions(const AlignedStack& stack, const Alignment& alignment) {
    const std::size_t count = stack.photos.size();
    std::vector<bool> found, counted;
    std::vector<double> errors, drifts;
    for (std::size_t i = 0; i < count; ++i) {
        found.push_back(was_found(alignment.pictures[i]));
        counted.push_back(found[i] && stack.in_model[i]);
        if (counted[i]) errors.push_back(own_error_px(alignment.pictures[i]));
    }
    const Rest rest = rest_of(stack, alignment, counted);
    const SharedShading& shading = rest.shading;
    const double flat = stack.fitted < Alignment::kEnoughForRelief ? kFlatErrorPx : 0;
    const bool all_moved =
        rest.typical_px > std::max({kMovedPx, flat, kMovedErrors * median(std::move(errors))});
    const bool shading_is_motion = all_moved && !shading.exceeds_motion;
    const auto jumped = [&](std::size_t i) {
        return alignment.pictures[i].correlation > kTrustedAlone &&
               rms_displacement(rest.from_middle(i)) >
                   std::max({kJumpPx, flat, kJumpScales * rest.typical_px,
                             kJumpErrors * own_error_px(alignment.pictures[i])});
    };
    std::vector<double> correlations;
    for (std::size_t i = 0; i < count; ++i)
        if (found[i]) correlations.push_back(alignment.pictures[i].correlation);
    const double least = median(std::move(correlations)) / 2;  // less may be there by chance
    std::size_t reference = count;
    for (std::size_t i = 0; i < count; ++i)
        if (found[i] && alignment.pictures[i].correlation >= least && (all_moved || !jumped(i)) &&
            (reference == count || stack.photos[i]->path < stack.photos[reference]->path))
            reference = i;
    if (reference == count) reference = 0;

    Registration result;
    result.reference = stack.photos[reference]->light.name;
    result.shading_px = shading_is_motion ? 0 : shading.rms_px;
    const auto without_shading = [&](std::size_t i) {
        Homography h = alignment.pictures[i].homography;
        if (!shading_is_motion)
            h = h * homography_of({-shading.of_photo[i].x, -shading.of_photo[i].y}, stack.frame);
        return h;
    };
    // Where the camera stood still but for jumps, it is where it stood that counts, not one photograph.
    const Homography back =
        glm::inverse(all_moved ? without_shading(reference) : homography_of(rest.middle, stack.frame));
    const double of_reference = all_moved ? own_error_px(alignment.pictures[reference]) : 0;
    for (std::size_t i = 0; i < count; ++i) {
        const AlignedPicture& picture = alignment.pictures[i];
        PhotoDrift d;
        d.name = stack.photos[i]->light.name;
        d.registered = found[i];
        d.correlation = picture.correlation;
        d.model = picture.last.model;
        if (stack.lights[i] != glm::dvec3(stack.photos[i]->light.direction))
            d.per_photo_light = stack.lights[i];
        d.homography = normalised(without_shading(i) * back);
        if (all_moved && i == reference) d.homography = Homography(1);
        d.drift_px = rms_displacement(motion_of(d.homography, stack.frame));
        d.error_px = std::hypot(own_error_px(picture), of_reference, flat);
        // In a stack that stood still, what is left is the error.
        if (!all_moved) d.error_px = std::hypot(d.error_px, rest.typical_px);
        d.warped = i != reference && found[i] && d.drift_px > d.error_px && (all_moved || jumped(i));
        // Shared by all photographs alike, it is no reason to leave one of them as it is.
        if (shading_is_motion)
            d.error_px = std::hypot(d.error_px, tied_error_px(stack, alignment, i, reference));
        if (found[i]) drifts.push_back(d.drift_px);
        result.moved = result.moved || d.warped;
        (i < stack.fitted ? result.photos : result.held_out).push_back(std::move(d));
    }
    result.typical_drift_px = median(std::move(drifts));
    return result;
}

std::vector<bool> showing_something_else(const AlignedStack& stack, const Alignment& alignment) {
    std::vector<double> expected, contrasts, correlations;
    for (const AlignedPicture& picture : alignment.pictures) {
        expected.push_back(picture.expected);
        contrasts.push_back(picture.contrast);
        correlations.push_back(picture.correlation);
    }
    const double middle = median(std::move(expected)), contrast = median(std::move(contrasts));
    const bool others_agree = median(std::move(correlations)) > kOthersAgree;
    std::vector<bool> strange;
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        const AlignedPicture& picture = alignment.pictures[i];
        const bool others_edges = others_agree && picture.contrast > kEdgesOfItsOwn * contrast;
        strange.push_back((stack.lights[i].z > kLowLight || others_edges) &&
                          picture.expected > kTellingMotion * middle && picture.correlation <= kNothingAlike);
    }
    return strange;
}

}  // namespace tangi
