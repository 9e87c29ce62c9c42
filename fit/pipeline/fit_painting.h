// fit_painting.h: the main job: a Stack of photographs to a Surface.
#pragma once

#include <string>
#include <vector>

#include "capture/photo/rejected_photo.h"
#include "capture/radiometry/transfer_estimate.h"
#include "capture/radiometry/white_balances.h"
#include "capture/registration/registration.h"
#include "capture/registration/sharpening.h"
#include "capture/stack/stack.h"
#include "fit/calibration/light_calibration.h"
#include "fit/calibration/reflectance_model_selection.h"
#include "fit/height/height.h"
#include "fit/light_checks/axis_check_shadows.h"
#include "fit/light_checks/light_outliers.h"
#include "fit/light_checks/light_residual_map.h"
#include "fit/light_checks/list_order.h"
#include "fit/light_checks/photo_misfit.h"
#include "fit/pipeline/chart_correction.h"
#include "fit/pipeline/final_height.h"
#include "fit/pipeline/row_fitter.h"
#include "fit/pixel/fit_errors.h"
#include "fit/pixel/ward_fit.h"
#include "fit/shadows/light_angular_radius.h"
#include "surface/maps/surface.h"

namespace tangi {

struct FitOptions {
    // [1] linear value of a matt white facing a light; where empty, what a chart in the picture says, or 1
    std::optional<double> white_level{};
    std::optional<double> mm_per_pixel{};  // [mm] 1 where unknown
    std::optional<double> noise{};  // [1] standard deviation of a stored value, full scale = 1; where empty
                                    // 0.012 for 8-bit photographs (3 codes: JPEG), 0.006 for deeper ones
    bool register_photos = true;    // find out whether the camera moved, and undo it
    bool lights_as_given = false;   // distant lights of equal strength, as a lights file describes them
    // Of the whole painting; where empty, what predicts validation photographs best.
    std::optional<double> diffuse_roughness{}, second_lobe_weight{};
    std::optional<int> coloured_specular{};     // 1: lobes may have colours; 0: all are white; likewise
    std::optional<int> anisotropic_specular{};  // 1: lobes may be anisotropic; 0: all are isotropic; likewise
    Solver solver = Solver::batch;
    // [deg] Angular radius of the lights; where empty, what cast shadows say (light_angular_radius.h).
    std::optional<double> light_radius_deg{};
    bool refine = true;  // fit twice: the second time with neighbours' lobes and cast shadows known
    // Fits a large picture reduced to a megapixel at most, in a fraction of the time: a painting of that
    // size.
    bool preview = false;
    LightCalibrationOptions calibration = {};
    WardFitOptions ward = {};
    HeightOptions height = {};

    static constexpr std::string_view name = "fit";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(
            FieldInfo{"white_level", 1e-9, 1e9, "1", "linear pixel value of a matt white that faces a light"},
            self.white_level);
        visit(FieldInfo{"mm_per_pixel", 1e-6, 1e3, "mm", "size of a pixel on the painting (1 where unknown)"},
              self.mm_per_pixel);
        visit(FieldInfo{"lights_as_given", 0, 1, "",
                        "take the lights for distant and equally strong, as a lights file describes them"},
              self.lights_as_given);
        visit(
            FieldInfo{"diffuse_roughness", 0, 1, "1",
                      "roughness of the diffuse reflection (0: Lambert's law; else the photographs decide)"},
            self.diffuse_roughness);
        visit(
            FieldInfo{"second_lobe_weight", 0, 1, "1",
                      "part of the lobe in a wider one, of the whole painting (else the photographs decide)"},
            self.second_lobe_weight);
        visit(FieldInfo{"specular_colour", 0, 1, "1",
                        "1: lobes may have colours, as those of metal; 0: all are white (else the "
                        "photographs decide)"},
              self.coloured_specular);
        visit(FieldInfo{"anisotropic_specular", 0, 1, "1",
                        "1: lobes may be anisotropic, as those of brushed metal; 0: none is (else "
                        "the photographs decide)"},
              self.anisotropic_specular);
        visit(
            FieldInfo{"light_radius_deg", 0, 45, "deg",
                      "angular radius of the lights: softness of cast shadows (else the photographs decide)"},
            self.light_radius_deg);
        visit(FieldInfo{"refine", 0, 1, "",
                        "fit twice: the second time with the lobes of neighbours and cast shadows known"},
              self.refine);
        visit(
            FieldInfo{"preview", 0, 1, "",
                      "fit a large picture reduced to a megapixel at most: a smaller painting, in a fraction "
                      "of the time"},
            self.preview);
        visit(FieldInfo{"noise", 1e-5, 0.5, "1", "noise of the stored values, full scale = 1"}, self.noise);
    }
};

