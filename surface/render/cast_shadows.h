// cast_shadows.h: the part of a light that reaches a place past the relief, by marching over its heights.
#pragma once

#include <vector>

#include "surface/image/image.h"
#include "surface/render/shadow_march.h"

namespace tangi {

// From a pixel one looks along the way to the light, in steps of one pixel, at the relief there (bilinear
// between pixels). Relief that ends p pixels above that line (below: p < 0), q pixels along it, hides the
// part of a disc that lies below c = p / sqrt((q tan(radius))^2 + (w / 2)^2) of its radius: the disc of the
// light, widened by the pixel's own extent. For within a pixel the light's line rises by w = sin(elevation) -
// slope cos(elevation) pixels against the ground, which slopes by `slope` towards the light: before the
// pixel's middle, where the edge of a shadow is that leaves the middle lit, else behind it. So shadows are
// what a camera sees of them, their mean over a pixel: also those of a point, which begin where they reach
// the pixel's border. What hides most counts. A pixel beyond the picture's border casts no shadow; nor do
// heights of one row or column.
//
// Stretches over which nothing rises high enough to matter are skipped: of blocks of 4, 8, 16 … pixels the
// highest point of them and their eight neighbours is known (a maximum mipmap: Tevs, Ihrke & Seidel 2008,
// "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering"). What is skipped changes
// no result but for rounding. Keeps a reference to the heights; needs half a byte a pixel beside them.
class CastShadows {
public:
    // `light_radius_deg`: angular radius of the lights, at least 0.
    CastShadows(const Image<float>& height_mm, double mm_per_pixel, double light_radius_deg);
    CastShadows(const CastShadows&) = delete;
    CastShadows& operator=(const CastShadows&) = delete;

    // Part, 0..1, of a light in this direction [unit vector] that reaches a pixel, in the mean over it.
    float visible_part(int x, int y, const Vec3& direction) const;

    // The same of the pixels (x, y) to (x + kMarchLanes - 1, y) whose bit of `which`, from the lowest on, is
    // set; each has a light of its own. 1 beyond the border; parts that are not asked for stay what they are.
    // Faster than one by one the more are asked for. Differs from that, and from one processor to another, by
    // rounding; beside heights that are not a number, by whether a way that just touches them meets them.
    void visible_parts(int x, int y, const MarchLights& lights, std::uint32_t which, float* parts) const;

    // [1] Tangent of an elevation above which a point is seen by all of a pixel, whatever the direction;
    // infinite where the height is not a number. An upper bound, at least 0.
    float steepest_horizon(int x, int y) const;

    // [mm] No less than the highest point within that many pixels.
    float highest_within(int x, int y, int pixels) const;

    // Whether all of a light is so far above a horizon of this tangent that visible_part() of a pixel with
    // this steepest_horizon() is 1. `across`: length of the direction's x and y.
    bool clears(float horizon, float across, float z) const {
        return z > 0 && z - horizon * across >= scene_.tangent / kLeastRest * (across + horizon * z);
    }

private:
    // [1] Half a pixel, and what it leaves of the way to the next one.
    static constexpr float kPixel = 0.5f, kLeastRest = 1 - kPixel;

    const Image<float>& height_mm_;
    // [k] of the blocks of 2^(kFinestBlock + k) pixels: the highest point of each and its neighbours
    std::vector<Image<float>> highest_;
    ShadowScene scene_;  // of both
};

}  // namespace tangi
