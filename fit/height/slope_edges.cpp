#include "fit/height/slope_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "surface/base/noise.h"
#include "surface/base/parallel.h"

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

// [pixels] Standard deviation of what the slope's own error adds to a difference. What was measured badly may
// be off by more than its weight, which has a floor, says.
float SlopeEdges::slope_error(int x, int y) const {
    const float c = confidence_(x, y);
    return std::sqrt(c > 0 ? slope_variance_of(c) / 4 : float(variance_(x, y)));
}

// [mm] What is left of an edge beyond its variance is an error that shows, and around a loop of edges as
// large a part of the errors does not.
float SlopeEdges::unexplained(float off_mm, float variance, int x, int y, int draw, int which) const {
    return sign_at(x, y, draw, which) * std::sqrt(std::max(off_mm * off_mm - mm_ * mm_ * variance, 0.0f));
}

float SlopeEdges::offset_mm(int x, int y) const {
    return mm_ * offset_part * slope_spread(normal_, confidence_, x, y);
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

void SlopeEdges::divergence_of_errors(int draw, const Image<float>& z, Image<float>& b) const {
    // A slope's error is shared by the edges of its pixel.
    const auto shared = [&](int x, int y, int which) {
        return mm_ * sign_at(x, y, draw, which) * slope_error(x, y);
    };
    const auto variance = [&](int x, int y, int u, int v) { return variance_(x, y) + variance_(u, v); };
    divergence_of(
        *this,
        [&](int x, int y) {
            const float off = z(x + 1, y) - z(x, y) - difference_right(x, y);
            return shared(x, y, 0) + shared(x + 1, y, 0) +
                   unexplained(off, variance(x, y, x + 1, y), x, y, draw, 1);
        },
        [&](int x, int y) {
            const float off = z(x, y + 1) - z(x, y) - difference_down(x, y);
            return shared(x, y, 2) + shared(x, y + 1, 2) +
                   unexplained(off, variance(x, y, x, y + 1), x, y, draw, 3);
        },
        b);
}

}  // namespace tangi
