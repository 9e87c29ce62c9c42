#include "surface/maps/photography_json.h"

#include <cmath>
#include <glm/matrix.hpp>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/renamed_keys.h"

namespace tangi {

using nlohmann::json;

namespace {

json array_of(const Vec3& v) { return {v.x, v.y, v.z}; }

json to_json(const GaussianProcess& process) {
    json parts = json::array();
    for (const GaussianProcess::Part& part : process.parts)
        parts.push_back({{"reach", part.reach}, {"weights", part.weights}});
    return {{"mean", process.mean}, {"parts", std::move(parts)}};
}

// `lights`: that it was fitted to.
GaussianProcess process_of(const json& j, std::size_t lights) {
    GaussianProcess process{.mean = j.at("mean").get<double>(), .parts = {}};
    for (const json& written : j.at("parts")) {
        process.parts.push_back({written.at("reach").get<double>(), written.at("weights")});
        const GaussianProcess::Part& part = process.parts.back();
        if (!(part.reach > 0)) fail("the reach of a light model is not above 0");
        if (part.weights.size() != lights)
            fail("a light model has {} weights for {} lights", part.weights.size(), lights);
    }
    return process;
}

json to_json(const LightModel& model) {
    json written = to_json(model.log_gain);
    if (model.log_colours) {
        written["red"] = to_json((*model.log_colours)[0]);
        written["blue"] = to_json((*model.log_colours)[1]);
    }
    return written;
}

// Models of version 0.1, a trend with leftovers, are made anew from the lights.
bool is_of_trend(const json& j) { return j.contains("trend"); }

LightModel light_model_of(const json& j, const std::vector<Light>& lights) {
    if (is_of_trend(j)) return fit_light_model(lights);
    LightModel model{process_of(j, lights.size())};
    if (j.contains("red"))
        model.log_colours = {process_of(j["red"], lights.size()), process_of(j.at("blue"), lights.size())};
    return model;
}

// No number of a capture is as large: the squares of larger ones overflow.
float number_of_light(const json& j) {
    constexpr float most = 1e9f;
    const float number = j.get<float>();
    if (!(std::abs(number) <= most)) fail("{} is beyond {}", number, most);
    return number;
}

Vec3 vec3_of(const json& j) {
    return {number_of_light(j.at(0)), number_of_light(j.at(1)), number_of_light(j.at(2))};
}

}  // namespace

json to_json(const Homography& h) {
    json rows = json::array();
    for (int row = 0; row < 3; ++row) rows.push_back({h[0][row], h[1][row], h[2][row]});
    return rows;
}

Homography homography_from_json(const json& rows) {
    Homography h(1);
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column) {
            const double value = rows.at(row).at(column).get<double>();
            h[static_cast<int>(column)][static_cast<int>(row)] = value;
        }
    return h;
}

json to_json(const Photography& photography) {
    json photos = json::array();
    for (const Photography::Photo& photo : photography.photos) {
        json entry = {{"name", photo.light.name},
                      {"direction", array_of(photo.light.direction)},
                      {"gain", array_of(photo.light.gain)},
                      {"fitted", photo.fitted}};
        if (photo.homography) entry["homography"] = to_json(*photo.homography);
        if (photo.light.position_mm) entry["position_mm"] = array_of(*photo.light.position_mm);
        if (!photo.light.beam.even()) entry["beam"] = photo.light.beam.terms;
        if (photo.listed_direction) entry["listed_direction"] = array_of(*photo.listed_direction);
        photos.push_back(std::move(entry));
    }
    const Rig& rig = photography.rig;
    const auto distance = [](const std::optional<float>& mm) { return mm ? json(*mm) : json(nullptr); };
    json result = {{"transfer", photography.transfer.name()},
                   {"white_level", photography.white_level},
                   {"photos", std::move(photos)},
                   {"rig",
                    {{"ambient", rig.ambient},
                     {"camera_distance_mm", distance(rig.camera_distance_mm)},
                     {"camera_axis_mm", {rig.camera_axis_mm.x, rig.camera_axis_mm.y}},
                     {"light_distance_mm", distance(rig.light_distance_mm)},
                     {"surface_above_mm", rig.surface_above_mm},
                     {"bend_per_mm", rig.bend_per_mm},
                     {"light_radius_deg", rig.light_radius_deg}}}};
    if (photography.to_camera) result["to_camera"] = to_json(*photography.to_camera);
    if (photography.light_model) result["light_model"] = to_json(*photography.light_model);
    if (const auto& directions = photography.directions)
        result["directions"] = {{"turn", {to_json(directions->turn[0]), to_json(directions->turn[1])}}};
    if (const auto& beams = photography.beams) {
        json terms = json::array();
        for (const GaussianProcess& term : beams->terms) terms.push_back(to_json(term));
        result["beams"] = {{"radius_mm", beams->radius_mm}, {"terms", std::move(terms)}};
    }
    return result;
}

