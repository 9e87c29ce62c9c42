#include "fit/pipeline/refinement.h"

#include <algorithm>

#include "fit/material/low_confidence_fill.h"
#include "fit/pipeline/reduced_result.h"
#include "surface/image/enlarged.h"
#include "surface/maps/surface_part.h"

namespace tangi {

namespace {

// [sigma] Where the model does not even explain what it explains best (LightMisfit::best_explained: real/coin
// 1.10; other real stacks 0.38 to 0.77; generated ones 0.18 to 0.30), a pixel that it explains poorly is no
// sign of shade.
constexpr double kExplained = 1;

}  // namespace

FitOptions options_of_first(const FitReport& report, FitOptions options) {
    options.ward.in_shade = report.misfit.best_explained <= kExplained;
    return options;
}

// Cauchy's loss has 95 % of the efficiency of least squares where its scale is 2.385 times that of the
// residuals (Holland & Welsch 1977, "Robust regression using iteratively reweighted least-squares"), which
// the first pass shows; a wider one lets light from other relief and mixed pixels tilt normals. At least 2:
// with 1, impasto's normals gain another 0.03 degrees, but lobes that are a little off count as outliers,
// too, and held-out photographs of canvas are predicted 0.1 dB worse.
FitOptions options_after(const FitReport& first, FitOptions options) {
    const double scale = std::max(2.385 * first.median_rms_residual, 2.0);
    options.ward.robust_scale = std::min(scale, options.ward.robust_scale);
    return options_of_first(first, options);
}

Image<float> enlarged_height(const FirstFit& first, int width, int height) {
    return enlarged_smoothly(first.result.surface.height_mm, first.reduction, width, height);
}

Refinement::Refinement(const FirstFit& first, const Image<float>& height_mm, const FitOptions& options)
    : first_(first),
      height_mm_(height_mm),
      options_(options_after(first.result.report, options)),
      pass_(first.result.surface, first.plane, first.result.errors, options.ward.prior, first.occluded,
            height_mm, first.reduction, 0) {}

std::vector<PassCounts> Refinement::fit(const CalibratedStack& input, const Image<unsigned char>& mask,
                                        int tile, FitResult& result, LightVisibility& lights,
                                        const Progress& progress) {
    Surface& surface = result.surface;
    const glm::ivec2 corner = in_painting(surface, 0, 0);
    if (&surface.height_mm != &height_mm_)
        surface.height_mm =
            cut(height_mm_, {corner.x, corner.y, corner.x + surface.width(), corner.y + surface.height()});
    start_with(first_.result.surface, first_.reduction, surface);
    pass_.lights =
        LightVisibility(surface.width(), surface.height(), static_cast<int>(input.stack.photos.size()));
    std::vector<PassCounts> counts = fit_pixels(
        input, options_, {.name = "refine", .mask = mask, .first = &pass_, .tile = tile}, result, progress);
    lights = std::move(pass_.lights);
    return counts;
}

void settle_refined(bool forgets, const Lighting& lighting, LightVisibility& lights, Surface& surface) {
    if (forgets) forget_unfitted(surface);
    lights.find_runs(surface, lighting);
    fill_low_confidence(surface);
}

}  // namespace tangi
