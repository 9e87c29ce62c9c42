// residual_fit.h: what the photographs of a stack show beyond a fitted surface
// (surface/render/relighting_residual.h).
//
// Gaussian-process regression (Rasmussen, Williams 2006, ch. 2) of the residual over the light's direction,
// with one kernel for all pixels, so that every pixel takes the same few matrix products. Kernel, reach and
// ridge are those that predict each fitted photograph best from all others, in the photographs' encoding
// (leave-one-out in closed form, the same book, eq. 5.12); of those that do so as well, the most careful
// ones. Where that gains nothing, there is no residual. The functions of the direction are the principal
// components of what the regression predicts at the photographs.
#pragma once

#include <nlohmann/json.hpp>

#include "capture/stack/stack.h"
#include "surface/base/options.h"
#include "surface/render/relighting_residual.h"

namespace tangi {

struct FaithfulOptions {
    int faithful_terms = 24;  // [1] most functions of the direction for the residual along the pixel's colour
    int faithful_colour_terms = 6;  // [1] and across it; each has two coefficients
    int faithful_samples = 5000;    // [1] pixels to choose the kernel and the functions by
    double faithful_worth_db =
        0.1;  // [dB] on photographs left out that the residual must gain, and twice its standard error

    static constexpr std::string_view name = "faithful";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"faithful_terms", 1, 200, "1",
                        "coefficients a pixel of the residual's brightness, at most"},
              self.faithful_terms);
        visit(FieldInfo{"faithful_colour_terms", 0, 200, "1",
                        "pairs of coefficients a pixel of its colour, at most"},
              self.faithful_colour_terms);
        visit(FieldInfo{"faithful_samples", 100, 100000, "1", "pixels that choose the residual's kernel"},
              self.faithful_samples);
        visit(FieldInfo{"faithful_worth_db", 0, 100, "dB",
                        "gain on left-out photographs that a residual needs"},
              self.faithful_worth_db);
    }
};

struct FaithfulReport {
    bool used = false;  // false: it gains nothing, there is no residual
    FaithfulResidual::Kernel kernel = FaithfulResidual::Kernel::gaussian;
    double reach = 0, ridge = 0;  // [1]
    double surface_db = 0;        // [dB] mean PSNR of the fitted photographs' samples, surface alone
    double left_out_db = 0;       // [dB] and each with the residual that the others make
    double gain_error_db = 0;     // [dB] standard error of their difference
    int terms = 0, colour_terms = 0;
};
nlohmann::json to_json(const FaithfulReport& report);

struct FaithfulFit {
    FaithfulResidual residual;  // empty where not used
    FaithfulReport report;
};

// The residual of the photographs of the stack that the surface lists as fitted; held-out ones have no part.
// The surface is final (colours corrected, height integrated): each photograph is compared with relight()
// under cast shadows. Clipped values say "at least this". Memory beyond the surface: 4 bytes a pixel for each
// coefficient (36 with the default options), whatever the number of photographs, and up to 256 MB of
// residuals, without which photographs are read twice. The same bits on any number of threads. Throws Error:
// sizes that differ, fewer than 8 photographs; Cancelled.
FaithfulFit fit_faithful(const Surface& surface, const Stack& stack, const FaithfulOptions& options = {},
                         const Progress& progress = {});

}  // namespace tangi
