// slope_edges.h: how far the difference in height between two neighbouring pixels may be from the mean of
// their slopes.
//
// A slope as fitted is off by its own error, and it is that of what a pixel mixes: where slopes differ
// between neighbours, a trapezoid is no integral, and a normal is not the mean slope. Both variances make the
// weight of an edge; an edge that the surface disagrees with all the same is a cliff.
#pragma once

#include "fit/pixel/fit_errors.h"
#include "surface/maps/surface.h"

namespace tangi {

// [1] Standard error of a slope whose confidence is 1/2: confidence = 1 / (1 + (error / this)^2).
constexpr float kHalfConfidence = 0.1f;

// [1] Variance of a slope (dz/dx or dz/dy) by its confidence, which is > 0.
inline float slope_variance_of(float confidence) {
    return kHalfConfidence * kHalfConfidence * std::max(1 / confidence - 1, 0.0f);
}

// [1] By how much slopes differ around a pixel: the largest difference to one of the eight neighbours that
// were measured.
float slope_spread(const Image<Vec3>& normal, const Image<float>& confidence, int x, int y);

// [1] Part of the spread by which the height between two pixels may differ from the mean of their slopes,
// standard deviation. Pixels of generated paintings and of rendered meshes, which are means over their area,
// have 0.06 to 0.1 of it, whether they are smooth or rough (fit_tests --gtest_filter=SlopeEdges.*).
constexpr float kMixed = 0.08f;
// [1] No slope is better known: a third of a code of 8 bits.
constexpr float kSharpest = 0.002f;

// [1] Part of the spread by which the height of a pixel is off from its mean, in pixels, where it is the
// integral of true slopes by trapezoids. Where slopes change evenly that is a twelfth of the second
// difference, h^2 z'' / 12; with relief as fine as pixels it is 0.08 to 0.1 (the same tests). It is a
// height's error, not a slope's: differences between neighbours have it as a gradient, which no loop of edges
// shows and no weight averages out.
constexpr float kOffset = 0.1f;
// The same where what pixels mix was taken out of the slopes (subpixel_slopes.h), by as much as is right:
// 0.06 to 0.08 (the same tests).
constexpr float kSteepenedOffset = 0.07f;

// [1] What one end of an edge adds to the variance of the edge's difference in height, in pixels.
inline float edge_variance(float slope_variance, float spread) {
    const float mixed = kMixed * spread;
    return slope_variance / 4 + mixed * mixed / 2 + kSharpest * kSharpest;
}

// [1] Factor of the weight of an edge whose difference in height is off by r standard deviations: Cauchy's
// loss, as in iteratively reweighted least squares (Holland & Welsch 1977); at least 1e-3, which keeps the
// two sides of a cliff together where nothing else says how high it is. Geman & McClure's, which forgets a
// cliff altogether, recovers more of a step, but has so many minima that mirrored photographs find others.
inline float cliff_factor(float r2) {
    constexpr float kScale2 = 4;  // [1] (2 standard deviations)^2
    return std::max(1 / (1 + r2 / kScale2), 1e-3f);
}

// The edges of a field of normals: what they say about differences in height, and how certain it is. Keeps
// references to normals and confidence.
class SlopeEdges {
public:
    Image<HalfError> right, down;  // weights relative to the best edge's, as HeightMultigrid takes them
    float offset_part = kOffset;   // of offset_mm(): kOffset or kSteepenedOffset

    // `unmeasured_weight`: of pixels of confidence 0, relative to the best.
    SlopeEdges(const Image<Vec3>& normal, const Image<float>& confidence, double mm_per_pixel,
               double unmeasured_weight);

    const Image<float>& confidence() const { return confidence_; }
    Slope tilt() const { return tilt_; }  // [1] mean slope, which is not in the differences

    // Weights for these heights [mm]; null: as if all edges fitted.
    struct Moved {
        long edges = 0;   // whose factor moved by more than 0.1
        long cliffs = 0;  // whose factor is below 1/2
    };
    Moved weigh(const Image<float>* height_mm);

    // Right-hand side of the heights' equations: the divergence of weight * difference.
    void divergence(Image<float>& b) const;
    // The same of errors such as the differences have, +- one standard deviation each, for `draw` < 4: those
    // of slopes, and what this height [mm, without the tilt] leaves of an edge beyond its variance.
    void divergence_of_errors(int draw, const Image<float>& height_mm, Image<float>& b) const;

    // [mm] By how much a height is off, standard deviation, where it was integrated from slopes without
    // error.
    float offset_mm(int x, int y) const;

private:
    float difference_right(int x, int y) const;  // [mm]
    float difference_down(int x, int y) const;
    float slope_error(int x, int y) const;
    float unexplained(float off_mm, float variance, int x, int y, int draw, int which) const;
    void weigh(const Image<float>* z, float off_mm, float variance, HalfError& weight, Moved& moved) const;

    const Image<Vec3>& normal_;
    const Image<float>& confidence_;
    float mm_;
    // The tilt as a whole is a plane, known in closed form; without it heights are small and floats go
    // further.
    Slope tilt_;
    Image<HalfError> variance_;  // [pixels^2] edge_variance() of each end
};

}  // namespace tangi
