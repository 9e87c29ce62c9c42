// web_data.h: what a page in a browser must know of a painting to draw it, as JSON: the exported page
// (web_page.h) and the web application (web/) alike.
#pragma once

#include <nlohmann/json.hpp>

#include "surface/maps/surface.h"
#include "viewer/render/texels.h"

namespace tangi {

// Levels of detail that a page needs: the last is one tile.
int web_levels(int width, int height);

// [mm]
struct ShownHeights {
    float lowest_mm = 0, highest_mm = 0;
};
ShownHeights heights_of(const Surface& surface);

// "width", "height" [pixels], "mm_per_pixel", "scale_known", "levels"; "range": what texels' largest codes
// stand for (largest rho_d, largest rho_s, lowest height [mm], range of heights [mm]); "reflectance_model",
// "specular_colour", "anisotropic_specular": which shader it needs; "looks": view modes in the order of their
// numbers, with the ends of their scales; "software": what a picture of it was made by; "vertex_shader",
// "fragment_shader": GLSL without its first lines.
// Of the surface's maps only `heights` count, the lowest and highest there are.
nlohmann::json web_picture_data(const Surface& surface, const TexelRange& range, const ShownHeights& heights);

}  // namespace tangi
