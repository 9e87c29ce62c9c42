// sphere_calibration_json.cpp: to_json(SphereCalibration), the content of capture.json
// (docs/reference/capture-json.md).
#include <glm/geometric.hpp>

#include "capture/sphere_lights/sphere_calibration.h"
#include "surface/file/version.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;
using nlohmann::json;

namespace {

json list(const dvec2& v) { return {v.x, v.y}; }
json list(const dvec3& v) { return {v.x, v.y, v.z}; }

template <class T>
json or_null(const std::optional<T>& value) {
    if (!value) return nullptr;
    if constexpr (std::is_arithmetic_v<T>)
        return *value;
    else
        return list(*value);
}

const char* name_of(HighlightState state) {
    switch (state) {
        case HighlightState::found:
            return "found";
        case HighlightState::absent:
            return "absent";
        case HighlightState::off_sphere:
            return "off_sphere";
        case HighlightState::ambiguous:
            return "ambiguous";
        case HighlightState::smeared:
            return "smeared";
        case HighlightState::off_picture:
            return "off_picture";
    }
    return "";
}

json highlights_of(const SphereCalibration& c, std::size_t photo) {
    json all = json::array();
    for (const FoundSphere& sphere : c.spheres) {
        if (sphere.highlights.empty()) continue;
        const Highlight& h = sphere.highlights[photo];
        json entry = {{"state", name_of(h.state)}};
        if (h.state == HighlightState::found) {
            entry["place_px"] = list(h.place_px);
            entry["sigma_px"] = h.sigma_px;
            entry["clipped"] = h.clipped;
        }
        all.push_back(std::move(entry));
    }
    return all;
}

json light_of(const SphereCalibration& c, std::size_t i) {
    const CalibratedLight& light = c.lights[i];
    json entry = {{"name", light.name},
                  {"direction", or_null(light.direction)},
                  {"position_mm", or_null(light.position_mm)},
                  {"spheres_used", light.spheres_used}};
    if (light.direction) entry["direction_sigma_deg"] = light.direction_sigma_deg;
    if (light.position_mm) entry["position_sigma_mm"] = list(light.position_sigma_mm);
    if (!light.direction) entry["rejected"] = light.reason;
    if (c.shadings.empty()) {
        entry["highlights"] = highlights_of(c, i);
    } else if (c.shadings[i]) {
        const MattShading& s = *c.shadings[i];
        entry["shading"] = {
            {"brightness", s.brightness}, {"ambient", s.ambient}, {"residual", s.residual}, {"lit", s.lit}};
    }
    const CameraMotion& drift = c.drifts.photos[i];
    entry["drift"] = {{"shift_px", list(drift.shift_px)},
                      {"roll_rad", drift.roll_rad},
                      {"zoom", drift.zoom},
                      {"sigma_px", drift.sigma_px}};
    return entry;
}

}  // namespace

json to_json(const SphereCalibration& c) {
    json lights = json::array(), spheres = json::array();
    for (std::size_t i = 0; i < c.lights.size(); ++i) lights.push_back(light_of(c, i));
    for (std::size_t i = 0; i < c.spheres.size(); ++i) {
        const FoundSphere& sphere = c.spheres[i];
        json entry = {
            {"name", sphere.name},
            {"kind", c.shadings.empty() ? "mirror" : "matt"},
            {"given", sphere.given},
            {"centre_px", list(sphere.image.centre_px)},
            {"centre_sigma_px", sphere.image.centre_sigma_px},
            {"radius_px", sphere.image.radius_px},
            {"radius_sigma_px", sphere.image.radius_sigma_px},
            {"outline", {{"coverage", sphere.outline_coverage}, {"residual_px", sphere.outline_residual_px}}},
            {"radius_mm", or_null(c.sphere_radius_mm)},
            {"centre_mm", i < c.sphere_centres_mm.size() ? or_null(c.sphere_centres_mm[i]) : json(nullptr)}};
        if (c.shadings.empty()) entry["highlights_found"] = sphere.highlights_found();
        spheres.push_back(std::move(entry));
    }
    json result = {
        {"format", "tangipaint capture 1"},
        {"software", program_name()},
        {"method", c.method},
        {"photographs", {{"count", c.lights.size()}, {"width", c.width}, {"height", c.height}}},
        {"camera",
         {{"model", c.camera.focal_px ? "perspective" : "orthographic"},
          {"focal_px", or_null(c.camera.focal_px)},
          {"principal_px", list(c.camera.principal_px)},
          {"position_mm", or_null(c.camera_position_mm)},
          {"mm_per_pixel", or_null(c.mm_per_pixel)},
          {"moved", c.drifts.moved},
          {"moved_rms_px", c.drifts.rms_px}}},
        {"frame", {{"origin_px", list(c.origin_px)}, {"axes", "x right, y up, z towards the camera"}}},
        {"residual", {{"highlights_px", c.residual_px}, {"highlights_sigma", c.residual_sigma}}},
        {"spheres", spheres},
        {"lights", lights},
        {"warnings", c.warnings},
        {"poor", c.poor}};
    if (c.matt_transfer) result["transfer"] = c.matt_transfer->name();
    return result;
}

}  // namespace tangi
