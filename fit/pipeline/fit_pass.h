// fit_pass.h: one pass over the photographs of a stack, in which every pixel is fitted.
#pragma once

#include <string>

#include "fit/material/anisotropy_estimate.h"
#include "fit/material/integrability_prior.h"
#include "fit/material/lobe_neighbour_prior.h"
#include "fit/material/specular_colour.h"
#include "fit/pipeline/fit_painting.h"
#include "fit/shadows/light_visibility.h"
#include "surface/render/cast_shadows.h"

namespace tangi {

// What the first pass leaves to the second, where it is trusted.
struct FirstPass {
    LobePriors lobes;
    IntegrabilityPriors slopes;
    CastShadows shadows;
    const Image<unsigned char>& occluded;
    LightVisibility lights;

    FirstPass(const Surface& surface, const Plane& plane, const FitErrors& errors, const WardPrior& general,
              const Image<unsigned char>& few_lights, int photos);
};

// What a pass is given of those before, and leaves to those after it.
struct FitPass {
    std::string name;                             // for the progress
    const Image<unsigned char>& mask;             // pixels that are fitted; empty: all
    bool judged = true;                           // RowTask: if another pass follows, that one is
    FirstPass* first = nullptr;                   // of a second pass
    Image<LobeEvidence>* colours = nullptr;       // to be filled in
    Image<StretchEvidence>* stretches = nullptr;  // likewise, of those that are asked
};

// Fits every pixel of the pass, fills in the maps of `result` but for the height, and what its report says of
// pixels. Lobes have the colours and axes that the surface says. Throws as fit_painting().
void fit_pass(const CalibratedStack& input, const FitOptions& options, const FitPass& pass, FitResult& result,
              const Progress& progress);

}  // namespace tangi
