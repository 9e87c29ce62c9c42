// swatches.h: a target beside recipes for it, under every illuminant, as a picture.
#pragma once

#include <span>

#include "retouch/colour_match/recipe.h"

namespace tangi {

// A row for each illuminant (A, D50, D65, F11, LED), a column for each recipe; in every cell the target on
// the left and the recipe on the right, without a gap, and their CIEDE2000 below; under them, how each is
// mixed of these paints. Linear Rec. 709, adapted to D65. Throws Error where there are no recipes or cells
// are outside of [60, 1000] pixels.
Image<Rgb> recipe_swatches(const Spectrum& target, std::span<const MatchedRecipe> recipes,
                           const std::vector<Pigment>& paints, int cell_px = 160);

}  // namespace tangi
