// recipe_json.h: recipes and retouches as logs and programs have them, and what is to be said about them.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "retouch/colour_match/gloss.h"
#include "retouch/colour_match/pigment_pairs.h"
#include "retouch/colour_match/viewing_distance.h"
#include "retouch/inpaint/retouch_modes.h"

namespace tangi {

// {"D65": 0.3, "A": 0.5, …}; what is not a number is left out.
nlohmann::json by_each_light(const std::array<double, kIlluminants>& values);

// Paints with their parts by volume, steps with their measures, and one line of text.
nlohmann::json as_json(const std::vector<MixingStep>& steps, const Mixture& mixture,
                       const std::vector<Pigment>& paints);
// Which of the box's warnings concern these paints; paints of which only the colour is known.
nlohmann::json warnings_of(const Mixture& mixture, const std::vector<Pigment>& paints,
                           const std::vector<PairWarning>& pairs);
nlohmann::json to_json(const RetouchReport& report, const std::vector<Pigment>& paints,
                       const std::vector<PairWarning>& pairs);
nlohmann::json to_json(const Fusion& fusion);

// Gloss of a mixture: of its paints, by volume.
Gloss gloss_of(const Mixture& mixture, const std::vector<Pigment>& paints, double luminance);

// Pairs that may come together, for MatchOptions: none of those that are warned of. Empty where all may.
std::vector<char> without_pairs(std::size_t paints, const std::vector<PairWarning>& pairs);

// A retouch as it is seen, and what it should look like, in the region that the report names. `seen`: the
// diffuse colour of the painting with it.
struct RetouchViews {
    Image<Rgb> retouched, target;
    Mask mask;
};
// How recipes were sought, and how a retouch was laid, for the log.
nlohmann::json parameters_of(const MatchOptions& options);
nlohmann::json parameters_of(RetouchMode mode, const RetouchOptions& options);

RetouchViews retouch_views(const Image<Rgb>& seen, const Mask& mask, const RetouchReport& report);

}  // namespace tangi
