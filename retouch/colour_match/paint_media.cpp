#include "retouch/colour_match/paint_media.h"

#include <algorithm>

#include "paint/optics/kubelka_munk.h"

namespace tangi {

namespace {

constexpr double kColours = 20;  // [CIEDE2000]
constexpr float kWhiteGround = 0.8f, kBlackGround = 0.01f;

double change_of(float ground, const Pigment& paint) {
    Spectrum below;
    below.fill(ground);
    return delta_e_2000(lab_under(film_look({paint.k, paint.s}, kHidingThickness_mm, below)),
                        lab_under(below));
}

}  // namespace

bool is_medium(const Pigment& paint) {
    return std::max(change_of(kWhiteGround, paint), change_of(kBlackGround, paint)) < kColours;
}

std::vector<std::string> take_out_media(Palette& box) {
    std::vector<std::string> media;
    std::erase_if(box.paints, [&](const Pigment& paint) {
        if (!is_medium(paint)) return false;
        media.push_back(paint.name);
        return true;
    });
    return media;
}

}  // namespace tangi
