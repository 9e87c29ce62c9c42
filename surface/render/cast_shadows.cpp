#include "surface/render/cast_shadows.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kLowest = std::numeric_limits<float>::lowest();

int blocks(int pixels, int size) { return (pixels + size - 1) / size; }

// The highest of what `image` has in a rectangle, as far as it exists. Not a number is not high.
float highest_of(const Image<float>& image, int x0, int y0, int x1, int y1) {
    float highest = kLowest;
    for (int y = std::max(y0, 0); y < std::min(y1, image.height()); ++y)
        for (int x = std::max(x0, 0); x < std::min(x1, image.width()); ++x)
            highest = std::max(highest, image(x, y));
    return highest;
}

float lowest_of(const Image<float>& image, int x0, int y0, int x1, int y1) {
    float lowest = std::numeric_limits<float>::max();
    for (int y = std::max(y0, 0); y < std::min(y1, image.height()); ++y)
        for (int x = std::max(x0, 0); x < std::min(x1, image.width()); ++x)
            lowest = std::min(lowest, image(x, y));
    return lowest;
}

// One pixel for each block of `size` pixels a side.
Image<float> block_maxima(const Image<float>& image, int size) {
    Image<float> result(blocks(image.width(), size), blocks(image.height(), size));
    parallel_for(0, result.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < result.width(); ++x)
                result(x, y) = highest_of(image, x * size, y * size, (x + 1) * size, (y + 1) * size);
    });
    return result;
}

Image<float> with_neighbours(const Image<float>& image) {
    Image<float> result(image.width(), image.height());
    parallel_for(0, image.height(), 64, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < image.width(); ++x)
                result(x, y) = highest_of(image, x - 1, y - 1, x + 2, y + 2);
    });
    return result;
}

// Area of the part of a unit disc above the line at height c.
float part_above(float c) {
    if (c <= -1) return 1;
    if (c >= 1) return 0;
    return std::clamp((std::acos(c) - c * std::sqrt(1 - c * c)) / kPi, 0.0f, 1.0f);
}

}  // namespace

CastShadows::CastShadows(const Image<float>& height_mm, double mm_per_pixel, double light_radius_deg)
    : height_mm_(height_mm) {
    TP_REQUIRE(mm_per_pixel > 0 && light_radius_deg >= 0 && light_radius_deg < 90,
               "a scale and an angular radius");
    TP_REQUIRE(height_mm.size() <= std::numeric_limits<std::int32_t>::max(), "lanes count pixels in 32 bits");
    Image<float> maxima = block_maxima(height_mm, 1 << kFinestBlock);
    highest_.push_back(with_neighbours(maxima));
    // Until a block and its neighbours are all there is.
    while (maxima.width() > 2 || maxima.height() > 2) {
        maxima = block_maxima(maxima, 2);
        highest_.push_back(with_neighbours(maxima));
    }
    scene_ = {.height_mm = height_mm.data(),
              .width = height_mm.width(),
              .height = height_mm.height(),
              .mm_per_pixel = static_cast<float>(mm_per_pixel),
              .tangent = std::tan(static_cast<float>(light_radius_deg) * kPi / 180),
              .highest_mm = highest_of(maxima, 0, 0, maxima.width(), maxima.height()),
              .levels = {}};
    for (const Image<float>& level : highest_) scene_.levels.push_back({level.data(), level.width()});
}

float CastShadows::steepest_horizon(int x, int y) const {
    const float z0 = height_mm_(x, y);
    if (std::isnan(z0)) return std::numeric_limits<float>::infinity();
    // Relief with the tangent h, d pixels away, hides nothing where d (z - h across) >= w / 2. One pixel away
    // it is the ground's own slope, and w the same as what is left of it; farther away w <= z + drop across.
    const float mm = scene_.mm_per_pixel;
    const float beside = (highest_of(height_mm_, x - 1, y - 1, x + 2, y + 2) - z0) / mm;
    const float drop = (z0 - lowest_of(height_mm_, x - 1, y - 1, x + 2, y + 2)) / mm;
    float steepest = std::max(beside, 0.0f);
    const auto meet = [&](float highest_mm, float distance) {
        const float tangent = (highest_mm - z0) / (distance * mm), widened = kPixel / distance;
        steepest = std::max(steepest, (tangent + widened * drop) / (1 - widened));
    };
    // 2 to 3, 4 to 7 … pixels away; beyond.
    float distance = 2;
    for (int shift = kFinestBlock; const Image<float>& level : highest_) {
        meet(level(x >> shift, y >> shift), distance);
        distance *= 2;
        ++shift;
    }
    meet(scene_.highest_mm, distance);
    return steepest;
}

float CastShadows::highest_within(int x, int y, int pixels) const {
    for (int shift = kFinestBlock; const Image<float>& level : highest_) {
        if (pixels <= 1 << shift) return level(x >> shift, y >> shift);
        ++shift;
    }
    return scene_.highest_mm;
}

float CastShadows::visible_part(int x, int y, const Vec3& l) const {
    if (height_mm_.width() < 2 || height_mm_.height() < 2) return 1;
    return part_above(march_one(scene_, x, y, l.x, l.y, l.z));
}

void CastShadows::visible_parts(int x, int y, const MarchLights& lights, std::uint32_t which,
                                float* parts) const {
    std::array<float, kMarchLanes> covered;
    covered.fill(-1);
    if (height_mm_.width() >= 2 && height_mm_.height() >= 2)
        march_lanes(scene_, x, y, lights, which, covered.data());
    for (int lane = 0; lane < kMarchLanes; ++lane)
        if (which >> lane & 1) parts[lane] = part_above(covered[static_cast<std::size_t>(lane)]);
}

}  // namespace tangi
