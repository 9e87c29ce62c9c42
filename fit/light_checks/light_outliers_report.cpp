#include <algorithm>

#include "fit/light_checks/light_outliers.h"

namespace tangi {

std::vector<std::string> doubts_of(const LightOutliers& outliers, const std::vector<std::string>& names) {
    std::vector<std::string> doubts;
    for (const LightOutlier& odd : outliers.odd) {
        const std::string& name = names[odd.photo];
        if (odd.higher_deg && !odd.exchanged_with) {
            doubts.push_back(fmt::format(
                "{}: is shaded by a light {:.0f} ± {:.0f} degrees {} than the one listed for it (other "
                "photographs: {:.1f}), at about ({:.2f} {:.2f} {:.2f}); correct its line in the lights file, "
                "or "
                "take it out",
                name, odd.off_deg, odd.sigma_deg, *odd.higher_deg > 0 ? "higher" : "lower",
                outliers.height_scatter_deg, odd.shown.x, odd.shown.y, odd.shown.z));
            continue;
        }
        if (!odd.exchanged_with) {
            doubts.push_back(fmt::format(
                "{}: is shaded by a light {:.0f} ± {:.0f} degrees aside from the one listed for it (other "
                "photographs: {:.1f}), at about ({:.2f} {:.2f} {:.2f}) if it is as high; correct its line in "
                "the lights file, or take it out",
                name, odd.off_deg, odd.sigma_deg, outliers.scatter_deg, odd.shown.x, odd.shown.y,
                odd.shown.z));
            continue;
        }
        if (*odd.exchanged_with < odd.photo) continue;
        const auto other = std::find_if(outliers.odd.begin(), outliers.odd.end(), [&](const LightOutlier& o) {
            return o.photo == *odd.exchanged_with;
        });
        doubts.push_back(fmt::format(
            "{} and {}: each is shaded by the other's light (their own are off by {:.0f} and {:.0f} degrees, "
            "each other's by {:.1f} and {:.1f}; other photographs': {:.1f}); exchange their lights in the "
            "lights file",
            name, names[other->photo], odd.off_deg, other->off_deg, odd.exchanged_off_deg,
            other->exchanged_off_deg, outliers.scatter_deg));
    }
    return doubts;
}

nlohmann::json to_json(const LightOutliers& outliers, const std::vector<std::string>& names) {
    nlohmann::json odd = nlohmann::json::array();
    for (const LightOutlier& light : outliers.odd)
        odd.push_back(
            {{"name", names[light.photo]},
             {"off_deg", light.off_deg},
             {"sigma_deg", light.sigma_deg},
             {"higher_deg", light.higher_deg ? nlohmann::json(*light.higher_deg) : nlohmann::json(nullptr)},
             {"shown", {light.shown.x, light.shown.y, light.shown.z}},
             {"exchanged_with", light.exchanged_with ? nlohmann::json(names[*light.exchanged_with])
                                                     : nlohmann::json(nullptr)}});
    return {{"scatter_deg", outliers.scatter_deg},
            {"height_scatter_deg", outliers.height_scatter_deg},
            {"odd", std::move(odd)}};
}

}  // namespace tangi
