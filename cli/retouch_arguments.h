// retouch_arguments.h: what the commands of retouching share: paint box, lamps, pairs of pigments, masks,
// the treatment that a step is logged in.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "paint/palette.h"
#include "paint/retouch/pigment_pairs.h"
#include "paint/retouch/recipe.h"

namespace tangi {

// A box of paints and how recipes are chosen from it.
struct PaintBoxArguments {
    std::string palette, lamps = "D65,A,F11", goal = "worst", pairs;
    bool avoid_pairs = false;

    void add_to(Flags& flags);
    std::vector<std::filesystem::path> inputs() const;
};

struct PaintBox {
    Palette palette;
    std::vector<PigmentPair> pairs;
    std::vector<PairWarning> warnings;  // of the box; they refer to `pairs`
};
PaintBox paint_box(const PaintBoxArguments& arguments);

// Sets lamps, goal and, with --avoid-pairs, the pairs that are allowed.
void set_options(const PaintBoxArguments& arguments, const PaintBox& box, MatchOptions& options);

// "D65,A,F11". Throws UsageError naming the flag.
std::vector<Illuminant> lamps_in(const std::string& text, const std::string& flag);

// {"D65": 0.3, "A": 0.5, …}; what is not a number is left out.
nlohmann::json by_lamp(const std::array<double, kIlluminants>& values);

// Paints with their parts by volume, steps with their measures, and one line of text.
nlohmann::json as_json(const std::vector<MixingStep>& steps, const Mixture& mixture,
                       const std::vector<Pigment>& paints);
// Which of the box's warnings concern these paints.
nlohmann::json warnings_of(const Mixture& mixture, const PaintBox& box);

}  // namespace tangi
