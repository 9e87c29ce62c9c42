#include "capture/registration.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>

#include "capture/coarse_shift.h"
#include "capture/shared_shading.h"
#include "capture/stray_photos.h"
#include "surface/error.h"
#include "surface/median.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kLeastSide = 96;         // [pixels] of a picture whose cells are enough to judge motion by
constexpr int kLookedAt = 1000000;     // pixels of all photographs together
constexpr int kIterations = 8;         // on the finest level; half on the coarser
constexpr double kFloor = 0.05;        // [1] of the stack's mean brightness: contrast fades below it
constexpr double kFarPx = 12;          // [pixels] from which patches are read again where they moved to
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
constexpr double kTelling = 0.5;        // [1] of the median photograph's contrast must be expected of one ...
constexpr double kLowLight = 0.26;      // [1] ... whose light has this z, for it to be missed: 15 degrees
constexpr std::size_t kBandBytes = 64u << 20;

Image<float> halved(const Image<float>& image) {
    Image<float> half(image.width() / 2, image.height() / 2);
    for (int y = 0; y < half.height(); ++y)
        for (int x = 0; x < half.width(); ++x)
            half(x, y) = (image(2 * x, 2 * y) + image(2 * x + 1, 2 * y) + image(2 * x, 2 * y + 1) +
                          image(2 * x + 1, 2 * y + 1)) /
                         4;
    return half;
}

void collect(const Stack& stack, PictureCollector& collector) {
    if (stack.photos.empty()) return;
    StackReader reader(stack);
    const int rows = reader.rows_for(kBandBytes);
    for (int y = 0; y < stack.height(); y += rows)
        collector.add(reader.read(y, std::min(y + rows, stack.height()), Transfer{}));
}

Stack only_held_out(const Stack& stack) {
    Stack other = stack;
    other.photos = stack.held_out;
    other.held_out.clear();
    return other;
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

}  // namespace

// One registration at work.
class Registrar {
public:
    Registrar(Stack& stack, const Transfer& transfer, const Progress& progress)
        : stack_(stack), transfer_(transfer), progress_(progress), fitted_(stack.photos.size()) {
        for (const auto* list : {&stack.photos, &stack.held_out})
            for (const StackPhoto& photo : *list) {
                photos_.push_back(&photo);
                lights_.emplace_back(photo.light.direction);
                in_model_.push_back(list == &stack.photos);
            }
        // The frame is that of the whole photographs' centre of interest: the stack's.
        frame_ = MotionFrame(stack.width(), stack.height());
        frame_.centre += glm::dvec2(stack.crop.x0, stack.crop.y0);
    }

    Registration run(const PictureCollector& fitted, const PictureCollector& held_out) {
        report(progress_, "register", 0);
        Alignment alignment(frame_, lights_, in_model_);
        align_overviews(alignment, merged(fitted.overview_, held_out.overview_));
        if (!fitted.patches_.empty()) align_patches(alignment, fitted, held_out);
        Registration result = decide(alignment);
        apply(result, strange_ones(alignment));
        report(progress_, "register", 1);
        return result;
    }

private:
    // Step by step, so that a user can stop it.
    void iterate(Alignment& alignment, MotionModel largest, int times, double from, double to) const {
        for (int k = 0; k < times; ++k) {
            report(progress_, "register", from + (to - from) * k / times);
            alignment.iterate(largest, 1);
        }
    }

    // Windows of both lists of photographs, in linear light.
    AlignmentWindow merged(const AlignmentWindow& a, const AlignmentWindow& b) const {
        AlignmentWindow window = a;
        window.pictures.insert(window.pictures.end(), b.pictures.begin(), b.pictures.end());
        for (Image<float>& picture : window.pictures)
            for (float& value : picture.pixels()) value = transfer_.decode(value);
        return window;
    }

