#include "capture/registration/registration.h"

namespace tangi {

nlohmann::json to_json(const Registration& registration) {
    const auto list = [](const std::vector<PhotoDrift>& drifts) {
        nlohmann::json photos = nlohmann::json::array();
        for (const PhotoDrift& d : drifts) {
            const glm::dvec3* h = &d.homography[0];
            photos.push_back(
                {{"name", d.name},
                 {"registered", d.registered},
                 {"warped", d.warped},
                 {"drift_px", d.drift_px},
                 {"standard_error_px", d.error_px},
                 {"model", name_of(d.model)},
                 {"correlation", d.correlation},
                 {"per_photo_light",
                  d.per_photo_light
                      ? nlohmann::json({d.per_photo_light->x, d.per_photo_light->y, d.per_photo_light->z})
                      : nlohmann::json(nullptr)},
                 {"homography",
                  {{h[0].x, h[1].x, h[2].x}, {h[0].y, h[1].y, h[2].y}, {h[0].z, h[1].z, h[2].z}}}});
        }
        return photos;
    };
    if (registration.reference.empty()) return {{"done", false}};
    return {{"done", true},
            {"reference", registration.reference},
            {"moved", registration.moved},
            {"typical_drift_px", registration.typical_drift_px},
            {"apparent_drift_of_shading_px", registration.shading_px},
            {"photos", list(registration.photos)},
            {"held_out", list(registration.held_out)}};
}

}  // namespace tangi
