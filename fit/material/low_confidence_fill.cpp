#include "fit/material/low_confidence_fill.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "fit/height/slope_edges.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr float kUnsureBelow = 0.3f;  // [1] confidence
constexpr int kBorrowsFrom = 6;       // [pixels]
// Standard errors are those of the side that was taken for granted: the slope is off by twice as much.
constexpr float kOwnDoubt = 4;
constexpr float kLeastSpread = 0.1f;  // [1] of slopes
// [1] Nearer to the slopes around, a pixel is as noisy as dark paint is, and no flank that is none.
constexpr float kFlank = 0.5f;

struct Neighbours {
    float weights = 0, square = 0;  // sum of squares of the slope's components
    Slope slope{0, 0};
    Rgb diffuse{0};
    float specular = 0, roughness = 0;

    void add(const Surface& s, int x, int y, float weight) {
        const Slope here = slope_of(s.normal(x, y));
        weights += weight;
        slope.x += weight * here.x;
        slope.y += weight * here.y;
        square += weight * (here.x * here.x + here.y * here.y);
        diffuse += weight * s.diffuse(x, y);
        specular += weight * s.specular(x, y);
        roughness += weight * s.roughness(x, y);
    }
    void finish() {
        const float each = 1 / weights;
        slope = {slope.x * each, slope.y * each};
        square = std::max(square * each - slope.x * slope.x - slope.y * slope.y, 0.0f);
        diffuse *= each;
        specular *= each;
        roughness *= each;
    }
    // [1] Variance of a slope's component.
    float variance() const { return square / 2 + kLeastSpread * kLeastSpread; }
};

Neighbours neighbours_of(const Surface& s, int x, int y) {
    Neighbours sum;
    for (int v = std::max(y - kBorrowsFrom, 0); v <= std::min(y + kBorrowsFrom, s.height() - 1); ++v)
        for (int u = std::max(x - kBorrowsFrom, 0); u <= std::min(x + kBorrowsFrom, s.width() - 1); ++u) {
            const float confidence = s.confidence(u, v);
            if (confidence < kUnsureBelow) continue;
            const auto dx = static_cast<float>(u - x), dy = static_cast<float>(v - y);
            sum.add(s, u, v, confidence / (1 + dx * dx + dy * dy));
        }
    if (sum.weights > 0) sum.finish();
    return sum;
}

}  // namespace

void fill_low_confidence(Surface& s) {
    // Only what is sure is looked at, and only the rest is changed.
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) {
                const float confidence = s.confidence(x, y);
                if (!(confidence > 0 && confidence < kUnsureBelow)) continue;
                const Neighbours there = neighbours_of(s, x, y);
                if (!(there.weights > 0)) continue;
                const float own = there.variance() /
                                  (there.variance() + kOwnDoubt * slope_variance_of(confidence)),
                            other = 1 - own;
                const Slope slope = slope_of(s.normal(x, y));
                if (std::hypot(slope.x - there.slope.x, slope.y - there.slope.y) < kFlank) continue;
                s.normal(x, y) = glm::normalize(Vec3(-(own * slope.x + other * there.slope.x),
                                                     -(own * slope.y + other * there.slope.y), 1));
                s.diffuse(x, y) = own * s.diffuse(x, y) + other * there.diffuse;
                s.specular(x, y) = own * s.specular(x, y) + other * there.specular;
                const float roughness = own * s.roughness(x, y) + other * there.roughness;
                if (!s.lobe_axes.empty()) s.lobe_axes(x, y).roughness_v *= roughness / s.roughness(x, y);
                s.roughness(x, y) = roughness;
            }
    });
}

}  // namespace tangi
