// cast_shadows.h: the part of a light that reaches a place past the relief, by marching over its heights.
#pragma once

#include <vector>

#include "surface/image.h"

namespace tangi {

// A pixel is marched in steps of one pixel towards the light; the highest horizon seen, bilinear between
// pixels, hides part of a disc around the light's direction. A pixel beyond the picture's border casts no
// shadow; nor do heights of one row or column.
//
// Stretches over which nothing rises high enough to matter are skipped: of blocks of 4, 8, 16 … pixels the
// highest point of them and their eight neighbours is known (a maximum mipmap: Tevs, Ihrke & Seidel 2008,
// "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering"). What is skipped changes
// no result but for rounding. Keeps a reference to the heights; needs half a byte a pixel beside them.
class CastShadows {
public:
    // `light_radius_deg`: angular radius of the lights, at least 0.
    CastShadows(const Image<float>& height_mm, double mm_per_pixel, double light_radius_deg);

    // Part, 0..1, of a light in this direction [unit vector] that reaches a pixel.
    float visible_part(int x, int y, const Vec3& direction) const;

    // [1] Upper bound of the tangent of the horizon's elevation as seen from a pixel, whatever the direction;
    // infinite where the height is not a number.
    float steepest_horizon(int x, int y) const;

    // Whether all of a light is above a horizon of this tangent: then visible_part() of a pixel with this
    // steepest_horizon() is 1. `across`: length of the direction's x and y.
    bool clears(float horizon, float across, float z) const {
        return z * cosine_ - across * sine_ >= horizon * (across * cosine_ + z * sine_);
    }

private:
    float horizon(int x, int y, float dx, float dy, float floor, float enough) const;
    float highest_around(std::size_t level, int x, int y) const;

    const Image<float>& height_mm_;
    float mm_per_pixel_, light_radius_rad_, cosine_, sine_, highest_mm_;
    // [kFinest + k] of the blocks of 2^(kFinest + k) pixels: the highest point of each and its neighbours
    std::vector<Image<float>> highest_;
};

}  // namespace tangi
