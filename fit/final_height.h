// final_height.h: the height of a fitted surface, as the shadows in the photographs agree with it best.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "capture/survey.h"
#include "fit/fit_errors.h"
#include "fit/height.h"
#include "fit/lighting.h"
#include "surface/progress.h"
#include "surface/surface.h"

namespace tangi {

// Which height it is, and what shadows said of it.
struct HeightChoice {
    bool cliffs = false;  // the height may have cliffs (HeightOptions::robust_sweeps)
    double mixing = 0;    // [1] of unmixed_normals(); 0: slopes were integrated as they are
    struct Trial {
        bool cliffs;
        double mixing;
        double shadow_misfit;  // [1] shadow_misfit(), less is better
    };
    std::vector<Trial> trials{};  // in this order; none where shadows do not tell
};

struct FinalHeight {
    HeightReport report;
    Plane plane;  // that was taken off
    HeightChoice choice;
};

// Fills in surface.height_mm less its plane, and its standard errors. Where `shadows_tell`, the height is
// that whose cast shadows agree best with the light that the survey's samples show (shadow_misfit()): with
// cliffs or without (options.robust_sweeps), and of slopes as they are or as steep as what their pixels mix
// (mixed_slopes.h). Where there are no shadows to see, slopes are taken as they are.
FinalHeight final_height(Surface& surface, const Survey& survey, const Transfer& transfer,
                         const Lighting& lighting, const HeightOptions& options, bool shadows_tell,
                         Image<HalfError>* error_mm, const Progress& progress);

// {"cliffs", "slope_mixing", "tried": [{"cliffs", "slope_mixing", "shadow_misfit"}, …]}
nlohmann::json to_json(const HeightChoice& choice);

}  // namespace tangi
