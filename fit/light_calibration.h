// light_calibration.h: how strong and how near the lamps were, what light came from all around, and how near
// the camera was, from the photographs of a stack alone.
//
// Solved with Ceres jointly with the surface: for a sample of pixels a slope, a grey rho_d, rho_s and alpha
// each; for each photograph ln gain; for the stack the ambient light and the distances of lamps and camera,
// all against the photographs, robustly. What is found is used only where it predicts photographs that were
// left out better.
//
// What photographs cannot tell is fixed so:
//   strength   the median gain is 1; white_level says what that means
//   tilt       directions at the picture's centre are those of the lights file
//   bulge      the painting is flat as a whole: slopes are around 0 and do not grow from the centre to the
//              borders more than the lamps' distance explains (Rig::bend_per_mm takes up the rest)
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/survey.h"
#include "fit/lighting.h"
#include "fit/ward_fit.h"
#include "surface/lamp_model.h"
#include "surface/progress.h"

namespace tangi {

// What may differ from the lights file.
enum class LightFreedom {
    none,           // distant lamps of equal strength
    rig,            // ambient light, distances of lamps and camera
    rig_and_gains,  // and a strength for each lamp
};
std::string_view name_of(LightFreedom freedom);

struct LightCalibrationOptions {
    int samples = 500;       // [1] pixels to solve for
    int fewest_photos = 12;  // [1] with fewer, lights are taken as given
    double worth_db =
        0.1;  // [dB] by which it must predict left-out photographs better, less the standard error

    static constexpr std::string_view name = "light_calibration";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"samples", 50, 4000, "1", "pixels to calibrate the lights with"}, self.samples);
        visit(FieldInfo{"fewest_photos", 6, 10000, "1", "photographs below which lights are taken as given"},
              self.fewest_photos);
        visit(
            FieldInfo{
                "worth_db", 0, 100, "dB",
                "improvement on left-out photographs, beyond its standard error, that calibrating needs"},
            self.worth_db);
    }
};

struct LightCalibration {
    struct Trial {
        LightFreedom freedom;
        double left_out_db = 0;         // [dB] mean PSNR of photographs left out in turn, on the sample
        std::vector<double> photos_db;  // [dB] of each of them, the same photographs in all trials
    };
    Lighting lighting;                 // lights in the order of stack.photos
    std::optional<LampModel> lamps{};  // where gains were found
    LightFreedom freedom = LightFreedom::none;
    std::vector<Trial> trials;  // empty where there were too few photographs to try
};

// The photographs' lights as the fit should take them. `given` has the lights of stack.photos; the survey is
// of the stack. Deterministic for any number of threads.
LightCalibration calibrate_lights(const Stack& stack, const Survey& survey, const Transfer& transfer,
                                  const NoiseModel& noise, const Lighting& given, double mm_per_pixel,
                                  const WardFitOptions& ward, const LightCalibrationOptions& options = {},
                                  const Progress& progress = {});

// What was found, for people and scripts: distances in mm, gains by photograph.
nlohmann::json to_json(const LightCalibration& calibration);

}  // namespace tangi
