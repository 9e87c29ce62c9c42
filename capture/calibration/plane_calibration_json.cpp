#include "capture/calibration/plane_calibration.h"
#include "surface/maps/photography_json.h"

namespace tangi {

using glm::dvec2;
using nlohmann::json;

json to_json(const PlaneCalibration& c) {
    json markers = json::array(), scales = json::array(), geometry = nullptr;
    for (const Marker& marker : c.markers.markers) {
        json corners = json::array();
        for (const dvec2& corner : marker.corners_px) corners.push_back({corner.x, corner.y});
        markers.push_back({{"id", marker.id}, {"corners_px", std::move(corners)}});
    }
    for (const Scale& scale : c.scales) scales.push_back(to_json(scale));
    if (c.geometry) {
        geometry = to_json(*c.geometry);
        geometry["rectified_by"] = c.rectified_by.empty() ? json(nullptr) : json(c.rectified_by);
        geometry["tilt_deg"] = c.tilt_deg ? json(*c.tilt_deg) : json(nullptr);
        geometry["tilt_sigma_deg"] = c.tilt_deg ? json(c.tilt_sigma_deg) : json(nullptr);
        geometry["aligned_sigma_px"] = c.earlier ? json(c.earlier->error_px) : json(nullptr);
        geometry["photograph_outside"] = c.photo_outside;
        geometry["picture_outside"] = c.picture_outside;
    }
    return {{"scale", c.scales.empty() ? json(nullptr) : scales.front()},
            {"scales", std::move(scales)},
            {"markers",
             {{"dictionary", c.markers.dictionary},
              {"found_in", c.markers_in},
              {"residual_px", c.marker_residual_px},
              {"found", std::move(markers)}}},
            {"geometry", std::move(geometry)}};
}

}  // namespace tangi
