#include "surface/photography_json.h"

#include "surface/error.h"

namespace tangi {

using nlohmann::json;

namespace {

json array_of(const Vec3& v) { return {v.x, v.y, v.z}; }

Vec3 vec3_of(const json& j) { return {j.at(0).get<float>(), j.at(1).get<float>(), j.at(2).get<float>()}; }

}  // namespace

json to_json(const Photography& photography) {
    json photos = json::array();
    for (const Photography::Photo& photo : photography.photos) {
        json entry = {{"name", photo.light.name},
                      {"direction", array_of(photo.light.direction)},
                      {"gain", array_of(photo.light.gain)},
                      {"fitted", photo.fitted}};
        if (photo.light.position_mm) entry["position_mm"] = array_of(*photo.light.position_mm);
        photos.push_back(std::move(entry));
    }
    return {{"transfer", photography.transfer.name()},
            {"white_level", photography.white_level},
            {"photos", std::move(photos)}};
}

Photography photography_from_json(const json& j) {
    Photography photography;
    if (j.empty()) return photography;
    const auto transfer = transfer_named(j.at("transfer").get<std::string>());
    if (!transfer) fail("unknown transfer curve '{}'", j.at("transfer").get<std::string>());
    photography.transfer = *transfer;
    photography.white_level = j.at("white_level").get<double>();
    for (const json& entry : j.at("photos")) {
        Photography::Photo photo;
        photo.light.name = entry.at("name").get<std::string>();
        photo.light.direction = vec3_of(entry.at("direction"));
        photo.light.gain = vec3_of(entry.at("gain"));
        if (entry.contains("position_mm")) photo.light.position_mm = vec3_of(entry.at("position_mm"));
        photo.fitted = entry.at("fitted").get<bool>();
        photography.photos.push_back(std::move(photo));
    }
    return photography;
}

}  // namespace tangi
