// palette_image.h: what the palette looks like that paints are mixed on, and paint by itself. No OpenGL.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <span>
#include <vector>

#include "paint/optics/pigment.h"
#include "surface/maps/surface.h"

namespace tangi {

// A part of the palette, sRGB, row by row.
struct BoardPatch {
    int width = 0, height = 0;  // [pixels] of the whole palette
    Region region;
    std::vector<glm::u8vec3> srgb;
};

// Where the light stands over the palette: at the upper left, 50 degrees high.
inline const Vec3 kBoardLight = glm::normalize(Vec3(-0.45f, 0.45f, 0.76f));

// Lit by a far light, and a little from all around, seen from straight ahead.
BoardPatch board_patch(const Surface& board, const Region& region, const Vec3& light = kBoardLight);

// Linear Rec. 709 of a mixture of these paints, 1 mm thick.
Rgb thick_film(std::span<const Pigment> paints, std::span<const float> parts,
               Illuminant illuminant = Illuminant::d65);

// A strip of a bent film of this paint under that light, sRGB: how it shines.
std::vector<Rgb> gloss_strip(const Rgb& diffuse, double specular, double roughness, int count);

}  // namespace tangi
