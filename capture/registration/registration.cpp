#include "capture/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "capture/registration/coarse_shift.h"
#include "capture/registration/motion_verdict.h"
#include "capture/stack/stack_calibration.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kLeastSide = 96;          // [pixels] of a picture whose cells are enough to judge motion by
constexpr int kLookedAt = 1000000;      // pixels of all photographs together
constexpr int kIterations = 8;          // on the finest level; half on the coarser
constexpr float kBrightest = 1000;      // [1] times the median of a photograph: no painting shines so
constexpr double kFloor = 0.05;         // [1] of the stack's mean brightness: contrast fades below it
constexpr double kDoubtfulLight = 0.6;  // [1] of the median correlation: less, and the light may be another
constexpr double kShownLight = 0.6;     // [1] of it that another light must reach ...
constexpr double kMovedClearlyBetter = 0.2;  // [1] ... and by which it must be better
// [1] Part of what three terms of the light leave unexplained where nothing moved, that motions found from
// few photographs may leave at most to be believed.
constexpr double kBelieved = 0.8;
constexpr double kFarPx = 12;  // [pixels] from which patches are read again where they moved to
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

}  // namespace

// One registration at work.
class Registrar {
public:
    Registrar(Stack& stack, const Transfer& transfer, const Progress& progress)
        : stack_(stack), transfer_(transfer), progress_(progress) {
        aligned_.fitted = stack.photos.size();
        for (const auto* list : {&stack.photos, &stack.held_out})
            for (const StackPhoto& photo : *list) {
                aligned_.photos.push_back(&photo);
                aligned_.lights.emplace_back(photo.light.direction);
                aligned_.in_model.push_back(list == &stack.photos);
            }
        // The frame is that of the whole photographs' centre of interest: the stack's.
        aligned_.frame = MotionFrame(stack.width(), stack.height());
        aligned_.frame.centre += glm::dvec2(stack.crop.x0, stack.crop.y0);
    }

