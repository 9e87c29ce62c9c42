// refinement.h: the last pass over the photographs of a large picture, as a whole or part by part, by what a
// fit of the reduced photographs has found.
#pragma once

#include "fit/pipeline/fit_pass.h"
#include "fit/shadows/light_visibility.h"

namespace tangi {

// The fit of the reduced photographs, for the pixels of the whole ones.
struct FirstFit {
    FitResult result;  // with its height; occluded pixels have what their neighbours have
    Image<unsigned char> occluded{};
    Plane plane{};  // that was taken off the height
    int reduction = 1;
};

// [mm] Its height in the size of the picture: what casts shadows there.
Image<float> enlarged_height(const FirstFit& first, int width, int height);

class Refinement {
public:
    // `height_mm`: enlarged_height(), of the whole picture. Keeps references to it and to `first`. `options`:
    // those of the fit.
    Refinement(const FirstFit& first, const Image<float>& height_mm, const FitOptions& options);

    // Fits the pixels of a picture, or of a part of it, and fills in its maps; its size, place
    // (Surface::part_of), scale and law are there. Pixels of a part get the bits that they get with all
    // others. The height is the enlarged one. `tile`: as FitPass::tile, as is what is returned. `lights`
    // becomes which lights were seen where, but for their runs.
    std::vector<PassCounts> fit(const CalibratedStack& input, const Image<unsigned char>& mask, int tile,
                                FitResult& result, LightVisibility& lights, const Progress& progress);

private:
    const FirstFit& first_;
    const Image<float>& height_mm_;
    FitOptions options_;
    FirstPass pass_;
};

// What is done once all pixels were fitted; `forgets`: those that were not, of a refinement by reduced
// photographs, become like those of an empty surface.
void settle_refined(bool forgets, const Lighting& lighting, LightVisibility& lights, Surface& surface);

// Those of a first pass, and of a second one, by what was found before.
FitOptions options_of_first(const FitReport& report, FitOptions options);
FitOptions options_after(const FitReport& first, FitOptions options);

}  // namespace tangi
