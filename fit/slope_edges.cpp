#include "fit/slope_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "surface/noise.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

// [1] Change of an edge's factor that counts.
constexpr float kFactorMoved = 0.1f;

constexpr std::uint64_t kErrorSeed = 47;

// Mean slope of the measured pixels.
Slope mean_slope(const Image<Vec3>& normal, const Image<float>& confidence) {
    std::vector<glm::dvec3> rows(static_cast<std::size_t>(normal.height()), glm::dvec3(0));
    parallel_for(0, normal.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < normal.width(); ++x) {
                if (!(confidence(x, y) > 0)) continue;
                const Slope s = slope_of(normal(x, y));
                rows[static_cast<std::size_t>(y)] += glm::dvec3(s.x, s.y, 1);
            }
    });
    const glm::dvec3 sum = std::accumulate(rows.begin(), rows.end(), glm::dvec3(0));
    if (!(sum.z > 0)) return {};
    return {static_cast<float>(sum.x / sum.z), static_cast<float>(sum.y / sum.z)};
}

// +1 or -1: bit `which` (0 to 3) of a draw's four at a pixel.
float sign_at(int x, int y, int draw, int which) {
    const std::uint64_t bits = procedural::hash(kErrorSeed, x, y);
    return (bits >> (4 * draw + which)) & 1 ? 1.0f : -1.0f;
}

// Sum over the edges of a pixel: those that come in less those that go out.
template <class Right, class Down>
void divergence_of(const SlopeEdges& edges, const Right& right, const Down& down, Image<float>& b) {
    parallel_for(0, b.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < b.width(); ++x) {
                float sum = 0;
                if (x > 0) sum += edges.right(x - 1, y) * right(x - 1, y);
                if (x + 1 < b.width()) sum -= edges.right(x, y) * right(x, y);
                if (y > 0) sum += edges.down(x, y - 1) * down(x, y - 1);
                if (y + 1 < b.height()) sum -= edges.down(x, y) * down(x, y);
                b(x, y) = sum;
            }
    });
}

}  // namespace

float slope_spread(const Image<Vec3>& normal, const Image<float>& confidence, int x, int y) {
    const Slope own = slope_of(normal(x, y));
    float largest2 = 0;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, normal.height() - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, normal.width() - 1); ++u) {
            if (!(confidence(u, v) > 0)) continue;
            const Slope s = slope_of(normal(u, v));
            largest2 = std::max(largest2, (s.x - own.x) * (s.x - own.x) + (s.y - own.y) * (s.y - own.y));
        }
    return std::sqrt(largest2);
}

SlopeEdges::SlopeEdges(const Image<Vec3>& normal, const Image<float>& confidence, double mm_per_pixel,
                       double unmeasured_weight)
    : right(normal.width(), normal.height()),
      down(normal.width(), normal.height()),
      normal_(normal),
      confidence_(confidence),
      mm_(static_cast<float>(mm_per_pixel)),
      tilt_(mean_slope(normal, confidence)),
      variance_(normal.width(), normal.height()) {
    const float unmeasured = kSharpest * kSharpest / static_cast<float>(unmeasured_weight);
    parallel_for(0, normal.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < normal.width(); ++x) {
                const float c = confidence(x, y);
                if (!(c > 0)) {
                    variance_(x, y) = unmeasured;
                    continue;
                }
                // What was measured at all counts more than what was not.
                const float spread = slope_spread(normal, confidence, x, y);
                variance_(x, y) = std::min(edge_variance(slope_variance_of(c), spread), unmeasured / 2);
            }
    });
}

// What the slopes of both ends say about z at the other end, without the tilt. Rows run down, so a step of
// one row is -1 in y.
float SlopeEdges::difference_right(int x, int y) const {
    return mm_ * (0.5f * (slope_of(normal_(x, y)).x + slope_of(normal_(x + 1, y)).x) - tilt_.x);
}
float SlopeEdges::difference_down(int x, int y) const {
    return -mm_ * (0.5f * (slope_of(normal_(x, y)).y + slope_of(normal_(x, y + 1)).y) - tilt_.y);
}

// [pixels^2] What the slope's own error adds to the variance of an edge; the rest is what pixels mix.
float SlopeEdges::slope_part(int x, int y) const {
    const float c = confidence_(x, y);
    return c > 0 ? std::min(slope_variance_of(c) / 4, float(variance_(x, y))) : 0.0f;
}

// A slope's error is shared by the edges of its pixel; what a trapezoid misses is the edge's own.
float SlopeEdges::error_right(int x, int y, int draw) const {
    const float a = slope_part(x, y), b = slope_part(x + 1, y);
    const float rest = std::max(variance_(x, y) + variance_(x + 1, y) - a - b, 0.0f);
    return mm_ * (sign_at(x, y, draw, 0) * std::sqrt(a) + sign_at(x + 1, y, draw, 0) * std::sqrt(b) +
                  sign_at(x, y, draw, 1) * std::sqrt(rest));
}
float SlopeEdges::error_down(int x, int y, int draw) const {
    const float a = slope_part(x, y), b = slope_part(x, y + 1);
    const float rest = std::max(variance_(x, y) + variance_(x, y + 1) - a - b, 0.0f);
    return mm_ * (sign_at(x, y, draw, 2) * std::sqrt(a) + sign_at(x, y + 1, draw, 2) * std::sqrt(b) +
                  sign_at(x, y, draw, 3) * std::sqrt(rest));
}

void SlopeEdges::weigh(const Image<float>* z, float off_mm, float variance, HalfError& weight,
                       Moved& moved) const {
    const float best = 2 * kSharpest * kSharpest / variance;
    const float before = weight / best;
    const float factor = z ? cliff_factor(off_mm * off_mm / (mm_ * mm_ * variance)) : 1.0f;
    weight = best * factor;
    moved.edges += std::abs(factor - before) > kFactorMoved;
    moved.cliffs += factor < 0.5f;
}

SlopeEdges::Moved SlopeEdges::weigh(const Image<float>* z) {
    std::vector<Moved> rows(static_cast<std::size_t>(normal_.height()));
    parallel_for(0, normal_.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < normal_.width(); ++x) {
                Moved& row = rows[static_cast<std::size_t>(y)];
                if (x + 1 < normal_.width())
                    weigh(z, z ? (*z)(x + 1, y) - (*z)(x, y) - difference_right(x, y) : 0,
                          variance_(x, y) + variance_(x + 1, y), right(x, y), row);
                if (y + 1 < normal_.height())
                    weigh(z, z ? (*z)(x, y + 1) - (*z)(x, y) - difference_down(x, y) : 0,
                          variance_(x, y) + variance_(x, y + 1), down(x, y), row);
            }
    });
    Moved sum;
    for (const Moved& row : rows) {
        sum.edges += row.edges;
        sum.cliffs += row.cliffs;
    }
    return sum;
}

void SlopeEdges::divergence(Image<float>& b) const {
    divergence_of(
        *this, [&](int x, int y) { return difference_right(x, y); },
        [&](int x, int y) { return difference_down(x, y); }, b);
}

void SlopeEdges::divergence_of_errors(int draw, Image<float>& b) const {
    divergence_of(
        *this, [&](int x, int y) { return error_right(x, y, draw); },
        [&](int x, int y) { return error_down(x, y, draw); }, b);
}

}  // namespace tangi