    Registration run(const PictureCollector& fitted, const PictureCollector& held_out) {
        report(progress_, "register", 0);
        Alignment alignment(aligned_.frame, aligned_.lights, aligned_.in_model);
        align_overviews(alignment, merged(fitted.overview_, held_out.overview_));
        if (!fitted.patches_.empty()) align_patches(alignment, fitted, held_out);
        Registration result = camera_motions(aligned_, alignment);
        apply(result, showing_something_else(aligned_, alignment));
        if (result.moved && are_few()) warn_of_few(result);
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
        TP_REQUIRE(a.origin == b.origin && a.reduction == b.reduction, "windows of one grid");
        AlignmentWindow window = a;
        window.pictures.insert(window.pictures.end(), b.pictures.begin(), b.pictures.end());
        parallel_for(0, static_cast<int>(window.pictures.size()), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                Image<float>& picture = window.pictures[static_cast<std::size_t>(i)];
                std::vector<float> known;  // NaN is no sample
                for (float& value : picture.pixels())
                    if (!std::isnan(value)) known.push_back(value = transfer_.decode(value));
                // What files of floats hold where something is wrong would be all that their mean shows.
                const float most = known.empty() ? 0 : kBrightest * median(std::move(known));
                if (most > 0)
                    for (float& value : picture.pixels()) value = std::min(value, most);
            }
        });
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
        return std::clamp(kLookedAt / static_cast<int>(aligned_.photos.size()), 6000, 24000);
    }

    void align_overviews(Alignment& alignment, AlignmentWindow whole) {
        double sum = 0, count = 0;
        for (std::size_t i = 0; i < aligned_.fitted; ++i)
            for (const float value : whole.pictures[i].pixels())
                if (!std::isnan(value)) sum += value, count += 1;
        floor_ = std::max(kFloor * sum / std::max(count, 1.0), 1e-12);
        AlignmentWindow half = whole;
        half.reduction *= 2;
        half.origin += glm::dvec2(whole.reduction / 2);
        for (Image<float>& picture : half.pictures) picture = halved(picture);
        to_contrast(whole);
        to_contrast(half);
        const std::vector<glm::dvec2> shifts =
            coarse_shifts(half.pictures, aligned_.lights, aligned_.in_model);
        for (std::size_t i = 0; i < shifts.size(); ++i) {
            const glm::dvec2 shift = half.reduction * shifts[i];
            alignment.pictures[i].homography = homography_of({shift.x, shift.y}, aligned_.frame);
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
        if (again) iterate(alignment, MotionModel::homography, kIterations / 2, 0.5, 0.55);
        if (relight(alignment)) iterate(alignment, MotionModel::homography, kIterations, 0.55, 0.6);
        weigh_few(alignment);
    }

    bool are_few() const { return aligned_.fitted < Alignment::kEnoughForRelief; }

    void warn_of_few(const Registration& result) {
        double farthest = 0;
        for (const PhotoDrift& photo : result.photos)
            if (photo.warped) farthest = std::max(farthest, photo.drift_px);
        stack_.warnings.push_back(fmt::format(
            "{}: the camera seems to have moved, by {:.1f} px at most; {} photographs tell that to half a "
            "pixel at best: photograph under {} lights or more, or with the camera on a stand, and say "
            "--register off",
            stack_.folder.string(), farthest, aligned_.fitted, Alignment::kEnoughForRelief));
    }

    // Few photographs are laid onto the mean of the others: relief, which that has not, looks like motion
    // there. Three terms of the light have it: where the motions leave no less unexplained than none at all
    // do, the camera stood still.
    void weigh_few(Alignment& alignment) const {
        if (!are_few() || aligned_.fitted < 4) return;
        const double found = alignment.unexplained();
        const std::vector<AlignedPicture> pictures = alignment.pictures;
        for (AlignedPicture& picture : alignment.pictures) picture.homography = Homography(1);
        const double none = alignment.unexplained();
        if (found < kBelieved * none) alignment.pictures = pictures;
    }

    // A light that is listed wrongly (lines that are exchanged) predicts shading that is not there, and moves
    // the photograph to where that is least wrong, or finds nothing in it. Photographs that their own light
    // explains badly, and another one well, are predicted under that one.
    bool relight(Alignment& alignment) {
        std::vector<double> correlations;
        for (const AlignedPicture& picture : alignment.pictures) correlations.push_back(picture.correlation);
        const double usual = median(std::vector<double>(
            correlations.begin(), correlations.begin() + static_cast<std::ptrdiff_t>(aligned_.fitted)));
        std::vector<std::size_t> doubtful;
        for (std::size_t i = 0; i < correlations.size(); ++i)
            if (correlations[i] < kDoubtfulLight * usual) doubtful.push_back(i);
        if (doubtful.empty()) return false;
        std::vector<Homography> before;
        for (const std::size_t i : doubtful) before.push_back(alignment.pictures[i].homography);
        const auto moved = alignment.per_photo_lights(doubtful);
        for (const std::size_t i : doubtful) alignment.pictures[i].homography = Homography(1);
        const auto still = alignment.per_photo_lights(doubtful);
        bool any = false;
        for (std::size_t k = 0; k < doubtful.size(); ++k) {
            const std::size_t i = doubtful[k];
            const bool stands = still[k] && (!moved[k] || still[k]->correlation > moved[k]->correlation);
            const auto& shown = stands ? still[k] : moved[k];
            const bool better = shown && shown->correlation > kShownLight * usual &&
                                shown->correlation > correlations[i] + kMovedClearlyBetter;
            if (!better || !stands) alignment.pictures[i].homography = before[k];
            if (!better) continue;
            alignment.set_light(i, shown->light);
            aligned_.lights[i] = shown->light;
            any = true;
        }
        return any;
    }

    void align_patches(Alignment& alignment, const PictureCollector& fitted,
                       const PictureCollector& held_out) {
        double farthest = 0;
        for (const AlignedPicture& picture : alignment.pictures)
            farthest = std::max(farthest, rms_displacement(motion_of(picture.homography, aligned_.frame)));
        const std::vector<AlignedPicture> overviews = alignment.pictures;
        const PictureCollector *of_fitted = &fitted, *of_held_out = &held_out;
        Stack warped = stack_, warped_held_out = only_held_out(stack_);
        std::optional<PictureCollector> again, again_held_out;
        if (farthest > kFarPx) {
            for (std::size_t i = 0; i < aligned_.photos.size(); ++i) {
                (i < aligned_.fitted ? warped.photos[i] : warped_held_out.photos[i - aligned_.fitted])
                    .homography = overviews[i].homography;
                alignment.pictures[i].homography = Homography(1);
            }
            collect(warped, again.emplace(fitted.grid(), fitted.photos()));
            collect(warped_held_out, again_held_out.emplace(held_out.grid(), held_out.photos()));
            of_fitted = &*again, of_held_out = &*again_held_out;
        }
        std::vector<AlignmentWindow> windows;
        for (std::size_t k = 0; k < of_fitted->patches_.size(); ++k) {
            windows.push_back(merged(of_fitted->patches_[k], of_held_out->patches_[k]));
            to_contrast(windows.back());
        }
        alignment.look_at(windows, pixels_to_look_at());
        iterate(alignment, MotionModel::homography, kIterations, 0.6, 1);
        if (!again) return weigh_few(alignment);
        for (std::size_t i = 0; i < overviews.size(); ++i) {
            AlignedPicture& picture = alignment.pictures[i];
            picture.homography = overviews[i].homography * picture.homography;
            if (picture.last.model != MotionModel::none)
                picture.last.model = std::max(picture.last.model, overviews[i].last.model);
        }
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
        keep(stack_.held_out, result.held_out, aligned_.fitted);
        if (lost.empty()) return;
        if (lost.size() == photos_count(result)) return take_as_they_were(before);
        if (stack_.photos.size() < 4)
            fail(
                "{}: {} of {} photographs cannot be registered to {}: {}. Are they of the same painting? "
                "--register off takes them as they are",
                stack_.folder.string(), lost.size(), photos_count(result), result.reference,
                joined(lost, lost.size()));
        stack_.warnings.push_back(fmt::format(
            "{}: rejected {} photograph{} that cannot be registered to {}: {}", stack_.folder.string(),
            lost.size(), lost.size() == 1 ? "" : "s", result.reference, joined(lost, lost.size())));
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
    AlignedStack aligned_;
    double floor_ = 1;
};

Registration register_stack(Stack& stack, const PictureCollector& collected, const Transfer& transfer,
                            const Progress& progress) {
    TP_REQUIRE(collected.photos() == static_cast<int>(stack.photos.size()), "the pictures are of this stack");
    if (stack.photos.size() < 2 || std::min(stack.width(), stack.height()) < kLeastSide) return {};
    const Stack held_out = only_held_out(stack);
    PictureCollector collected_held_out(collected.grid(), static_cast<int>(held_out.photos.size()));
    collect(held_out, collected_held_out);
    return Registrar(stack, transfer, progress).run(collected, collected_held_out);
}

Registration register_stack(Stack& stack, const Transfer& transfer, const Progress& progress) {
    PictureCollector collected(stack);
    collect(stack, collected);
    return register_stack(stack, collected, transfer, progress);
}

}  // namespace tangi
