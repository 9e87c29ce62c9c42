// light_angular_radius.h: how large lamps look from the painting, by how soft the shadows are that they cast.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "capture/stack/survey.h"
#include "fit/pixel/lighting.h"
#include "surface/maps/surface.h"

namespace tangi {

struct LampRadius {
    double deg = Rig::kPointLamp_deg;
    struct Trial {
        double deg;
        double shadow_misfit;  // [1] shadow_misfit(), less is better
    };
    std::vector<Trial> tried{};  // empty where shadows were not asked
};

// Of all lamps together: the angular radius, from a small lamp's by octaves to a softbox's, with which the
// shadows that the surface's height casts agree best with those of the photographs; a small lamp's where that
// is not clearly better, or no shadows are seen. Where the height or the lamps' directions are a little off,
// shadows end where they should not, and are softer in the mean than the lamps are large: so it is what
// predicts photographs, not what a ruler would measure.
LampRadius find_lamp_radius(const Surface& surface, const Survey& survey, const Transfer& transfer,
                            const Lighting& lighting);

// {"deg", "tried": [{"deg", "shadow_misfit"}, …]}
nlohmann::json to_json(const LampRadius& radius);

}  // namespace tangi
