// photography_json.h: a Photography (transfer, lights, which photographs were fitted) as JSON and back.
#pragma once

#include <nlohmann/json.hpp>

#include "surface/maps/surface.h"

namespace tangi {

nlohmann::json to_json(const Photography& photography);

// Three rows of three numbers; of any 3 x 3 matrix.
nlohmann::json to_json(const Homography& homography);
Homography homography_from_json(const nlohmann::json& rows);

// An empty object gives an empty Photography. Throws Error, or nlohmann's exceptions, where the JSON is not
// one.
Photography photography_from_json(const nlohmann::json& json);

}  // namespace tangi
