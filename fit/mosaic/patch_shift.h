// patch_shift.h: the shift of a small patch of two pictures that lie on each other but for it.
#pragma once

#include <array>
#include <functional>

#include "surface/image/homography.h"
#include "surface/image/image.h"

namespace tangi {

// [pixels] What local_contrast() needs around a patch.
constexpr int kLookMargin = 26;

// Two pictures of one place, of paint and of relief.
using LookPictures = std::array<std::reference_wrapper<const Image<float>>, 2>;

struct PatchShift {
    glm::dvec2 shift{0};     // [pixels of the other] beyond where the homography leads
    double sigma = 0;        // [pixels] standard error of each coordinate, the larger
    double correlation = 0;  // [1]
    bool found = false;      // within reach, with edges in both directions
};

// Gauss-Newton of the squared differences between the patch of `half` pixels around `centre` and what of the
// other lies there (Lucas & Kanade 1981), each kind of picture weighted by what it leaves. Pixels that are
// NaN in either have no say.
PatchShift patch_shift(const LookPictures& own, const LookPictures& other, const glm::dvec2& centre,
                       double half, const Homography& to_other, double reach);

}  // namespace tangi
