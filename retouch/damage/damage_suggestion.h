// damage_suggestion.h: areas that look damaged, as suggestions for a person to judge: losses, craquelure, and
// patches of other gloss, each with how sure it is.
//
// All compare a pixel with its surroundings, so that neither the colour of the light nor a slow drift of the
// height matters. docs/theory/damage-and-fills.md has the method and its limits.
#pragma once

#include <vector>

#include "retouch/mask/mask.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

struct DamageSuggestion {
    Mask mask;                // coverage, 0 or 1
    Image<float> confidence;  // [1] 0..1, everywhere: also where it stays below what is suggested

    // Nothing yet, of the surface's size. Throws ContractError where that has maps of several sizes.
    void begin(const Surface& surface) {
        require_consistent(surface);
        mask = Mask(surface.width(), surface.height());
        confidence = Image<float>(surface.width(), surface.height());
    }
};

// Losses: lower than their surroundings behind a step, and of another colour or gloss.
struct LossOptions {
    double smallest_mm2 = 1;  // smaller areas are left out
    double depth_mm = 0.03;   // of the step at the rim, at least: about the thinnest paint layer
    double confidence = 0.5;  // areas below it are not suggested

    static constexpr std::string_view name = "loss";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"smallest_mm2", 0, 1e6, "mm2", "losses of less area are left out"},
              self.smallest_mm2);
        visit(FieldInfo{"depth_mm", 0, 100, "mm", "losses lie at least this much lower than their rim"},
              self.depth_mm);
        visit(FieldInfo{"confidence", 0, 1, "1", "losses that are less sure are not suggested"},
              self.confidence);
    }
};
// Robust deviation from the local median (median absolute deviation) at several scales finds candidates;
// each is cut out by GrabCut (Rother, Kolmogorov, Blake 2004) over height, colour and gloss, and judged by
// its rim. Where the surface's scale is unknown, a pixel counts as `mm_per_pixel`.
DamageSuggestion suggest_loss(const Surface& surface, double mm_per_pixel, const LossOptions& options = {},
                              const Progress& progress = {});

// Craquelure: thin dark lines that lie lower, or gloss less, than both their sides.
struct CraquelureOptions {
    double widest_mm = 1.5;  // wider lines are no cracks
    double shortest_mm = 4;  // of a connected piece, all its branches together
    double sensitivity = 1;  // above 1, fainter lines count too

    static constexpr std::string_view name = "craquelure";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"widest_mm", 1e-3, 100, "mm", "wider lines are no cracks"}, self.widest_mm);
        visit(FieldInfo{"shortest_mm", 0, 1e4, "mm", "pieces whose lines are shorter in all are left out"},
              self.shortest_mm);
        visit(FieldInfo{"sensitivity", 0.1, 10, "1", "above 1, fainter lines are cracks too"},
              self.sensitivity);
    }
};
struct CraquelureMeasure {
    double length_mm = 0;       // of all centre lines
    double width_mm = 0;        // area over length
    double density_per_cm = 0;  // length [cm] on each cm2 of the picture
    int pieces = 0;             // connected networks
};
struct CraquelureSuggestion : DamageSuggestion {
    CraquelureMeasure measure;
};
CraquelureSuggestion suggest_craquelure(const Surface& surface, double mm_per_pixel,
                                        const CraquelureOptions& options = {}, const Progress& progress = {});
// Of any mask of lines: lengths along its one pixel wide skeleton (Zhang & Suen 1984), diagonal steps count
// as sqrt 2.
CraquelureMeasure measure_lines(const Mask& lines, double mm_per_pixel);
Mask skeleton_of(const Mask& mask);

// Patches that are glossier or matter than what is around them: varnish, overpaint, wear.
struct GlossOptions {
    double smallest_patch_mm2 = 25;
    double contrast = 1.5;  // of the highlight's width or strength, at least

    static constexpr std::string_view name = "gloss";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"smallest_patch_mm2", 0, 1e6, "mm2", "patches of less area are left out"},
              self.smallest_patch_mm2);
        visit(FieldInfo{"contrast", 1.05, 100, "1",
                        "by how much alpha or rho_s of a patch differs from its surroundings, as a factor"},
              self.contrast);
    }
};
struct GlossPatch {
    Region box;
    bool glossier = false;  // a narrower or stronger highlight; else matter
    double area_mm2 = 0;
    double roughness_ratio = 1, specular_ratio = 1;  // medians inside over those around
};
struct GlossSuggestion {
    DamageSuggestion glossier, matter;
    std::vector<GlossPatch> patches;
};
GlossSuggestion suggest_gloss(const Surface& surface, double mm_per_pixel, const GlossOptions& options = {},
                              const Progress& progress = {});

}  // namespace tangi
