// light_outliers.h: photographs that are shaded by another light than the one listed for them.
//
// Matt reflection is g·s, g = ρd times the normal and s = strength times the direction of the light. The g of
// a sample of pixels, found from all photographs robustly (photometric stereo, Woodham 1980), tell s of each
// photograph by linear regression, whatever its strength; what varies slowly over the picture (to the second
// degree), as near lights make it, is free. Only the side from which s comes is compared with the list: how
// high a light stands hangs on what is even in the picture, and so on ambient light and gloss. What all have
// in common (an affine map of x and y) is fitted robustly and taken off. Photographs that stand out are left
// out of the g, and all are judged once more. Nothing is said of photographs whose neighbours, by direction,
// are off as well (gloss), that the relief explains worse than others, or that are clipped; nor where the
// photographs scatter by more than 6 degrees. A flat, even painting tells nothing.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/stack/survey.h"

namespace tangi {

struct LightOutlier {
    std::size_t photo = 0;  // in the order of the lights
    double off_deg = 0;     // between the listed light and one as high on the side that it shows
    double sigma_deg = 0;   // standard error, by leaving out a sixteenth of the picture in turn
    Vec3 shown{0, 0, 1};    // [unit vector] that one, as lights are listed
    // Where the side is right and the height is not: how much higher the light stands than listed, off_deg
    // being its size, and `shown` on the listed side.
    std::optional<double> higher_deg{};
    // The photograph whose light explains this one, where this one's light explains that one, too.
    std::optional<std::size_t> exchanged_with{};
    double exchanged_off_deg = 0;  // as off_deg, of the light of that one
};

struct LightOutliers {
    std::vector<LightOutlier> odd;     // in the order of the photographs
    std::vector<double> off_deg{};     // of each photograph; NaN where it tells nothing
    double scatter_deg = 0;            // robust, of photographs that are right
    std::vector<double> higher_deg{};  // how much higher than listed each light is shown; likewise
    double height_scatter_deg = 0;
};

// `survey` has one photograph for each light; `lights` are as listed, but for their strengths, as far as
// these are known. Nothing of fewer than 8 photographs. Deterministic for any number of threads.
LightOutliers light_outliers(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                             int width, int height);

// What is to be done about it, for people: one for each pair that is exchanged and each other odd light.
std::vector<std::string> doubts_of(const LightOutliers& outliers, const std::vector<std::string>& names);

nlohmann::json to_json(const LightOutliers& outliers, const std::vector<std::string>& names);

}  // namespace tangi
