#include "surface/image_file/image_alpha.h"

#include <algorithm>

#include "surface/base/error.h"

namespace tangi {

void see_through(Image<float>& mask, const Image<float>& alpha) {
    if (alpha.empty()) return;
    TP_REQUIRE(mask.region() == alpha.region(), "a mask and its alpha have one size");
    constexpr float one_tone = 2.5f / 255;  // of 8 bits, multiplied by alpha and divided again
    float darkest = 1, lightest = 0, least = 1;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        least = std::min(least, alpha.pixels()[i]);
        if (alpha.pixels()[i] < 0.5f) continue;
        darkest = std::min(darkest, mask.pixels()[i]);
        lightest = std::max(lightest, mask.pixels()[i]);
    }
    const bool has_holes = least < 0.5f;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const float part = std::clamp(alpha.pixels()[i], 0.0f, 1.0f);
        mask.pixels()[i] = has_holes && lightest - darkest < one_tone ? part : part * mask.pixels()[i];
    }
}

}  // namespace tangi
