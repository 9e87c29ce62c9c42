#include "surface/cast_shadows.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kFinest = 2;  // blocks of 4 pixels: smaller ones cost as much to look at as the heights
constexpr int kFinestBlock = 1 << kFinest;
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

float bilinear(const Image<float>& image, float x, float y) {
    const int x0 = std::min(static_cast<int>(x), image.width() - 2);
    const int y0 = std::min(static_cast<int>(y), image.height() - 2);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const float top = image(x0, y0) + fx * (image(x0 + 1, y0) - image(x0, y0));
    const float bottom = image(x0, y0 + 1) + fx * (image(x0 + 1, y0 + 1) - image(x0, y0 + 1));
    return top + fy * (bottom - top);
}

}  // namespace

CastShadows::CastShadows(const Image<float>& height_mm, double mm_per_pixel, double light_radius_deg)
    : height_mm_(height_mm),
      mm_per_pixel_(static_cast<float>(mm_per_pixel)),
      light_radius_rad_(static_cast<float>(light_radius_deg) * kPi / 180),
      cosine_(std::cos(light_radius_rad_)),
      sine_(std::sin(light_radius_rad_)) {
    TP_REQUIRE(mm_per_pixel > 0 && light_radius_deg >= 0, "a scale and an angular radius");
    Image<float> maxima = block_maxima(height_mm, kFinestBlock);
    highest_.push_back(with_neighbours(maxima));
    // Until a block and its neighbours are all there is.
    while (maxima.width() > 2 || maxima.height() > 2) {
        maxima = block_maxima(maxima, 2);
        highest_.push_back(with_neighbours(maxima));
    }
    highest_mm_ = highest_of(maxima, 0, 0, maxima.width(), maxima.height());
}

// Of all that a march from here can meet within 2^(kFinest + level) - 1 pixels.
float CastShadows::highest_around(std::size_t level, int x, int y) const {
    const int shift = kFinest + static_cast<int>(level);
    return highest_[level](x >> shift, y >> shift);
}

float CastShadows::steepest_horizon(int x, int y) const {
    const float z0 = height_mm_(x, y);
    if (std::isnan(z0)) return std::numeric_limits<float>::infinity();
    // One pixel away; 2 to 3, 4 to 7 … pixels away; beyond.
    float steepest = highest_of(height_mm_, x - 1, y - 1, x + 2, y + 2) - z0;
    float distance = kFinestBlock / 2;
    for (std::size_t level = 0; level < highest_.size(); ++level, distance *= 2)
        steepest = std::max(steepest, (highest_around(level, x, y) - z0) / distance);
    return std::max(steepest, (highest_mm_ - z0) / distance) / mm_per_pixel_;
}

// Tangent of the horizon's elevation in direction (dx, dy) [unit, pixels, y down] as seen from a pixel, or
// `floor` where it is lower; of one that is above `enough`, only that it is.
float CastShadows::horizon(int x, int y, float dx, float dy, float floor, float enough) const {
    const float z0 = height_mm_(x, y);
    const float right = static_cast<float>(height_mm_.width() - 1);
    const float bottom = static_cast<float>(height_mm_.height() - 1);
    float best = floor;
    std::size_t level = 0;
    for (float t = 1;;) {
        const float px = static_cast<float>(x) + t * dx, py = static_cast<float>(y) + t * dy;
        if (!(px >= 0 && py >= 0 && px <= right && py <= bottom)) return best;  // NaN leaves, too
        const float matters = best * t * mm_per_pixel_;
        if (highest_mm_ - z0 <= matters) return best;
        // What a horizon below the horizontal hides grows with the distance.
        if (best >= 0) {
            const float above = highest_around(level, static_cast<int>(px), static_cast<int>(py)) - z0;
            if (above <= matters) {
                t += static_cast<float>(kFinestBlock << level);
                level = std::min(level + 1, highest_.size() - 1);
                continue;
            }
            if (level > 0) {
                --level;
                continue;
            }
        }
        for (int step = 0; step < kFinestBlock; ++step, t += 1) {
            const float sx = static_cast<float>(x) + t * dx, sy = static_cast<float>(y) + t * dy;
            if (!(sx >= 0 && sy >= 0 && sx <= right && sy <= bottom)) return best;
            best = std::max(best, (bilinear(height_mm_, sx, sy) - z0) / (t * mm_per_pixel_));
        }
        if (best > enough) return best;
    }
}

float CastShadows::visible_part(int x, int y, const Vec3& l) const {
    const float across = std::sqrt(l.x * l.x + l.y * l.y);
    // Straight from above nothing can stand in the way.
    if (across < 1e-6f || height_mm_.width() < 2 || height_mm_.height() < 2) return 1;
    const auto elevation = [&] { return std::atan2(l.z, across); };
    // Tangent of the light's lower rim; by the addition theorem, since most pixels need no more than it.
    const float floor = l.z > 0 ? (l.z * cosine_ - across * sine_) / (across * cosine_ + l.z * sine_)
                                : std::tan(std::max(elevation() - light_radius_rad_, -1.5f));
    // That of its upper rim, and a little more than rounding: what is above hides all of it.
    const float upper = across * cosine_ - l.z * sine_;
    const float rim =
        upper > 0 ? (l.z * cosine_ + across * sine_) / upper : std::numeric_limits<float>::max();
    const float enough = rim + 1e-3f * std::abs(rim) + 1e-4f;
    const float tangent = horizon(x, y, l.x / across, -l.y / across, floor, enough);
    if (tangent <= floor) return 1;
    // At least -1: rounding can put a horizon that touches the light's lower rim below it.
    const float covered = light_radius_rad_ > 0
                              ? std::max((std::atan(tangent) - elevation()) / light_radius_rad_, -1.0f)
                              : 1.0f;
    if (covered >= 1) return 0;
    // Area of the part of a unit disc above the line at height `covered`.
    const float area = std::acos(covered) - covered * std::sqrt(1 - covered * covered);
    return std::clamp(area / kPi, 0.0f, 1.0f);
}

}  // namespace tangi
