// substrate.h: supports to paint on, made by procedure: colour and relief in mm, seamless at the borders.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

enum class SubstrateKind {
    canvas,  // cotton duck, primed white: the weave shows through the ground
    linen,   // unbleached, sized with glue: irregular threads with slubs
    burlap,  // coarse and open
    panel,   // planed wood under thin varnish: grain
    gesso,   // white ground, brushed on by hand
    paper    // felted fibres
};

std::string_view name_of(SubstrateKind kind);
std::optional<SubstrateKind> substrate_named(std::string_view name);
std::vector<std::string> substrate_names();

struct SubstrateOptions {
    double width_mm = 200, height_mm = 150;
    double pixel_mm = 0.2;
    std::uint64_t seed = 1;

    static constexpr std::string_view name = "substrate";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"width_mm", 0.1, 1e5, "mm", "width of the substrate"}, self.width_mm);
        visit(FieldInfo{"height_mm", 0.1, 1e5, "mm", "height of the substrate"}, self.height_mm);
        visit(FieldInfo{"pixel_mm", 0.005, 100, "mm", "size of its pixels"}, self.pixel_mm);
        visit(FieldInfo{"seed", 0, 9e15, "1", "another piece of it for each number"}, self.seed);
    }
};

// A piece of the substrate; its left border continues its right one, and its top the bottom, so it can be
// laid side by side. Relief has mean 0. Throws Error for fewer than 8 or more than 65536 pixels a side.
Surface make_substrate(SubstrateKind kind, const SubstrateOptions& options, const Progress& progress = {});

}  // namespace tangi
