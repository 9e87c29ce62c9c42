// composition.h: what the procedural painting shows: sky, sun, hills, field and trees, as a list of brush
// strokes.
#pragma once

#include <vector>

#include "datasets/brush_strokes.h"
#include "datasets/procedural_painting.h"

namespace tangi::procedural {

// All strokes in painting order: underpainting, main layer, details, impasto accents. They lie on a ground
// whose mean height is `ground_mm`.
std::vector<Stroke> compose(const PaintingOptions& options, float ground_mm);

// The colour that the main layer has about a place; x, y from -1 to 1 across the picture, y up.
Rgb colour_about(float x, float y, Seed seed);

}  // namespace tangi::procedural
