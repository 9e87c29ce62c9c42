// brush_shape.h: the shapes that a tip can have, in one table: their names, outlines, and what a blade does
// otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tangi {

enum class BrushShape { round, flat, filbert, fan, knife, rag };

// Of the tip: 0 in the middle, 1 at the rim; u (along the width) and v (the thickness) in half extents. What
// is random follows from the seed.
using DomeFunction = float (*)(float u, float v, std::uint64_t seed);
float round_dome(float u, float v, std::uint64_t seed);
float flat_dome(float u, float v, std::uint64_t seed);
float filbert_dome(float u, float v, std::uint64_t seed);
float fan_dome(float u, float v, std::uint64_t seed);
float knife_dome(float u, float v, std::uint64_t seed);
float rag_dome(float u, float v, std::uint64_t seed);

// [pixels] By how much the rim moves at most before the loads of the bristles are laid out anew for the angle
// of a brush that turns: a part of half the thickness, within bounds.
struct RimShift {
    double per_thickness, least_px, most_px;
};

// At most half of a pixel off, and less of a thin tip: its contact is soon beside its load, and each new
// layout would leave a rung. Least of a blade, whose edge is sharp.
inline constexpr RimShift kSoftRim = {8, 0.5, 3.0}, kSharpRim = {32, 0.1, 1.0};

struct BrushShapeTraits {
    BrushShape shape;
    const char* name;  // in files and JSON
    DomeFunction dome;
    RimShift rim = kSoftRim;
    // The outline is an ellipse; else it may reach into the corners of width and thickness.
    bool elliptic = false;
    // Stiff: rides as a whole on the paint that it brings, smooths it, takes steps of half the length, and
    // what it scrapes up goes onto its face.
    bool blade = false;
};

// In the order of BrushShape.
inline constexpr std::array kBrushShapes = {
    BrushShapeTraits{.shape = BrushShape::round, .name = "round", .dome = round_dome, .elliptic = true},
    BrushShapeTraits{.shape = BrushShape::flat, .name = "flat", .dome = flat_dome},
    BrushShapeTraits{.shape = BrushShape::filbert, .name = "filbert", .dome = filbert_dome},
    BrushShapeTraits{.shape = BrushShape::fan, .name = "fan", .dome = fan_dome},
    BrushShapeTraits{
        .shape = BrushShape::knife, .name = "knife", .dome = knife_dome, .rim = kSharpRim, .blade = true},
    BrushShapeTraits{.shape = BrushShape::rag, .name = "rag", .dome = rag_dome}};

constexpr bool in_order_of_brush_shape() {
    for (std::size_t i = 0; i < kBrushShapes.size(); ++i)
        if (kBrushShapes[i].shape != static_cast<BrushShape>(i)) return false;
    return true;
}
static_assert(in_order_of_brush_shape());

constexpr const BrushShapeTraits& traits_of(BrushShape shape) {
    return kBrushShapes[static_cast<std::size_t>(shape)];
}

// Empty where no shape has this name.
std::optional<BrushShape> brush_shape_named(std::string_view name);
std::string brush_shape_names();  // with commas between them

}  // namespace tangi
