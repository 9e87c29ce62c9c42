// brush_tip.h: the tip of a brush as a map of pixels that lie along its width and thickness: its dome, its
// bristles, and how much of each pixel it covers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "paint/brush/brush_settings.h"
#include "paint/exchange/bristle_rows.h"

namespace tangi {

class BrushTip {
public:
    static constexpr double kMeanShorter = 0.436;  // [1] of kTipField over many tufts, by counting

    BrushTip() = default;
    // The half extents [pixels] are those that the map has: more than the brush's where it is too small.
    BrushTip(const BrushSettings& settings, double mm_per_pixel, double half_width_px,
             double half_thickness_px, std::uint64_t seed);

    TipMap map() const { return {texels_.data(), longest_, steepest_, 2 * half_u_ + 1, 2 * half_v_ + 1}; }
    int half_u() const { return half_u_; }  // [pixels] from the map's middle to their border
    int half_v() const { return half_v_; }

    // [pixels] How far the part of the tip whose dome is below this reaches from its middle towards a unit
    // vector.
    float reach_px(float u, float v, float dome) const;

    // [mm] Paint at a place [pixels from the middle] of a load that has `middle_mm` in the middle, nothing at
    // the rim.
    float fresh_load_mm(float u, float v, float middle_mm) const;

private:
    // The finest bristles around a place, and the tufts in which they stick together.
    struct Hair;
    Hair hair(float u, float v) const;
    static float luck_of(const Hair& bristles);
    float dome_at(float u, float v) const;
    struct Filled {
        float cover = 0, load = 0, dome = 0;
    };
    Filled filled(int u, int v) const;
    void find_reach();

    BrushSettings settings_;
    double mm_per_pixel_ = 1;
    float half_width_px_ = 1, half_thickness_px_ = 1;
    std::uint64_t seed_ = 0;
    int half_u_ = 0, half_v_ = 0;
    std::vector<TexelPair> texels_;  // TipMap
    float longest_ = 1, steepest_ = 1;
    std::vector<float> load_;  // [1] of the load in the middle
    std::array<std::vector<float>, 2>
        reach_px_;        // to the rim and to kInner, towards directions at equal angles
    float fullness_ = 1;  // [1] what makes the whole load the same for any chance
};

}  // namespace tangi
