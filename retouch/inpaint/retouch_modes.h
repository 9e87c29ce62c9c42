// retouch_modes.h: a retouch laid inside a mask: as paint of measured recipes, in the ways that conservators
// retouch.
//
// mimetic      colours of the surroundings carried on into the loss, from a few piles and mixtures of two
// tratteggio   vertical lines of pure colours whose mean is that colour (Brandi 1963: rigatino); between them
//              one recipe of that colour, or what lies there
// selection    such lines along the form of the surroundings (selezione cromatica: Baldini 1978)
// abstraction  lines in crossing directions, of the mean colour of the surroundings (astrazione: Baldini
//              1978)
// dotting      dots of pure colours
// neutral      one toned-down colour
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paint/canvas/canvas.h"
#include "paint/optics/palette.h"
#include "retouch/colour_match/gloss.h"
#include "retouch/colour_match/recipe.h"
#include "retouch/fill/surroundings.h"
#include "retouch/inpaint/hatching.h"
#include "surface/base/progress.h"

namespace tangi {

enum class RetouchMode { mimetic, tratteggio, selection, abstraction, dotting, neutral };
std::string_view name_of(RetouchMode mode);
std::optional<RetouchMode> retouch_mode_named(std::string_view name);

struct RetouchOptions {
    double thickness_mm = 0.05;
    double pitch_mm = 1, width_mm = 0.6, length_mm = 5;
    int piles = 6;
    double neutral_chroma = 0.4, neutral_lightness = -3;
    bool bare_gaps = false;
    bool own_gloss = false;
    int seed = 1;
    Inpainting inpainting = Inpainting::membrane;
    AnnulusOptions annulus;
    MatchOptions match;  // its film is set from thickness_mm

    static constexpr std::string_view name = "retouch";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"thickness_mm", 0.001, 2, "mm", "of the paint that is laid"}, self.thickness_mm);
        visit(FieldInfo{"pitch_mm", 0.01, 100, "mm", "between the middles of lines or dots"}, self.pitch_mm);
        visit(FieldInfo{"width_mm", 0.01, 100, "mm", "of a line or dot"}, self.width_mm);
        visit(FieldInfo{"length_mm", 0.1, 1000, "mm", "of a line at most"}, self.length_mm);
        visit(FieldInfo{"piles", 1, 24, "1",
                        "recipes that are mixed at most, for each ground that shows through"},
              self.piles);
        visit(FieldInfo{"neutral_chroma", 0, 1, "1", "chroma of the neutral tone over the surroundings'"},
              self.neutral_chroma);
        visit(FieldInfo{"neutral_lightness", -50, 50, "1",
                        "lightness L* of the neutral tone above the surroundings'"},
              self.neutral_lightness);
        visit(
            FieldInfo{"bare_gaps", 0, 1, "",
                      "leave what is between lines or dots as it is, instead of in the surroundings' colour"},
            self.bare_gaps);
        visit(FieldInfo{"own_gloss", 0, 1, "",
                        "leave the paints their own gloss, instead of bringing them to that beside the loss"},
              self.own_gloss);
        visit(FieldInfo{"seed", 0, 1e9, "1", "another number gives other lines and dots"}, self.seed);
    }
};

// A pile of paint on the retoucher's palette.
struct Pile {
    std::vector<MixingStep> steps;
    Mixture mixture;
    Spectrum look{};    // of a film over what lies below
    Spectrum target{};  // that it was mixed for (with lines: that its neighbours make up with it)
    double share = 0;   // of the area that is painted
    double volume_mm3 = 0;
};

// A gloss that the paints are brought to, as with a matting agent or a varnish.
struct RetouchGloss {
    Gloss wanted;    // beside the loss
    Gloss of_paint;  // of the paints by themselves, by volume
    double area_mm2 = 0;
    std::vector<Region> parts{};  // of the mask that are brought to it, largest first; in the canvas
};

struct RetouchReport {
    std::vector<Pile> piles;
    std::vector<RetouchGloss> glosses;     // none where the paints keep their own
    double painted_mm2 = 0, area_mm2 = 0;  // of paint, and of the mask
    // Paints, the lower number first, that come together only where two piles are mixed.
    std::set<std::pair<int, int>> blended;
    int grounds = 1;  // that show through differently, each with piles of its own
    int marks = 0;
    double pitch_mm = 0, width_mm = 0;  // as laid: whole pixels
    // CIEDE2000 from the colour that was aimed at, under each illuminant, in the order of Illuminant: pixel
    // by pixel, or, of lines and dots, the means over 6 x 6 pitches.
    std::array<double, kIlluminants> delta_e_mean{};
    Image<Rgb> target;  // linear Rec. 709 under D65, in `region`
    Region region;      // the part of the painting that was looked at
};

// What is laid.
struct RetouchLayer {
    RetouchMode mode = RetouchMode::mimetic;
    std::string name{};
    RetouchOptions options{};
};

// Lays a retouch as a new dried layer on top. Paint lies where `mask` is above 0, as much
// thinner as coverage is below 1 (lines and dots: where it is 1/2 and more; on a fill, not thinner there);
// nowhere else. Each connected part has the gloss of its surroundings. `damaged`, which
// may be empty, is not taken for surroundings. The original's spectrum is unknown: that of spectrum.h for its
// colour stands for it. Throws Error where the mask is empty, marks are finer than the painting's pixels, or
// options are outside of their intervals; Cancelled.
RetouchReport lay_retouch(Canvas& canvas, const Palette& palette, const Mask& mask, const Mask& damaged,
                          const RetouchLayer& layer, const Progress& progress = {});

}  // namespace tangi
