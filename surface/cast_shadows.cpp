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
      tangent_(std::tan(static_cast<float>(light_radius_deg) * kPi / 180)) {
    TP_REQUIRE(mm_per_pixel > 0 && light_radius_deg >= 0 && light_radius_deg < 90,
               "a scale and an angular radius");
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
    // Relief with the tangent h, d pixels away, hides nothing where d (z - h across) >= w / 2. One pixel away
    // it is the ground's own slope, and w the same as what is left of it; farther away w <= z + drop across.
    const float beside = (highest_of(height_mm_, x - 1, y - 1, x + 2, y + 2) - z0) / mm_per_pixel_;
    const float drop = (z0 - lowest_of(height_mm_, x - 1, y - 1, x + 2, y + 2)) / mm_per_pixel_;
    float steepest = std::max(beside, 0.0f);
    const auto meet = [&](float highest_mm, float distance) {
        const float tangent = (highest_mm - z0) / (distance * mm_per_pixel_), widened = kPixel / distance;
        steepest = std::max(steepest, (tangent + widened * drop) / (1 - widened));
    };
    // 2 to 3, 4 to 7 … pixels away; beyond.
    float distance = kFinestBlock / 2;
    for (std::size_t level = 0; level < highest_.size(); ++level, distance *= 2)
        meet(highest_around(level, x, y), distance);
    meet(highest_mm_, distance);
    return steepest;
}

// From a pixel to a light, and how much of it is covered so far: c of the class's comment, from -1 on.
class CastShadows::Way {
public:
    // `across`: length of the direction's x and y.
    Way(const CastShadows& shadows, int x, int y, const Vec3& l, float across)
        : heights_(shadows.height_mm_),
          mm_(shadows.mm_per_pixel_),
          tangent_(shadows.tangent_),
          x_(static_cast<float>(x)),
          y_(static_cast<float>(y)),
          dx_(l.x / across),
          dy_(-l.y / across),
          z0_(heights_(x, y)),
          cosine_(across),
          sine_(l.z) {
        if (is_inside(1))
            before_ = half_width(rise(1)), behind_ = is_inside(-1) ? half_width(-rise(-1)) : before_;
        is(-1);
    }

    bool is_inside(float t) const {
        const float px = x_ + t * dx_, py = y_ + t * dy_;
        return px >= 0 && py >= 0 && px <= static_cast<float>(heights_.width() - 1) &&
               py <= static_cast<float>(heights_.height() - 1);
    }
    // [pixels] Height over the pixel, t pixels away, inside.
    float rise(float t) const { return rise_of(bilinear(heights_, x_ + t * dx_, y_ + t * dy_)); }
    int column(float t) const { return static_cast<int>(x_ + t * dx_); }
    int row(float t) const { return static_cast<int>(y_ + t * dy_); }
    float rise_of(float height_mm) const { return (height_mm - z0_) / mm_; }

    // Relief of this rise, t pixels away, hides no more than is hidden.
    bool hides_no_more(float rise, float t) const {
        return rise * sine_ + t * cosine_ >= 0 && rise * per_rise_ <= t * per_step_ - lag_;
    }
    // The same of all that is farther away.
    bool falls_behind() const { return per_step_ >= 0; }

    void meet(float rise, float t) {
        if (hides_no_more(rise, t)) return;
        const float far = tangent_ * std::max(rise * sine_ + t * cosine_, 0.0f);
        const float above = rise * cosine_ - t * sine_, width = above < 0 ? before_ : behind_;
        const float now = above / std::max(std::sqrt(far * far + width * width), kPoint);
        if (now > covered_) is(now);
    }
    float covered() const { return covered_; }

private:
    // [pixels] Half of w.
    float half_width(float slope) const {
        return kPixel * std::max(0.0f, sine_ - slope * cosine_);
    }  // NaN: 0

    static constexpr float kPoint = 1e-6f;  // [pixels] radius of a point

    // p > c sqrt((q tan)^2 + (w / 2)^2) needs p > c q tan where c > 0, and p > c (q tan + w / 2) where not:
    // with p and q by rise and t, both are linear.
    void is(float covered) {
        covered_ = covered;
        const float lean = covered * tangent_;
        per_rise_ = cosine_ - lean * sine_;
        per_step_ = sine_ + lean * cosine_;
        lag_ = std::max(-covered, 0.0f) * before_;
    }

    const Image<float>& heights_;
    float mm_, tangent_, x_, y_, dx_, dy_, z0_, cosine_, sine_;
    float before_ = 0, behind_ = 0;  // half_width() on the pixel's side towards the light, and on the other
    float covered_, per_rise_, per_step_, lag_;
};

float CastShadows::covered(Way& way) const {
    const float highest = way.rise_of(highest_mm_);
    std::size_t level = 0;
    for (float t = 1; way.covered() < 1 && way.is_inside(t);) {
        if (way.falls_behind()) {
            if (way.hides_no_more(highest, t)) break;
            const float around = highest_around(level, way.column(t), way.row(t));
            if (way.hides_no_more(way.rise_of(around), t)) {
                t += static_cast<float>(kFinestBlock << level);
                level = std::min(level + 1, highest_.size() - 1);
                continue;
            }
            if (level > 0) {
                --level;
                continue;
            }
        }
        for (int step = 0; step < kFinestBlock && way.is_inside(t); ++step, t += 1) way.meet(way.rise(t), t);
    }
    return way.covered();
}

float CastShadows::visible_part(int x, int y, const Vec3& l) const {
    const float across = std::sqrt(l.x * l.x + l.y * l.y);
    // Straight from above nothing can stand in the way.
    if (across < 1e-6f || height_mm_.width() < 2 || height_mm_.height() < 2) return 1;
    Way way(*this, x, y, l, across);
    const float c = covered(way);
    if (c <= -1) return 1;
    if (c >= 1) return 0;
    // Area of the part of a unit disc above the line at height c.
    return std::clamp((std::acos(c) - c * std::sqrt(1 - c * c)) / kPi, 0.0f, 1.0f);
}

}  // namespace tangi
