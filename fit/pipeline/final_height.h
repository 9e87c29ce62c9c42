// final_height.h: the height of a fitted surface, as the shadows in the photographs agree with it best.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "fit/height/height.h"
#include "fit/light_checks/axis_check_shadows.h"
#include "fit/pixel/fit_errors.h"
#include "fit/shadows/light_visibility.h"
#include "fit/shadows/shadow_carving.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// Which height it is, and what shadows said of it.
struct HeightChoice {
    bool cliffs = false;  // the height may have cliffs (HeightOptions::robust_sweeps)
    double mixing = 0;    // [1] of steepened_normals(); 0: slopes were integrated as they are
    // It is the height that hid lights in the second pass, though that left other slopes.
    bool before_refining = false;
    struct Trial {
        bool cliffs;
        double mixing;
        bool before_refining;
        double shadow_misfit;  // [1] shadow_misfit(), less is better
    };
    CarveReport carved{};         // by all shadows that were seen, last; 0 lights where none were
    bool carving_kept = false;    // whether the height is that
    std::vector<Trial> trials{};  // in this order; where shadows do not tell, none but of a refined fit
};

struct FinalHeight {
    HeightReport report;
    Plane plane;  // that was taken off
    HeightChoice choice;
};

// What photographs' shadows are good for.
struct HeightEvidence {
    bool shadows_tell = false;  // the model explains the photographs, and what it does not is shadow
    // surface.height_mm is the height that hid lights in the second pass, and is compared: where a cliff
    // stands, the first pass takes its shadow for slopes that lead up to it, the second for shadow, and no
    // slope shows the cliff any more.
    bool refined = false;
    const LightVisibility* lights = nullptr;  // in the second pass
};

// Fills in surface.height_mm less its plane, and its standard errors (those of slopes). Where `shadows_tell`,
// the height is that whose cast shadows agree best with the light that the samples show
// (shadow_misfit()): with cliffs or without (options.robust_sweeps), and of slopes as they are or as steep as
// what their pixels mix (subpixel_slopes.h); or, where `refined`, as it is. Where there are no shadows to
// see, slopes are taken as they are. Last it is carved (shadow_carving.h), where that makes shadows agree
// better.
FinalHeight final_height(Surface& surface, const LitSurvey& samples, const HeightOptions& options,
                         const HeightEvidence& evidence, Image<HalfError>* error_mm,
                         const Progress& progress);

// {"cliffs", "subpixel_slope_bias", "before_refining", "carved", "light_visibility": {"all",
// "contradicted_before", "contradicted"}, "tried": [{"cliffs", "subpixel_slope_bias", "before_refining",
// "shadow_misfit"}, …]}
nlohmann::json to_json(const HeightChoice& choice);

}  // namespace tangi
