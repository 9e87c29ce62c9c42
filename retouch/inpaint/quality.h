// quality.h: how well retouches go with their surroundings: in colour under several illuminants, height and
// gloss.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "paint/canvas/canvas.h"
#include "paint/optics/spectrum.h"
#include "retouch/fill/surroundings.h"
#include "retouch/mask/mask.h"
#include "surface/base/progress.h"

namespace tangi {

struct QualityOptions {
    double seen_mm = 1;  // details finer than this are not compared
    AnnulusOptions annulus;

    static constexpr std::string_view name = "quality";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"seen_mm", 0.01, 100, "mm", "colours, heights and gloss are means over about this"},
              self.seen_mm);
    }
};

// A step along a retouch's border: what is inside less what is outside, means over about seen_mm.
struct Step {
    double mean = 0, rms = 0;
};

// One connected region of the mask. Differences are CIEDE2000, NaN under illuminants that were not asked for.
struct RetouchQuality {
    Region box;
    double area_mm2 = 0;
    int border_px = 0;
    // Of the retouch from its surroundings' colour carried on into it (a membrane): mean over the area.
    std::array<double, kIlluminants> delta_e{};
    // Across the border: mean.
    std::array<double, kIlluminants> border_delta_e{};
    Step height_mm;
    double gloss_step = 0;  // mean of gloss_difference() across the border (gloss.h)
    Step specular, roughness;
    // The yardstick: the same of up to four undamaged areas of its shape beside it, as if they had been
    // retouched. What they differ by, the painting itself varies by. Empty where there is no such place.
    std::vector<RetouchQuality> undamaged;
};
// Means of all figures; box and area are the first one's.
RetouchQuality mean_of(std::vector<RetouchQuality> regions);

struct QualityReport {
    std::vector<RetouchQuality> regions;
    // Of the painting's size; 0 outside of the mask.
    Image<float> delta_e;    // the worst under the illuminants
    Image<float> height_mm;  // above what the surroundings' height goes on as
    Image<float> gloss;      // gloss_difference() from the surroundings' gloss, carried on
};

// Every connected region of `mask` against the painting round it; `damaged` (may be empty) is no painting.
// The original's spectrum is unknown: that of spectrum.h for its colour stands for it under all illuminants.
// Throws Error where the mask is empty or all of the picture; Cancelled.
QualityReport quality_of(const Canvas& canvas, const Mask& mask, const Mask& damaged,
                         std::span<const Illuminant> illuminants, const QualityOptions& options = {},
                         const Progress& progress = {});

// The painting with its paint as it looks under a illuminant, linear Rec. 709 adapted to D65: the dry surface
// by its colour's reflectance, paint by its own. Not only what is painted, as in appearance().
Image<Rgb> look_under(const Canvas& canvas, Illuminant illuminant, const Progress& progress = {});

}  // namespace tangi
