// image.h: a picture in memory, row-major, row 0 at the top, pixel (0, 0) at the top left.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surface/image/image_memory.h"

namespace tangi {

using Vec3 = glm::vec3;
using Rgb = glm::vec3;  // linear Rec. 709 unless the name says otherwise

// A half-open rectangle of pixels: x0 <= x < x1, y0 <= y < y1.
struct Region {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    friend bool operator==(const Region&, const Region&) = default;
};

template <class T>
class Image {
public:
    Image() = default;
    Image(int width, int height, const T& fill = T())
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

    int width() const { return width_; }
    int height() const { return height_; }
    bool empty() const { return pixels_.empty(); }
    std::size_t size() const { return pixels_.size(); }
    Region region() const { return {0, 0, width_, height_}; }

    T& operator()(int x, int y) { return pixels_[index(x, y)]; }
    const T& operator()(int x, int y) const { return pixels_[index(x, y)]; }

    // The pixel nearest to (x, y) that exists.
    const T& clamped(int x, int y) const {
        return (*this)(std::clamp(x, 0, width_ - 1), std::clamp(y, 0, height_ - 1));
    }

    std::span<T> row(int y) { return {&pixels_[index(0, y)], static_cast<std::size_t>(width_)}; }
    std::span<const T> row(int y) const { return {&pixels_[index(0, y)], static_cast<std::size_t>(width_)}; }

    std::span<T> pixels() & { return pixels_; }
    std::span<const T> pixels() const& { return pixels_; }
    void pixels() && = delete;  // a loop over the pixels of a temporary would outlive it

    T* data() { return pixels_.data(); }
    const T* data() const { return pixels_.data(); }

private:
    std::size_t index(int x, int y) const {
        assert(x >= 0 && x < width_ && y >= 0 && y < height_);
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    int width_ = 0;
    int height_ = 0;
    std::vector<T, ImageAllocator<T>> pixels_;
};

}  // namespace tangi