namespace {

Photography::Photo photo_of(const json& entry) {
    Photography::Photo photo;
    photo.light.name = entry.at("name").get<std::string>();
    photo.light.direction = vec3_of(entry.at("direction"));
    photo.light.gain = vec3_of(entry.at("gain"));
    if (entry.contains("position_mm")) photo.light.position_mm = vec3_of(entry.at("position_mm"));
    if (entry.contains("beam")) photo.light.beam.terms = entry.at("beam").get<std::array<float, 5>>();
    if (entry.contains("listed_direction")) photo.listed_direction = vec3_of(entry.at("listed_direction"));
    photo.fitted = entry.at("fitted").get<bool>();
    if (entry.contains("homography")) photo.homography = homography_from_json(entry.at("homography"));
    return photo;
}

Rig rig_of(const json& written) {
    const auto distance = [&](const char* name) {
        return written.at(name).is_null() ? std::nullopt : std::optional(written.at(name).get<float>());
    };
    Rig rig = {.ambient = written.at("ambient").get<float>(),
               .camera_distance_mm = distance("camera_distance_mm"),
               .camera_axis_mm = {},
               .light_distance_mm = distance("light_distance_mm"),
               .bend_per_mm = written.at("bend_per_mm").get<float>()};
    rig.surface_above_mm = written.value("surface_above_mm", 0.0f);  // not in older files
    if (rig.light_distance_mm && !(std::abs(rig.surface_above_mm) < *rig.light_distance_mm))
        fail("rig.surface_above_mm = {} is as high as the lights are far away, {} mm", rig.surface_above_mm,
             *rig.light_distance_mm);
    if (written.contains("light_radius_deg")) {  // in no file of before it was looked for
        rig.light_radius_deg = written["light_radius_deg"].get<float>();
        if (!(rig.light_radius_deg >= 0 && rig.light_radius_deg <= 45))
            fail("rig.light_radius_deg = {} is outside [0, 45] deg", rig.light_radius_deg);
    }
    if (written.contains("camera_axis_mm"))
        rig.camera_axis_mm = {written["camera_axis_mm"].at(0).get<float>(),
                              written["camera_axis_mm"].at(1).get<float>()};
    return rig;
}

BeamModel beam_model_of(const json& written, const std::vector<Light>& lights) {
    BeamModel beams;
    beams.radius_mm = written.at("radius_mm").get<double>();
    if (!(beams.radius_mm > 0)) fail("beams.radius_mm is not above 0");
    const json& terms = written.at("terms");
    if (is_of_trend(terms.at(0))) return fit_beam_model(lights, beams.radius_mm);
    for (std::size_t i = 0; i < beams.terms.size(); ++i)
        beams.terms[i] = process_of(terms.at(i), lights.size());
    return beams;
}

// `j`: of the photography. Files of version 0.1 have corrected directions, but no model of them.
std::optional<DirectionModel> direction_model_of(const json& j, const Photography& photography,
                                                 const std::vector<Light>& lights) {
    if (j.contains("directions")) {
        const json& turn = j["directions"].at("turn");
        return DirectionModel{{process_of(turn.at(0), lights.size()), process_of(turn.at(1), lights.size())}};
    }
    const std::vector<Vec3> listed = directions_as_listed(photography);
    bool corrected = false;
    for (std::size_t i = 0; i < lights.size(); ++i) corrected |= listed[i] != lights[i].direction;
    return corrected ? std::optional(fit_direction_model(listed, lights)) : std::nullopt;
}

}  // namespace

Photography photography_from_json(const json& written) {
    Photography photography;
    if (written.empty()) return photography;
    const json j = with_present_keys(written);
    const auto transfer = transfer_named(j.at("transfer").get<std::string>());
    if (!transfer) fail("unknown transfer curve '{}'", shortened(j.at("transfer").get<std::string>()));
    photography.transfer = *transfer;
    photography.white_level = j.at("white_level").get<double>();
    for (const json& entry : j.at("photos")) photography.photos.push_back(photo_of(entry));
    if (j.contains("rig")) photography.rig = rig_of(j.at("rig"));  // not in files of version 0.1
    if (j.contains("to_camera")) {
        photography.to_camera = homography_from_json(j.at("to_camera"));
        const double size = glm::determinant(*photography.to_camera);
        if (!(std::abs(size) > 1e-9 && std::abs(size) < 1e9)) fail("to_camera has no inverse");
    }
    const std::vector<Light> lights = fitted_lights(photography);
    if (j.contains("light_model")) photography.light_model = light_model_of(j.at("light_model"), lights);
    if (j.contains("beams")) photography.beams = beam_model_of(j["beams"], lights);
    photography.directions = direction_model_of(j, photography, lights);
    return photography;
}

}  // namespace tangi
