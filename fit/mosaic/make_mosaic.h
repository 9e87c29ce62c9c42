// make_mosaic.h: many positions of one painting become one painting.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fit/height/height.h"
#include "fit/mosaic/layout_hint.h"
#include "fit/mosaic/seam_steps.h"
#include "surface/base/options.h"

namespace tangi {

struct MosaicOptions {
    // What makes a mosaic poor.
    double max_residual_px = 0.5;  // [pixels] of an overlap, rms
    double max_delta_e = 1;        // [1] CIEDE2000 across a seam, mean
    double max_step = 3;           // [1] height across a seam, in its stated standard errors

    static constexpr std::string_view name = "mosaic";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"max_residual_px", 0.01, 100, "px", "overlaps that fit worse make the result poor"},
              self.max_residual_px);
        visit(FieldInfo{"max_delta_e", 0.01, 100, "1",
                        "seams with a larger CIEDE2000 across make the result poor"},
              self.max_delta_e);
        visit(FieldInfo{"max_step", 0.1, 1000, "1",
                        "seams with a larger step in height, in its standard errors, make the result poor"},
              self.max_step);
    }
};

struct LeftOut {
    std::size_t position = 0;
    std::string why;
};

struct MosaicReport {
    std::vector<PairRegistration> pairs;  // all that were tried
    MosaicLayout layout;
    MosaicScales scales;
    std::vector<SeamSteps> seams;
    std::vector<LeftOut> left_out;
    HeightReport height;
    double mm_per_pixel = 1;
    bool scale_known = false;
    int cell_px = 0;
    std::vector<std::string> warnings, poor;
};

struct Mosaic {
    Surface surface;
    FitErrors errors;  // empty where a position has none
    MosaicReport report;
};

// The positions' pixels become those of the first one, whose scale the wall has. docs/theory/mosaic.md says
// how. Positions that cannot be joined to the first are left out, which makes the result poor; `hint` says
// which pairs may overlap, where it is given. Throws Error where nothing can be joined, naming what was
// tried; Cancelled.
Mosaic make_mosaic(const std::vector<MosaicPosition>& positions, const std::optional<LayoutHint>& hint = {},
                   const MosaicOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
