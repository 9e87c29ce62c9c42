#include "fit/height/subpixel_slopes.h"

#include <cmath>

#include "fit/height/slope_edges.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// The slope of a pixel, as steep as the mean of what it mixes.
Slope steepened(const Image<Vec3>& normal, const Image<float>& confidence, float mixing, int x, int y) {
    const Slope s = slope_of(normal(x, y));
    const float spread = slope_spread(normal, confidence, x, y);
    const float factor = 1 + mixing * spread * spread / (1 + s.x * s.x + s.y * s.y);
    return {factor * s.x, factor * s.y};
}

// [1] Slopes within a pixel whose neighbours' differ by `spread` are some 0.2 spread from their mean (0.29 of
// a step where they change evenly, and the largest of eight differences is a diagonal's). Brightness that
// varies by a tenth beside them moves their mean by a tenth of that. Set by what stated errors cover on
// generated stacks (bench/generated).
constexpr float kMixingError = 0.02f;

}  // namespace

Image<Vec3> steepened_normals(const Image<Vec3>& normal, const Image<float>& confidence, double mixing) {
    TP_REQUIRE(normal.region() == confidence.region(), "normals and confidence have one size");
    TP_REQUIRE(mixing >= 0, "a variance");
    const int width = normal.width(), height = normal.height();
    const auto known = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < width && y < height && confidence(x, y) > 0;
    };
    const auto at = [&](int x, int y) {
        return steepened(normal, confidence, static_cast<float>(mixing), x, y);
    };
    Image<Vec3> result = normal;
    parallel_for(0, height, 16, [&](int begin, int end) {
        // Three rows of steepened slopes move down with y.
        const auto row_of = [&](int y) {
            std::vector<Slope> row(static_cast<std::size_t>(width));
            for (int x = 0; x < width; ++x)
                if (known(x, y)) row[static_cast<std::size_t>(x)] = at(x, y);
            return row;
        };
        std::vector<Slope> above = row_of(begin - 1), own = row_of(begin), below;
        for (int y = begin; y < end; ++y) {
            below = row_of(y + 1);
            for (int x = 0; x < width; ++x) {
                if (!known(x, y)) continue;
                const auto i = static_cast<std::size_t>(x);
                Slope s = own[i];
                if (known(x - 1, y) && known(x + 1, y))
                    s.x -= (own[i - 1].x + own[i + 1].x - 2 * own[i].x) / 12;
                if (known(x, y - 1) && known(x, y + 1)) s.y -= (above[i].y + below[i].y - 2 * own[i].y) / 12;
                result(x, y) = normal_of(s);
            }
            above = std::move(own);
            own = std::move(below);
        }
    });
    return result;
}

void add_mixing_error(const Image<Vec3>& normal, const Image<float>& confidence,
                      Image<HalfError>& slope_error) {
    TP_REQUIRE(normal.region() == confidence.region() && normal.region() == slope_error.region(), "one size");
    parallel_for(0, normal.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < normal.width(); ++x)
                if (confidence(x, y) > 0)
                    slope_error(x, y) = std::hypot(float(slope_error(x, y)),
                                                   kMixingError * slope_spread(normal, confidence, x, y));
    });
}

}  // namespace tangi
