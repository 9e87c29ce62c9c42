// painting_fit.h: the steps of a fit, and what each leaves to those after it. The photographs are opened
// before, and developed as they are read; the residual is a step of its own (residual_fit.h).
#pragma once

#include "fit/pipeline/fit_passes.h"
#include "fit/pipeline/fit_plan.h"
#include "fit/pipeline/preprocess.h"

namespace tangi {

class PaintingFit {
public:
    PaintingFit(Stack stack, const FitOptions& options, const Progress& progress)
        : stack_(std::move(stack)), options_(options), progress_(progress) {}

    // After look_at_reduced(): goes on with the pixels that were refined since.
    PaintingFit(FitPlan plan, const FitOptions& options, const Progress& progress);

    void require_fittable();
    void require_room() const;  // for the maps
    // With the transfer curve and the camera's motion. `least_reduction`: of the photographs that are
    // reduced.
    void preprocess(int least_reduction = 1);
    void linearise();
    void start_surface();
    void balance_colours();
    void calibrate_lights();
    void describe_lights();
    void select_reflectance_model();
    void reduce_to_preview();
    void fit_pixels();
    FitPlan planned();  // what is left to the pixels
    // Instead of fit_pixels(): all of them, as Refinement left them.
    void take_pixels(RefinedPixels pixels);
    void find_misfit();
    void correct_colours();
    void find_height();
    void find_support();
    FitResult finished();

private:
    CalibratedStack calibrated() const { return {stack_, transfer_, *noise_, lighting_}; }
    SurveyedStack surveyed() const { return {stack_, survey_, transfer_, *noise_, surface_.mm_per_pixel}; }
    LitSurvey lit_survey() const { return {survey_, transfer_, lighting_}; }
    void warn(std::string warning) {
        if (!warning.empty()) stack_.warnings.push_back(std::move(warning));
    }
    void take_unit();
    void make_maps(int width, int height);
    void name_photographs();
    void take_white_of_chart();
    LobeFreedom choose_lobes(const LightSample& sample);
    void look_at_signs(FitResult& first, int reduction, bool height_known) const;

    Stack stack_;
    FitOptions options_;  // with the white level that is found
    const Progress& progress_;
    FitResult result_;
    FitReport& report_ = result_.report;
    Surface& surface_ = result_.surface;
    Survey survey_;
    ReducedPhotos reduced_;  // of a large picture, until its pixels are fitted
    std::optional<Preprocessed::OrderBefore> order_before_;
    Transfer transfer_;
    bool white_given_ = options_.white_level.has_value();
    std::optional<NoiseModel> noise_;
    Lighting lighting_;  // as the camera sees it, of stack_.photos
    LobeFreedom lobes_;
    std::optional<LightVisibility> visibility_;
    Plane support_;  // that was taken off the height
};

}  // namespace tangi