struct FitReport {
    std::vector<RejectedPhoto> rejected;  // photographs of the stack that are not used (preprocess.h)
    std::string turned_doubt;             // many photographs are turned against the others (turned_photos.h)
    Registration registration;            // how far the camera moved; empty where not asked for
    TransferEstimate transfer;            // how the photographs were linearised, and how that is known
    LightCalibration lights;              // what strengths and distances were found, and whether that helped
    LightMisfit misfit;                   // of a sample, after the lights were calibrated
    ReflectanceModelSelection reflectance_model;  // of the whole painting, and how it is known
    ColourReport colour;
    WhiteBalances white_balances;  // of the photographs, beside each other; lights.lighting's gains have them
    int reduction = 1;             // of a preview: by which it is smaller than the picture
    long pixels = 0;               // of the picture
    long fitted = 0;               // with a valid estimate
    long not_converged = 0;        // of those fitted
    SolverAgreement solvers;       // how the batched kernel compares with Ceres, in the last pass
    long too_bright = 0;           // of those fitted: at the upper bound of rho_d
    double unsure = 0;             // [1] part of those fitted whose confidence is below 0.5
    double coloured = 0;           // [1] part of the fitted pixels whose lobe is not white
    double anisotropic = 0;        // [1] part of them whose lobe is anisotropic
    double median_confidence = 0;  // [1] of the fitted pixels
    double median_rms_residual = 0;  // [sigma] robust; about 1 where noise and model error are as assumed
    double support_tilt_deg =
        0;  // [deg] of the plane taken off the height: doubtful light directions show here
    // [deg] By how much the normals turn outwards from the middle of the picture to its corners, as on a
    // painting that bulges (negative: is hollow) as a whole: lights that are nearer than is thought look so.
    double support_bulge_deg = 0;
    bool refined = false;  // a second pass, with shadows and neighbours (fit_passes.h)
    HeightReport height;
    HeightChoice height_choice;
    LightAngularRadius light_angular_radius;
    SignCheck signs;                       // whether the lights' axes point the way that the slopes say
    ShadowCheck shadow_signs;              // and that cast shadows say
    ListOrder list_order;                  // whether photographs fit the lights of others
    std::vector<std::string> order_names;  // of the photographs that this is of
    Sharpening sharpening;                 // of the photographs, before they were given to anyone
    PhotoMisfits photo_misfits;            // what photographs have that the surface does not explain
    LightOutliers light_outliers;          // photographs that are shaded by another light than theirs
    std::vector<std::string> photo_names;  // that these are of
    // Of the photographs fitted: pixels that held no number (Survey::Photo), where any did.
    std::vector<std::pair<std::string, long>> without_number;
    std::vector<std::string> warnings;
};

struct FitResult {
    Surface surface;
    FitErrors errors;
    FitReport report;
};

// Surveys the stack, linearises, fits every pixel in bands (so that memory does not depend on the number of
// photographs, but for what their shadows say) and integrates the height; then, to refine, all pixels once
// more, each with what its neighbours say about its lobe and with the shadows that the relief casts; where
// lobes have colours, or are anisotropic, also with those. Deterministic for any number of threads. Throws
// Error on what the photographs make impossible; Cancelled where progress asks for it.
FitResult fit_painting(Stack stack, const FitOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
