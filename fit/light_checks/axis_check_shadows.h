// axis_check_shadows.h: which way the axes of a lights file point, as the shadows tell that the relief casts.
//
// Slopes leave it open whether x, y or none or both of them are mirrored (axis_check_slopes.h), and turns by
// 180 degrees at all: hills and valleys are exchanged, and each light shines from the other side. Matt
// shading is the same; cast shadows are not.
#pragma once

#include <nlohmann/json.hpp>

#include "capture/stack/stack_calibration.h"
#include "capture/stack/survey.h"
#include "fit/light_checks/axis_check_slopes.h"
#include "fit/pixel/lighting.h"
#include "surface/maps/surface.h"

namespace tangi {

struct ShadowCheck {
    LightTurn best;  // of the lights as they are taken
    // [standard errors] by which photographs are darker where the relief casts shadows with these lights than
    // with those turned by 180 degrees, which slopes allow as well; 0 where too few shadows are cast.
    double certainty = 0;
    double contrast = 0;  // ln of how much darker they are there than where it casts none

    bool certain() const;
};

// The samples of a survey, which become linear light, and the lights that they were taken under.
struct LitSurvey {
    const Survey& survey;
    const Transfer& transfer;
    const Lighting& lighting;  // one light a photograph of the survey
};

// Of a surface with normals, ρd and, unless signs.wrong(), height as fitted to these lights without shadows;
// the survey is of the stack. `signs` says which two are compared: its remedy, for which the height is made
// anew, and that with half a turn more. All else of the surface is as before.
ShadowCheck check_shadows(Surface& surface, const SignCheck& signs, const LitSurvey& samples,
                          const Progress& progress = {});

// [1] Mean square of the part of its light that photographs show at samples of matt paint, less the part
// that gets past the surface's height, from lights of this angular radius.
double shadow_misfit(const Surface& surface, const LitSurvey& samples, double light_radius_deg);

// What is to be done about it, with the numbers, for people; empty where nothing is. `taken`: what was done
// to the lights already, as the user asked.
std::string doubt_of(const SignCheck& signs, const ShadowCheck& shadows, const LightAxes& taken);

nlohmann::json to_json(const SignCheck& signs, const ShadowCheck& shadows);

}  // namespace tangi
