// light_visibility.h: which lights reach a pixel past the relief and which do not, as its photographs show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fit/pixel/lighting.h"
#include "fit/pixel/ward_batch.h"
#include "surface/maps/surface.h"
#include "surface/render/cast_shadows.h"

namespace tangi {

constexpr int kShadowReach = 64;  // [pixels] of shadows that are looked into

struct SeenLight {
    std::uint32_t x = 0;
    std::uint16_t photo = 0;
    std::uint8_t run = 0;  // [pixels] next to it, towards the light, that are hidden from it as well
    bool lit = false;
};

// Filled in row by row; different rows at the same time. 8 bytes for each light that is remembered (up to 16
// until find_runs()): all that are hidden, but of those that reach a pixel only ones that a little more
// relief would hide.
class LightVisibility {
public:
    // `photos`: 65 535 at most.
    LightVisibility(int width, int height, int photos);

    // Pixels (x0, y) … (x0 + count - 1, y) of the batch, under lights of their own colour: what a matt
    // surface of this normal and rho_d would show, and what there is. Half lights count for nothing, nor do
    // lights that graze the surface, metal, and pixels whose slope is not known. `shadows`: of the height of
    // the painting that the surface is, or is a part of.
    void look(const WardBatch& batch, const Surface& surface, const CastShadows& shadows, int x0, int y,
              int count);

    // Those of a part that was looked at on its own, before find_runs(): parts of a row from left to right.
    // `x0`: of the part.
    void add(int y, std::span<const SeenLight> lights, int x0);

    // When all rows are there: finds the runs, and forgets shadows that reach the border of the picture
    // towards the light, since what casts them may stand outside. One bit a pixel for each thread.
    void find_runs(const Surface& surface, const Lighting& lighting);

    std::span<const SeenLight> row(int y) const { return rows_[static_cast<std::size_t>(y)]; }
    int height() const { return static_cast<int>(rows_.size()); }
    bool empty() const;
    // [1] Part of all pixels' lights that photographs show hidden.
    double hidden_part() const;

private:
    void find_runs_of(std::size_t photo, const Surface& surface, const Lighting& lighting);

    int width_, photos_;
    std::vector<std::vector<SeenLight>> rows_;
};

}  // namespace tangi
