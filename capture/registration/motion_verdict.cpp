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
// [1] times the least median distance from all others, by which the first photograph may lie off: of places
// that scatter at random (Gaussian), 58 % do.
constexpr double kNear = 1.5;
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

namespace {

// Whether the camera moved, and what of the photographs' motions is the camera's.
class MotionVerdict {
public:
    MotionVerdict(const AlignedStack& stack, const Alignment& alignment);
    Registration registration() const;

private:
    bool jumped(std::size_t i) const {
        return alignment_.pictures[i].correlation > kTrustedAlone &&
               rms_displacement(rest_.from_middle(i)) >
                   std::max({kJumpPx, flat_, kJumpScales * rest_.typical_px,
                             kJumpErrors * own_error_px(alignment_.pictures[i])});
    }
    std::size_t find_reference() const;
    double median_distance_px(std::size_t i) const;
    Homography without_shading(std::size_t i) const {
        Homography h = alignment_.pictures[i].homography;
        if (!shading_is_motion_)
            h = h * homography_of({-rest_.shading.of_photo[i].x, -rest_.shading.of_photo[i].y}, stack_.frame);
        return h;
    }
    // `back`: to the reference frame.
    PhotoDrift drift_of(std::size_t i, const Homography& back) const;

    const AlignedStack& stack_;
    const Alignment& alignment_;
    std::vector<bool> found_, counted_;
    const double flat_;  // [pixels] error with too few photographs to tell relief from motion
    Rest rest_;
    bool all_moved_ = false;
    bool shading_is_motion_ = false;  // shifts that go with the light are the camera's as well
    std::size_t reference_ = 0;
};

MotionVerdict::MotionVerdict(const AlignedStack& stack, const Alignment& alignment)
    : stack_(stack),
      alignment_(alignment),
      flat_(stack.fitted < Alignment::kEnoughForRelief ? kFlatErrorPx : 0) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        found_.push_back(was_found(alignment.pictures[i]));
        counted_.push_back(found_[i] && stack.in_model[i]);
        if (counted_[i]) errors.push_back(own_error_px(alignment.pictures[i]));
    }
    rest_ = rest_of(stack, alignment, counted_);
    all_moved_ = rest_.typical_px > std::max({kMovedPx, flat_, kMovedErrors * median(std::move(errors))});
    shading_is_motion_ = all_moved_ && !rest_.shading.exceeds_motion;
    reference_ = find_reference();
}

// [pixels] Of the others that were found, from this one.
double MotionVerdict::median_distance_px(std::size_t i) const {
    const Homography back = glm::inverse(without_shading(i));
    std::vector<double> distances;
    for (std::size_t k = 0; k < stack_.photos.size(); ++k)
        if (found_[k] && k != i)
            distances.push_back(
                rms_displacement(motion_of(normalised(without_shading(k) * back), stack_.frame)));
    return median(std::move(distances));
}

// The first photograph by path, whose frame masks and calibrations have, of those that were found for sure
// and did not jump. Where it lies apart from the others, the one that is nearest to all: what is resampled by
// less is the sharper, and a picture relit is seen where most photographs saw it.
std::size_t MotionVerdict::find_reference() const {
    std::vector<double> correlations;
    for (std::size_t i = 0; i < stack_.photos.size(); ++i)
        if (found_[i]) correlations.push_back(alignment_.pictures[i].correlation);
    const double least = median(std::move(correlations)) / 2;  // less may be there by chance
    std::vector<std::size_t> likely;
    for (std::size_t i = 0; i < stack_.photos.size(); ++i)
        if (found_[i] && alignment_.pictures[i].correlation >= least && (all_moved_ || !jumped(i)))
            likely.push_back(i);
    if (likely.empty()) return 0;
    std::ranges::sort(likely, {}, [&](std::size_t i) { return stack_.photos[i]->path; });
    if (!all_moved_) return likely.front();
    std::vector<double> distances;
    for (const std::size_t i : likely) distances.push_back(median_distance_px(i));
    const auto nearest = std::ranges::min_element(distances);
    return distances.front() <= kNear * *nearest
               ? likely.front()
               : likely[static_cast<std::size_t>(nearest - distances.begin())];
}

PhotoDrift MotionVerdict::drift_of(std::size_t i, const Homography& back) const {
    const AlignedPicture& picture = alignment_.pictures[i];
    const double of_reference = all_moved_ ? own_error_px(alignment_.pictures[reference_]) : 0;
    PhotoDrift d;
    d.name = stack_.photos[i]->light.name;
    d.registered = found_[i];
    d.correlation = picture.correlation;
    d.model = picture.last.model;
    if (stack_.lights[i] != glm::dvec3(stack_.photos[i]->light.direction))
        d.per_photo_light = stack_.lights[i];
    d.homography = normalised(without_shading(i) * back);
    if (all_moved_ && i == reference_) d.homography = Homography(1);
    d.drift_px = rms_displacement(motion_of(d.homography, stack_.frame));
    d.error_px = std::hypot(own_error_px(picture), of_reference, flat_);
    // In a stack that stood still, what is left is the error.
    if (!all_moved_) d.error_px = std::hypot(d.error_px, rest_.typical_px);
    d.warped = i != reference_ && found_[i] && d.drift_px > d.error_px && (all_moved_ || jumped(i));
    // Shared by all photographs alike, it is no reason to leave one of them as it is.
    if (shading_is_motion_)
        d.error_px = std::hypot(d.error_px, tied_error_px(stack_, alignment_, i, reference_));
    return d;
}

Registration MotionVerdict::registration() const {
    Registration result;
    result.reference = stack_.photos[reference_]->light.name;
    result.shading_px = shading_is_motion_ ? 0 : rest_.shading.rms_px;
    // Where the camera stood still but for jumps, it is where it stood that counts, not one photograph.
    const Homography back =
        glm::inverse(all_moved_ ? without_shading(reference_) : homography_of(rest_.middle, stack_.frame));
    std::vector<double> drifts;
    for (std::size_t i = 0; i < stack_.photos.size(); ++i) {
        PhotoDrift d = drift_of(i, back);
        if (found_[i]) drifts.push_back(d.drift_px);
        result.moved = result.moved || d.warped;
        (i < stack_.fitted ? result.photos : result.held_out).push_back(std::move(d));
    }
    result.typical_drift_px = median(std::move(drifts));
    return result;
}

}  // namespace

Registration camera_motions(const AlignedStack& stack, const Alignment& alignment) {
    return MotionVerdict(stack, alignment).registration();
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
