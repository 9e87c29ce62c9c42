// light_angular_radius.h: how large lights look from the painting, by how soft the shadows are that they
// cast.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "fit/light_checks/axis_check_shadows.h"
#include "surface/maps/surface.h"

namespace tangi {

struct LightAngularRadius {
    double deg = Rig::kPointLight_deg;
    struct Trial {
        double deg;
        double shadow_misfit;  // [1] shadow_misfit(), less is better
    };
    std::vector<Trial> tried{};  // empty where shadows were not asked
};

// Of all lights together: the angular radius, from a small light's by octaves to a softbox's, with which the
// shadows that the surface's height casts agree best with those of the photographs; a small light's where
// that is not clearly better, or no shadows are seen. Where the height or the lights' directions are a little
// off, shadows end where they should not, and are softer in the mean than the lights are large: so it is what
// predicts photographs, not what a ruler would measure.
LightAngularRadius find_light_angular_radius(const Surface& surface, const LitSurvey& samples);

// {"deg", "tried": [{"deg", "shadow_misfit"}, …]}
nlohmann::json to_json(const LightAngularRadius& radius);

}  // namespace tangi