    void to_contrast(AlignmentWindow& window) const {
        parallel_for(0, static_cast<int>(window.pictures.size()), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                Image<float>& picture = window.pictures[static_cast<std::size_t>(i)];
                picture = local_contrast(picture, floor_);
            }
        });
    }

    int pixels_to_look_at() const {
        return std::clamp(kLookedAt / static_cast<int>(photos_.size()), 6000, 24000);
    }

    void align_overviews(Alignment& alignment, AlignmentWindow whole) {
        double sum = 0, count = 0;
        for (const Image<float>& picture : whole.pictures)
            for (const float value : picture.pixels()) sum += value, count += 1;
        floor_ = std::max(kFloor * sum / std::max(count, 1.0), 1e-12);
        AlignmentWindow half = whole;
        half.reduction *= 2;
        half.origin += glm::dvec2(whole.reduction / 2);
        for (Image<float>& picture : half.pictures) picture = halved(picture);
        to_contrast(whole);
        to_contrast(half);
        const std::vector<glm::dvec2> shifts = coarse_shifts(half.pictures, lights_, in_model_);
        for (std::size_t i = 0; i < shifts.size(); ++i) {
            const glm::dvec2 shift = half.reduction * shifts[i];
            alignment.pictures[i].homography = homography_of({shift.x, shift.y}, frame_);
        }
        const std::vector<AlignmentWindow> coarse{std::move(half)}, fine{std::move(whole)};
        alignment.look_at(coarse, pixels_to_look_at());
        iterate(alignment, MotionModel::similarity, kIterations / 2, 0.1, 0.2);
        alignment.look_at(fine, pixels_to_look_at());
        iterate(alignment, MotionModel::homography, kIterations, 0.2, 0.5);
        // Shadows may have misled the coarse step; the frame of the others is the other likely place.
        bool again = false;
        for (std::size_t i = 0; i < shifts.size(); ++i)
            if (!was_found(alignment.pictures[i]) && shifts[i] != glm::dvec2(0)) {
                alignment.pictures[i].homography = Homography(1);
                again = true;
            }
        if (again) iterate(alignment, MotionModel::homography, kIterations / 2, 0.5, 0.6);
    }

    void align_patches(Alignment& alignment, const PictureCollector& fitted,
                       const PictureCollector& held_out) {
        double farthest = 0;
        for (const AlignedPicture& picture : alignment.pictures)
            farthest = std::max(farthest, rms_displacement(motion_of(picture.homography, frame_)));
        std::vector<Homography> before;
        const PictureCollector *of_fitted = &fitted, *of_held_out = &held_out;
        Stack warped = stack_, warped_held_out = only_held_out(stack_);
        std::optional<PictureCollector> again, again_held_out;
        if (farthest > kFarPx) {
            for (std::size_t i = 0; i < photos_.size(); ++i) {
                before.push_back(alignment.pictures[i].homography);
                (i < fitted_ ? warped.photos[i] : warped_held_out.photos[i - fitted_]).homography =
                    before.back();
                alignment.pictures[i].homography = Homography(1);
            }
            collect(warped, again.emplace(warped));
            collect(warped_held_out, again_held_out.emplace(warped_held_out));
            of_fitted = &*again, of_held_out = &*again_held_out;
        }
        std::vector<AlignmentWindow> windows;
        for (std::size_t k = 0; k < of_fitted->patches_.size(); ++k) {
            windows.push_back(merged(of_fitted->patches_[k], of_held_out->patches_.empty()
                                                                 ? AlignmentWindow{}
                                                                 : of_held_out->patches_[k]));
            to_contrast(windows.back());
        }
        alignment.look_at(windows, pixels_to_look_at());
        iterate(alignment, MotionModel::homography, kIterations, 0.6, 1);
        for (std::size_t i = 0; i < before.size(); ++i)
            alignment.pictures[i].homography = before[i] * alignment.pictures[i].homography;
    }

    bool was_found(const AlignedPicture& picture) const {
        return picture.certainty > kLeastCertainty && picture.correlation > kNothingAlike &&
               picture.last.model != MotionModel::none;
    }

    // [pixels] Standard error of one photograph's motion in the joint frame.
    double own_error_px(const AlignedPicture& picture) const {
        return std::hypot(rms_displacement(picture.covariance), picture.model_error_px, kLeastErrorPx);
    }

    // [pixels] Standard error of what is linear in the light, of one photograph against another: relief looks
    // like it to first order, so that a whole stack shares an error of it.
    double tied_error_px(const Alignment& alignment, std::size_t i, std::size_t reference) const {
        const auto slopes = [&](std::size_t k) {
            const glm::dvec3& l = lights_[k];
            return glm::dvec2(l.x, l.y) / std::max(l.z, kLowLight);
        };
        const glm::dvec2 d = slopes(i) - slopes(reference);
        const MotionMatrix& c = alignment.tied.covariance;
        const auto variance = [&](std::size_t p) {
            return d.x * d.x * c[p][p] + 2 * d.x * d.y * c[p][p + 1] + d.y * d.y * c[p + 1][p + 1];
        };
        return std::hypot(std::sqrt(std::max(variance(0) + variance(2), 0.0)), kTiedErrorPx * glm::length(d));
    }

    // Which part of the motions is the camera's, and how certain each is.
    Registration decide(const Alignment& alignment) const {
        const std::size_t count = photos_.size();
        std::vector<glm::dvec2> shifts;
        std::vector<bool> found, counted;
        std::vector<double> errors, drifts;
        for (std::size_t i = 0; i < count; ++i) {
            const AlignedPicture& picture = alignment.pictures[i];
            const MotionVector m = motion_of(picture.homography, frame_);
            shifts.emplace_back(m[0], m[1]);
            found.push_back(was_found(picture));
            counted.push_back(found[i] && in_model_[i]);
            if (counted[i]) errors.push_back(own_error_px(picture));
        }
        const SharedShading shading = shared_shading(shifts, lights_, counted);
        const double flat = fitted_ < Alignment::kEnoughForRelief ? kFlatErrorPx : 0;
        const bool all_moved =
            shading.typical_rest_px > std::max({kMovedPx, flat, kMovedErrors * median(std::move(errors))});
        const bool shading_is_motion = all_moved && !shading.exceeds_motion;
        const auto jumped = [&](std::size_t i) {
            return alignment.pictures[i].correlation > kTrustedAlone &&
                   glm::length(shading.rest[i] - shading.middle_rest) >
                       std::max({kJumpPx, flat, kJumpScales * shading.typical_rest_px,
                                 kJumpErrors * own_error_px(alignment.pictures[i])});
        };
        std::vector<double> correlations;
        for (std::size_t i = 0; i < count; ++i)
            if (found[i]) correlations.push_back(alignment.pictures[i].correlation);
        const double least = median(std::move(correlations)) / 2;  // less may be there by chance
        std::size_t reference = count;
        for (std::size_t i = 0; i < count; ++i)
            if (found[i] && alignment.pictures[i].correlation >= least && (all_moved || !jumped(i)) &&
                (reference == count || photos_[i]->path < photos_[reference]->path))
                reference = i;
        if (reference == count) reference = 0;

        Registration result;
        result.reference = photos_[reference]->light.name;
        result.shading_px = shading_is_motion ? 0 : shading.rms_px;
        const auto without_shading = [&](std::size_t i) {
            Homography h = alignment.pictures[i].homography;
            if (!shading_is_motion)
                h = h * homography_of({-shading.of_photo[i].x, -shading.of_photo[i].y}, frame_);
            return h;
        };
        // Where the camera stood still but for jumps, it is where it stood that counts, not one photograph.
        const Homography back =
            glm::inverse(all_moved ? without_shading(reference)
                                   : homography_of({shading.middle_rest.x, shading.middle_rest.y}, frame_));
        const double of_reference = all_moved ? own_error_px(alignment.pictures[reference]) : 0;
        for (std::size_t i = 0; i < count; ++i) {
            const AlignedPicture& picture = alignment.pictures[i];
            PhotoDrift d;
            d.name = photos_[i]->light.name;
            d.registered = found[i];
            d.correlation = picture.correlation;
            d.model = picture.last.model;
            d.homography = normalised(without_shading(i) * back);
            if (all_moved && i == reference) d.homography = Homography(1);
            d.drift_px = rms_displacement(motion_of(d.homography, frame_));
            d.error_px = std::hypot(own_error_px(picture), of_reference, flat);
            // In a stack that stood still, what is left is the error.
            if (!all_moved) d.error_px = std::hypot(d.error_px, shading.typical_rest_px);
            d.warped = i != reference && found[i] && d.drift_px > d.error_px && (all_moved || jumped(i));
            // Shared by all photographs alike, it is no reason to leave one of them as it is.
            if (shading_is_motion)
                d.error_px = std::hypot(d.error_px, tied_error_px(alignment, i, reference));
            if (found[i]) drifts.push_back(d.drift_px);
            result.moved = result.moved || d.warped;
            (i < fitted_ ? result.photos : result.held_out).push_back(std::move(d));
        }
        result.typical_drift_px = median(std::move(drifts));
        return result;
    }

    // Whether a photograph in which nothing was found must show something else: its edges are not where those
    // of the others are (in the photograph that shows all highlights of metal and varnish they are there, but
    // too few to say exactly where), though it is not lit so evenly that nothing can be expected of it, nor
    // so low, unless it has edges of its own where the others agree on theirs.
    std::vector<bool> strange_ones(const Alignment& alignment) const {
        std::vector<double> expected, contrasts, correlations;
        for (const AlignedPicture& picture : alignment.pictures) {
            expected.push_back(picture.expected);
            contrasts.push_back(picture.contrast);
            correlations.push_back(picture.correlation);
        }
        const double middle = median(std::move(expected)), contrast = median(std::move(contrasts));
        const bool others_agree = median(std::move(correlations)) > kOthersAgree;
        std::vector<bool> strange;
        for (std::size_t i = 0; i < photos_.size(); ++i) {
            const AlignedPicture& picture = alignment.pictures[i];
            const bool others_edges = others_agree && picture.contrast > kEdgesOfItsOwn * contrast;
            strange.push_back((lights_[i].z > kLowLight || others_edges) &&
                              picture.expected > kTelling * middle && picture.correlation <= kNothingAlike);
        }
        return strange;
    }

    void apply(const Registration& result, const std::vector<bool>& strange) {
        const Stack before = stack_;
        std::vector<std::string> lost;
        const auto keep = [&](std::vector<StackPhoto>& photos, const std::vector<PhotoDrift>& drifts,
                              std::size_t first) {
            std::vector<StackPhoto> kept;
            for (std::size_t i = 0; i < photos.size(); ++i) {
                const PhotoDrift& d = drifts[i];
                if (!d.registered && (result.moved || strange[first + i])) {
                    lost.push_back(d.name);
                    continue;
                }
                kept.push_back(photos[i]);
                if (d.warped) kept.back().homography = d.homography;
            }
            photos = std::move(kept);
        };
        keep(stack_.photos, result.photos, 0);
        keep(stack_.held_out, result.held_out, fitted_);
        if (lost.empty()) return;
        if (lost.size() == photos_count(result)) return take_as_they_were(before);
        if (stack_.photos.size() < 4)
            fail(
                "{}: {} of {} photographs cannot be registered to {}: {}. Are they of the same painting? "
                "--register off takes them as they are",
                stack_.folder.string(), lost.size(), photos_count(result), result.reference, joined(lost));
        stack_.warnings.push_back(fmt::format(
            "{}: left out {} photograph{} that cannot be registered to {}: {}", stack_.folder.string(),
            lost.size(), lost.size() == 1 ? "" : "s", result.reference, joined(lost)));
    }

    // Nothing was found anywhere: the pictures have no edges to register them by.
    void take_as_they_were(const Stack& before) {
        stack_ = before;
        stack_.warnings.push_back(fmt::format(
            "{}: nothing in the photographs tells whether the camera moved; they are taken as they are",
            stack_.folder.string()));
    }

    static std::size_t photos_count(const Registration& r) { return r.photos.size() + r.held_out.size(); }

    Stack& stack_;
    const Transfer transfer_;
    const Progress& progress_;
    std::size_t fitted_;
    std::vector<const StackPhoto*> photos_;
    std::vector<glm::dvec3> lights_;
    std::vector<bool> in_model_;
    MotionFrame frame_;
    double floor_ = 1;
};

