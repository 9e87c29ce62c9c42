// light_calibration.h: how strong, how near and how even the lights were, what light came from all around,
// and how near the camera was, from the photographs of a stack alone.
//
// Solved by fit/calibration/schur_solver.h jointly with the surface: for a sample of pixels a slope, a grey
// rho_d, rho_s and alpha each; for each photograph ln gain, and a polynomial of the place where lights are
// uneven; for the stack the ambient light and the distances of lights and camera, all against the
// photographs, robustly. What is found is used only where it predicts photographs that were left out better.
//
// What photographs cannot tell is fixed so:
//   strength   the median gain is 1; white_level says what that means
//   tilt       directions at the picture's centre are those of the lights file
//   evenness   what all photographs have in common is the painting's: a lens that is darker towards its
//   corners,
//              or lights that all are, are divided out by a flat field (`--flat`) only
//   bulge      the painting is flat as a whole: slopes are around 0 and do not grow from the centre to the
//              borders more than the lights' distance explains (Rig::bend_per_mm takes up the rest)
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fit/calibration/light_bundle_adjustment.h"
#include "fit/calibration/light_sample.h"
#include "fit/pixel/validation_scores.h"
#include "surface/base/progress.h"
#include "surface/maps/light_model.h"

namespace tangi {

// What may differ from the lights file.
enum class LightFreedom {
    none,           // distant lights of equal strength
    rig,            // ambient light, distances of lights and camera
    rig_and_gains,  // and a strength for each light
};

// One way to explain the photographs.
struct LightingModel {
    LightFreedom lights = LightFreedom::none;
    DirectionFreedom directions = DirectionFreedom::listed;
    bool beams = false;  // each light lights the picture unevenly in its own way

    friend bool operator==(const LightingModel&, const LightingModel&) = default;
};
std::string name_of(const LightingModel& model);

struct LightCalibrationOptions {
    int samples = 500;  // [1] pixels to solve for
    // [1] with fewer, lights are taken to be equally strong, and only what all share is found: how near they
    // are, ambient light; with fewer than five nothing is
    int fewest_photos = 6;
    bool refine_directions =
        false;         // each light's direction is corrected, whatever validation photographs say
    bool flat = true;  // the object is, as a whole ("bulge" above); else its shape is what photographs say

    static constexpr std::string_view name = "light_calibration";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"samples", 50, 4000, "1", "pixels to calibrate the lights with"}, self.samples);
        visit(
            FieldInfo{"fewest_photos", 6, 10000, "1",
                      "photographs below which lights are taken to be equally strong, as only what all share "
                      "is found"},
            self.fewest_photos);
        visit(
            FieldInfo{
                "refine_directions", 0, 1, "",
                "correct each light's direction: for lights files that are known to be some degrees off"},
            self.refine_directions);
    }
};

struct LightCalibration {
    bool bent_most = false;  // Rig::bend_per_mm is as large as is allowed: the object is hardly flat
    struct Trial {
        LightingModel model;
        double cv_psnr_db = 0;          // [dB] mean PSNR of photographs left out in turn, on the sample
        std::vector<double> photos_db;  // [dB] of each of them, the same photographs in all trials
        // What the model is chosen by, of half of each one's pixels: as the other photographs predict it, and
        // once what the model gives each light of its own is found by the other half (bi-cross-validation:
        // Owen & Perry 2009, "Bi-cross-validation of the SVD and the nonnegative matrix factorization").
        ValidationScores scores;
    };
    Lighting lighting;                        // lights in the order of stack.photos
    std::optional<LightModel> light_model{};  // where gains were found
    std::optional<BeamModel> beams{};         // where they were
    LightingModel model{};
    // Where directions were corrected: of lighting.lights.
    struct Turn {
        double changed_deg = 0;  // from the listed direction
        double sigma_deg = 0;    // standard error of the direction; 0 where it can't be told
    };
    std::vector<Turn> turns{};
    // Where beams were found: of lighting.lights.
    struct Unevenness {
        double rms = 0;    // [1] of ln irradiance over the picture, beyond what distance makes of it
        double sigma = 0;  // standard error of that; 0 where it can't be told
    };
    std::vector<Unevenness> unevenness{};
    // Standard errors (68 %), empty and 0 where nothing was found or it can't be told.
    std::vector<double> gain_sigma{};  // [1] relative, of lighting.lights, less what all have in common
    struct RigSigma {
        double ambient = 0, diffuse_roughness = 0;       // [1]
        double light_distance = 0, camera_distance = 0;  // [1] relative
        double surface_above_mm = 0;
    } rig_sigma{};
    // [1] As ReflectanceModel's, where directions are measured: photographs tell both only together.
    std::optional<double> diffuse_roughness{};
    std::optional<DirectionModel> directions{};  // where directions were corrected
    std::vector<Trial> trials{};                 // empty where there were too few photographs to try
};

// The photographs' lights as the fit should take them. `given` has the lights of stack.photos. Directions
// whose standard errors are given are corrected as far as these allow, whatever validation photographs say,
// which share nothing with a light's own error. Deterministic for any number of threads.
LightCalibration calibrate_lights(const SurveyedStack& surveyed, const Lighting& given,
                                  const WardFitOptions& ward, const LightCalibrationOptions& options = {},
                                  const Progress& progress = {});

// Names the lights whose directions were corrected by more than 5 degrees; empty where there are none.
std::string warning_of(const LightCalibration& calibration, const std::string& folder);

// What was found, for people and scripts: distances in mm, gains by photograph.
nlohmann::json to_json(const LightCalibration& calibration);

}  // namespace tangi
