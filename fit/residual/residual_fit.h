// residual_fit.h: what the photographs of a stack show beyond a fitted surface
// (surface/render/relighting_residual.h).
//
// Gaussian-process regression (Rasmussen, Williams 2006, ch. 2) of the residual over the light's direction,
// with one kernel for all pixels, so that every pixel takes the same few matrix products. Kernel, reach and
// ridge are those that predict each fitted photograph best from all others, in the photographs' encoding
// (leave-one-out in closed form, the same book, eq. 5.12); of those that do so as well, the most careful
// ones. Where that gains nothing, there is no residual. The functions of the direction are the principal
// components of what the regression predicts at the photographs. Of a picture of more than a megapixel, all
// of it is that of blocks of pixels, their means (ReducedPhotos, mean_material.h): what a surface lacks that
// a neighbourhood has in common.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture/stack/stack.h"
#include "surface/base/options.h"
#include "surface/render/relighting_residual.h"

namespace tangi {

struct ResidualOptions {
    int residual_terms = 24;  // [1] most functions of the direction for the residual along the pixel's colour
    int residual_colour_terms = 6;  // [1] and across it; each has two coefficients
    int residual_samples = 5000;    // [1] pixels to choose the kernel and the functions by
    double residual_min_gain_db =
        0.1;  // [dB] on photographs left out that the residual must gain, and twice its standard error

    static constexpr std::string_view name = "residual";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"residual_terms", 1, 200, "1",
                        "coefficients a pixel of the residual's brightness, at most"},
              self.residual_terms);
        visit(FieldInfo{"residual_colour_terms", 0, 200, "1",
                        "pairs of coefficients a pixel of its colour, at most"},
              self.residual_colour_terms);
        visit(FieldInfo{"residual_samples", 100, 100000, "1", "pixels that choose the residual's kernel"},
              self.residual_samples);
        visit(FieldInfo{"residual_min_gain_db", 0, 100, "dB",
                        "gain on validation photographs that a residual needs"},
              self.residual_min_gain_db);
    }
};

struct ResidualReport {
    bool used = false;  // false: there is no residual, for this reason:
    std::string why;    // empty where it is used
    int reduction = 1;  // [pixels] a side of its blocks
    RelightingResidual::Kernel kernel = RelightingResidual::Kernel::gaussian;
    double reach = 0, ridge = 0;  // [1]
    double surface_db = 0;        // [dB] mean PSNR of the fitted photographs' samples, surface alone
    double cv_psnr_db = 0;        // [dB] and each with the residual that the others make
    double gain_error_db = 0;     // [dB] standard error of their difference
    int terms = 0, colour_terms = 0;
    std::size_t bytes = 0;  // [bytes] of the residual in the painting file, before it is compressed
};
nlohmann::json to_json(const ResidualReport& report);

struct ResidualFit {
    RelightingResidual residual;  // empty where not used
    ResidualReport report;
};

// The residual of the photographs of the stack that the surface lists as fitted; held-out ones have no part.
// The surface is final (colours corrected, height integrated): each photograph is compared with relight()
// under cast shadows. Clipped values say "at least this". Memory beyond the surface: 4 bytes a block for each
// coefficient (36 with the default options), whatever the number of photographs, and up to 256 MB of
// residuals, without which photographs are read twice. The same bits on any number of threads. Throws Error:
// sizes that differ; Cancelled.
ResidualFit fit_residual(const Surface& surface, const Stack& stack, const ResidualOptions& options = {},
                         const Progress& progress = {});

// The same as a last step, for which the fit before it is not lost: where photographs can no longer be read,
// that is a warning. Where there is none, the surface's provenance says that it was looked for.
ResidualFit try_residual(Surface& surface, const Stack& stack, const ResidualOptions& options,
                         std::vector<std::string>& warnings, const Progress& progress = {});

}  // namespace tangi