Registration register_stack(Stack& stack, const PictureCollector& collected, const Transfer& transfer,
                            const Progress& progress) {
    TP_REQUIRE(collected.photos() == static_cast<int>(stack.photos.size()), "the pictures are of this stack");
    if (stack.photos.size() < 2 || std::min(stack.width(), stack.height()) < kLeastSide) return {};
    const Stack held_out = only_held_out(stack);
    PictureCollector collected_held_out(held_out);
    collect(held_out, collected_held_out);
    return Registrar(stack, transfer, progress).run(collected, collected_held_out);
}

Registration register_stack(Stack& stack, const Transfer& transfer, const Progress& progress) {
    PictureCollector collected(stack);
    collect(stack, collected);
    return register_stack(stack, collected, transfer, progress);
}

nlohmann::json to_json(const Registration& registration) {
    const auto list = [](const std::vector<PhotoDrift>& drifts) {
        nlohmann::json photos = nlohmann::json::array();
        for (const PhotoDrift& d : drifts) {
            const glm::dvec3* h = &d.homography[0];
            photos.push_back(
                {{"name", d.name},
                 {"registered", d.registered},
                 {"warped", d.warped},
                 {"drift_px", d.drift_px},
                 {"standard_error_px", d.error_px},
                 {"model", name_of(d.model)},
                 {"correlation", d.correlation},
                 {"homography",
                  {{h[0].x, h[1].x, h[2].x}, {h[0].y, h[1].y, h[2].y}, {h[0].z, h[1].z, h[2].z}}}});
        }
        return photos;
    };
    if (registration.reference.empty()) return {{"done", false}};
    return {{"done", true},
            {"reference", registration.reference},
            {"moved", registration.moved},
            {"typical_drift_px", registration.typical_drift_px},
            {"apparent_drift_of_shading_px", registration.shading_px},
            {"photos", list(registration.photos)},
            {"held_out", list(registration.held_out)}};
}

}  // namespace tangi
