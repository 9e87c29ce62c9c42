// relighter.h: the reference renderer of relight.h, a row at a time.
#pragma once

#include <memory>
#include <span>

#include "surface/render/cast_shadows.h"
#include "surface/render/relight.h"

namespace tangi {

// Heights around a surface that is a part of a painting, which may cast shadows into it: pixel (0, 0) of the
// surface is (left, top) of them. They must live as long.
struct Surroundings {
    const Image<float>& height_mm;
    int left = 0, top = 0;
};

// The picture of relight() row by row, for who draws a surface under many lights: what shadows need of the
// heights is reckoned once. Keeps a reference to the surface.
class Relighter {
public:
    // `lights`: how many there will be. For many, the steepest horizon of each pixel is kept (4 bytes each).
    Relighter(const Surface& surface, const RelightOptions& options, int lights = 1);
    Relighter(const Surface& surface, const RelightOptions& options, const Surroundings& around);
    ~Relighter();

    // One light in a row of the picture, instead of what was there (ambient light of the options included).
    void draw_row(const Light& light, int y, std::span<Rgb> row) const;
    // One more light.
    void add_row(const Light& light, int y, std::span<Rgb> row) const;

private:
    // Whether it is known without a march that the light reaches all of a pixel.
    bool clears(int x, int y, const Vec3& direction) const;

    const Surface& surface_;
    RelightOptions options_;
    int left_ = 0, top_ = 0;                // [pixels] of the surface in what casts shadows
    std::unique_ptr<CastShadows> shadows_;  // where there are to be any
    Image<float> horizon_;                  // [1] CastShadows::steepest_horizon(); may be empty
};

}  // namespace tangi
