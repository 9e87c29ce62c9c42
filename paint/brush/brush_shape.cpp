#include "paint/brush/brush_shape.h"

#include <algorithm>
#include <cmath>

#include "surface/base/noise.h"
#include "surface/math/portable_math.h"

namespace tangi {

float round_dome(float u, float v, std::uint64_t) { return u * u + v * v; }

float flat_dome(float u, float v, std::uint64_t) { return portable::pow(std::abs(u), 10.0f) + v * v; }

float filbert_dome(float u, float v, std::uint64_t) { return portable::pow(std::abs(u), 3.0f) + v * v; }

float knife_dome(float u, float v, std::uint64_t) { return portable::pow(std::abs(u), 16.0f) + v * v; }

// An arc of tufts.
float fan_dome(float u, float v, std::uint64_t) {
    const float along = v + 1.6f * (u * u - 0.4f);
    return portable::pow(std::abs(u), 10.0f) + along * along;
}

// With folds.
float rag_dome(float u, float v, std::uint64_t seed) {
    return (u * u + v * v) *
           (1 + 0.5f * procedural::fractal_noise(2.5f * u, 2.5f * v, 3, procedural::hash(seed, 77)));
}

std::optional<BrushShape> brush_shape_named(std::string_view name) {
    const auto found = std::ranges::find(
        kBrushShapes, name, [](const BrushShapeTraits& traits) { return std::string_view(traits.name); });
    if (found == kBrushShapes.end()) return {};
    return found->shape;
}

std::string brush_shape_names() {
    std::string names;
    for (const BrushShapeTraits& traits : kBrushShapes)
        names += (names.empty() ? "" : ", ") + std::string(traits.name);
    return names;
}

}  // namespace tangi
