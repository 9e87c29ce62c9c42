// photo_residuals.h: what the photographs of a stack show beyond its fitted surface, photograph by
// photograph.
#pragma once

#include <opencv2/core/cvdef.h>

#include <span>
#include <vector>

#include "capture/stack/stack.h"
#include "fit/residual/residual_kernel.h"
#include "surface/render/relighter.h"

namespace tangi {

// The photographs that were fitted, each as a stack of its own, and their light as the fit found it.
struct FittedPhoto {
    Stack stack;
    Light light;
};

std::vector<FittedPhoto> fitted_photos(const Surface& surface, const Stack& stack);

residual_kernel::Colours colours_of(const Surface& surface, const Stack& stack);

// The pixels that stand for a block: its middle row.
struct Blocks {
    int side = 1, width = 0, height = 0;  // [pixels], [blocks]
    glm::ivec2 pixels{0};                 // of the picture

    Blocks(const Surface& surface, int side_)
        : side(side_),
          width((surface.width() + side - 1) / side),
          height((surface.height() + side - 1) / side),
          pixels(surface.width(), surface.height()) {}
    glm::ivec2 middle(int x, int y) const { return glm::min(glm::ivec2(x, y) * side + side / 2, pixels - 1); }
    int end(int x) const { return std::min((x + 1) * side, pixels.x); }
};

// [per irradiance; along u, e1, e2 of RelightingResidual] Of a block. Half floats keep 11 bits.
struct BlockResidual {
    cv::float16_t u, e1, e2;

    BlockResidual() : BlockResidual(Vec3(0)) {}
    explicit BlockResidual(const Vec3& v) : u(v.x), e1(v.y), e2(v.z) {}
    Vec3 value() const { return {float(u), float(e1), float(e2)}; }
};

// What photographs show beyond the surface relit as they were taken.
class Residuals {
public:
    Residuals(const Surface& surface, const Blocks& blocks, const residual_kernel::Colours& colours,
              std::vector<glm::ivec2> samples, int photos)
        : surface_(surface),
          blocks_(blocks),
          colours_(colours),
          samples_(std::move(samples)),
          relighter_(surface, {.cast_shadows = true}, photos) {}

    // Of each block, per irradiance, in the frame of its pixels' colours; 0 where nothing was measured. And,
    // where asked for, what the samples' middle pixels show.
    Image<BlockResidual> of(const FittedPhoto& photo, residual_kernel::Sampled* sampled) const;
    const std::vector<glm::ivec2>& samples() const { return samples_; }  // blocks, row by row

private:
    void take_row(const FittedPhoto& photo, const Band& band, int row, std::span<BlockResidual> residuals,
                  residual_kernel::Sampled* sampled) const;
    Vec3 of_pixel(const Light& light, int x, int y, const Rgb& value, const Rgb& predicted) const;

    const Surface& surface_;
    const Blocks& blocks_;
    const residual_kernel::Colours& colours_;
    const std::vector<glm::ivec2> samples_;
    const Relighter relighter_;
};

}  // namespace tangi
