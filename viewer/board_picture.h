// board_picture.h: what the palette looks like that paints are mixed on. No OpenGL.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "surface/surface.h"

namespace tangi {

// A part of the palette, sRGB, row by row.
struct BoardPatch {
    int width = 0, height = 0;  // [pixels] of the whole palette
    Region region;
    std::vector<glm::u8vec3> srgb;
};

// Lit by a lamp at the upper left, 50 degrees high, and a little from all around, seen from straight ahead.
BoardPatch board_patch(const Surface& board, const Region& region);

// A strip of a bent film of this paint under that lamp, sRGB: how it shines.
std::vector<Rgb> gloss_strip(const Rgb& diffuse, double specular, double roughness, int count);

}  // namespace tangi
