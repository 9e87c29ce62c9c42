#include "fit/evaluate/compared_motions.h"

#include <algorithm>
#include <glm/matrix.hpp>

#include "capture/photo/rejected_photo.h"
#include "capture/registration/registration.h"
#include "capture/stack/stack_calibration.h"
#include "fit/pipeline/photo_prefetch.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// As of single photographs of a stack that the fit registers (capture/registration/motion_verdict.cpp,
// registration.cpp).
constexpr double kLeastDrift_px = 0.25, kSureOfDrift = 5;  // [pixels], [standard errors]
constexpr int kLeastSideToRegister = 96;                   // [pixels]

Image<float> brightness_of(const Image<Rgb>& stored, const Transfer& transfer) {
    Image<float> result(stored.width(), stored.height());
    for (std::size_t i = 0; i < result.size(); ++i) {
        const Rgb& value = stored.pixels()[i];
        result.pixels()[i] =
            (transfer.decode(value.r) + transfer.decode(value.g) + transfer.decode(value.b)) / 3;
    }
    return result;
}

// What became of photographs, by their names.
struct Laid {
    std::vector<std::string> moved, lost;
    double farthest_px = 0;

    std::vector<std::string> in_words(const std::string& folder) const {
        std::vector<std::string> told;
        if (!moved.empty())
            told.push_back(fmt::format(
                "{}: {} photograph{} that the painting does not list {} laid onto it, by up to {:.1f} px: {}",
                folder, moved.size(), moved.size() == 1 ? "" : "s", moved.size() == 1 ? "is" : "are",
                farthest_px, joined(moved)));
        if (!lost.empty())
            told.push_back(
                fmt::format("{}: {} photograph{} that the painting does not list cannot be registered to it, "
                            "and {} compared "
                            "as {}: {}; figures are too low where the camera stood elsewhere",
                            folder, lost.size(), lost.size() == 1 ? "" : "s", lost.size() == 1 ? "is" : "are",
                            lost.size() == 1 ? "it is" : "they are", joined(lost)));
        return told;
    }
};

}  // namespace

std::vector<std::string> register_unknown(std::span<StackPhoto> photos, const Stack& stack,
                                          const Photography& photography, const Transfer& transfer,
                                          const RelitPicture& relit, const Progress& progress) {
    if (std::min(stack.width(), stack.height()) < kLeastSideToRegister) return {};
    // Of the part in the whole picture, which homographies are of.
    const Homography corner(1, 0, 0, 0, 1, 0, stack.crop.x0, stack.crop.y0, 1);
    std::vector<StackPhoto*> unknown;
    std::vector<StackPhoto> to_read;
    for (StackPhoto& photo : photos)
        if (!find_photo(photography, photo.light)) unknown.push_back(&photo), to_read.push_back(photo);
    PhotosAhead ahead(stack, std::move(to_read));
    Image<Rgb> drawn(stack.width(), stack.height());
    Laid laid;
    for (std::size_t i = 0; i < unknown.size(); ++i) {
        report(progress, "register", static_cast<double>(i) / static_cast<double>(unknown.size()));
        StackPhoto& photo = *unknown[i];
        try {
            const Image<float> shown = brightness_of(ahead.next().picture, transfer);
            relit(photo, drawn);
            const PhotoDrift drift = register_pictures(brightness_of(drawn, transfer), shown);
            if (!(drift.drift_px > std::max(kLeastDrift_px, kSureOfDrift * drift.error_px))) continue;
            photo.homography = corner * drift.homography * glm::inverse(corner);
            laid.moved.push_back(photo.light.name);
            laid.farthest_px = std::max(laid.farthest_px, drift.drift_px);
        } catch (const PhotoError&) {
            continue;
        } catch (const Error&) {
            laid.lost.push_back(photo.light.name);
        }
    }
    return laid.in_words(stack.folder.string());
}

}  // namespace tangi
