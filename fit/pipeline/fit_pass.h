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

// What the first pass leaves to the second, where it is trusted: of a surface of the size that the second
// has, or of a smaller one, which reduced photographs showed.
class FirstPass {
public:
    // `surface`, `errors`, `occluded` and `plane`, which was taken off the height, are the first pass's;
    // `height_mm` is that height in the second's size. Keeps references to all but the plane.
    FirstPass(const Surface& surface, const Plane& plane, const FitErrors& errors, const WardPrior& general,
              const Image<unsigned char>& occluded, const Image<float>& height_mm, int reduction, int photos);

    // From now on prior_at() knows rows y0 <= y < y1, as LobePriors::advance().
    void advance(int y0, int y1);
    // Of a pixel of the second pass. Among pixels of a smaller surface, what the four nearest say, whose
    // differences stand for what is not seen within them.
    WardPrior prior_at(int x, int y) const;
    bool is_occluded(int x, int y) const { return occluded_(x / reduction_, y / reduction_); }
    const CastShadows& shadows() const { return shadows_; }

    LightVisibility lights;  // to be filled in

private:
    WardPrior prior_of(int x, int y) const;

    LobePriors lobes_;
    IntegrabilityPriors slopes_;
    CastShadows shadows_;
    const Image<unsigned char>& occluded_;
    int reduction_, width_, height_;  // of the first pass's surface
};

// What a pass is given of those before, and leaves to those after it.
struct FitPass {
    std::string name;                             // for the progress
    const Image<unsigned char>& mask;             // pixels that are fitted; empty: all
    bool judged = true;                           // RowTask: if another pass follows, that one is
    FirstPass* first = nullptr;                   // of a second pass
    Image<LobeEvidence>* colours = nullptr;       // to be filled in
    Image<StretchEvidence>* stretches = nullptr;  // likewise, of those that are asked
    int tile = 0;  // [pixels] width of the tiles that are counted apart; 0: all are one
};

// What a pass counts of its pixels.
struct PassCounts {
    long fitted = 0, not_converged = 0;
    SolverAgreement solvers{};
    std::vector<float>
        rms_residuals{};  // [sigma] of a million of the painting's pixels, as far as they were fitted

    PassCounts& operator+=(const PassCounts& other);  // of another part of the painting
};

// Fits every pixel of the pass and fills in the maps of `result` but for the height. Lobes have the colours
// and axes that the surface says. The surface, with `input` and the mask, may be a part of a painting
// (Surface::part_of): its pixels get the bits that they get with all others, where its left column is a
// multiple of kMarchLanes. Returns what was counted of each tile (FitPass::tile), or of all. Throws as
// fit_painting().
std::vector<PassCounts> fit_pixels(const CalibratedStack& input, const FitOptions& options,
                                   const FitPass& pass, FitResult& result, const Progress& progress);

// What the report says of pixels, once all are fitted.
void summarise(const PassCounts& counts, const FitOptions& options, FitResult& result);

// Both, of a whole picture.
void fit_pass(const CalibratedStack& input, const FitOptions& options, const FitPass& pass, FitResult& result,
              const Progress& progress);

}  // namespace tangi
