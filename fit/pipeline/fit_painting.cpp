#include "fit/pipeline/fit_painting.h"

#include "fit/pipeline/painting_fit.h"

namespace tangi {

namespace {

// Steps 3 to 7 of docs/developer/architecture.md; 1 and 2 are the stack's.
void understand_photographs(PaintingFit& fit, int least_reduction) {
    fit.require_fittable();
    fit.preprocess(least_reduction);  // 3, and 5: registration
    fit.linearise();                  // 4
    fit.start_surface();
    fit.balance_colours();
    fit.calibrate_lights();  // 6
    fit.describe_lights();
    fit.select_reflectance_model();  // 7
}

// What follows the pixels; step 10, the residual, is fit_residual().
FitResult finished(PaintingFit& fit) {
    fit.find_misfit();
    fit.correct_colours();
    fit.find_height();  // 9
    fit.find_support();
    return fit.finished();
}

}  // namespace

FitResult fit_painting(Stack stack, const FitOptions& options, const Progress& progress) {
    validate(options);
    PaintingFit fit(std::move(stack), options, progress);
    fit.require_room();
    understand_photographs(fit, 1);
    fit.reduce_to_preview();
    fit.fit_pixels();  // 8, and the refinement of 9
    return finished(fit);
}

FitPlan plan_fit(Stack stack, const FitOptions& options, const Progress& progress) {
    validate(options);
    PaintingFit fit(std::move(stack), options, progress);
    // A small picture is reduced, too: what is planned is always the same.
    understand_photographs(fit, 2);
    return fit.planned();
}

FitResult finish_fit(FitPlan plan, const FitOptions& options, RefinedPixels pixels,
                     const Progress& progress) {
    PaintingFit fit(std::move(plan), options, progress);
    fit.take_pixels(std::move(pixels));
    return finished(fit);
}

}  // namespace tangi
