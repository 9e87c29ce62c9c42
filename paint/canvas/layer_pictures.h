// layer_pictures.h: the layers of a painted canvas as pictures with alpha, for programs that know nothing of
// paint.
#pragma once

#include <string>
#include <vector>

#include "paint/canvas/appearance.h"
#include "paint/canvas/canvas.h"

namespace tangi {

struct LayerPicture {
    std::string name;
    Image<Rgb> srgb;            // [sRGB-encoded, 0..1] not multiplied with alpha
    Image<float> alpha;         // [1]
    Image<float> thickness_mm;  // of the paint; empty for the dry surface
};

// From the bottom up: "dry", which is opaque, the dried layers, "wet"; layers without paint are left out.
// Laid over each other as encoded colours are (source over), each gives the colours that appearance() has
// with all layers up to it, where those are within [0, 1]. Alpha is the part of the gloss below that a layer
// covers, and more where its colour would be out of range otherwise.
std::vector<LayerPicture> layer_pictures(const Canvas& canvas, const AppearanceOptions& options = {},
                                         const Progress& progress = {});

// [mm] The thickness of one ingredient everywhere.
Image<float> thickness_mm_of(const PaintLayer& paint, IngredientId ingredient);

// All of them laid over each other.
Image<Rgb> laid_over(const std::vector<LayerPicture>& layers);

}  // namespace tangi
