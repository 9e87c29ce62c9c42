#include "surface/base/renamed_keys.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace tangi {

namespace {

// Those that are read; what is written only has no old name to know.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kRenamed = {{
    {"balls", "spheres"},
    {"balls_used", "spheres_used"},
    {"faithful", "residual"},
    {"haze", "second_lobe_weight"},
    {"lamp_distance_mm", "light_distance_mm"},
    {"lamp_radius_deg", "light_radius_deg"},
    {"lamps", "light_model"},
    {"left_out", "cross_validated"},
}};

}  // namespace

nlohmann::json with_present_keys(nlohmann::json value) {
    if (value.is_array())
        for (nlohmann::json& part : value) part = with_present_keys(std::move(part));
    if (!value.is_object()) return value;
    nlohmann::json result = nlohmann::json::object();
    for (auto& [key, part] : value.items()) {
        const auto renamed = std::find_if(kRenamed.begin(), kRenamed.end(),
                                          [&key = key](const auto& r) { return r.first == key; });
        const std::string now = renamed == kRenamed.end() ? key : std::string(renamed->second);
        if (now == key || !value.contains(now)) result[now] = with_present_keys(std::move(part));
    }
    return result;
}

}  // namespace tangi
