// retouch_arguments.h: what the commands of retouching share: paint box, illuminants, pairs of pigments,
// masks, the treatment that a step is logged in.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "paint/optics/palette.h"
#include "retouch/colour_match/pigment_pairs.h"
#include "retouch/colour_match/recipe.h"
#include "retouch/inpaint/recipe_json.h"

namespace tangi {

constexpr double kPoorMatch = 5;  // CIEDE2000 that nobody would call a match

// A box of paints and how recipes are chosen from it.
struct PaintBoxArguments {
    std::string palette, illuminants = "D65,A,F11", goal = "worst", pairs;
    bool avoid_pairs = false;

    void add_to(Flags& flags);
    std::vector<std::filesystem::path> inputs() const;
};

struct PaintBox {
    Palette palette;                 // paints that colour
    std::vector<std::string> media;  // names of what only makes them transparent
    std::vector<PigmentPair> pairs;
    std::vector<PairWarning> warnings;  // of the box; they refer to `pairs`
};
PaintBox paint_box(const PaintBoxArguments& arguments);

// Sets illuminants, goal and, with --avoid-pairs, the pairs that are allowed.
void set_options(const PaintBoxArguments& arguments, const PaintBox& box, MatchOptions& options);

// "D65,A,F11". Throws UsageError naming the flag.
std::vector<Illuminant> illuminants_in(const std::string& text, const std::string& flag);

// Which of the box's warnings concern these paints.
inline nlohmann::json warnings_of(const Mixture& mixture, const PaintBox& box) {
    return warnings_of(mixture, box.palette.paints, box.warnings);
}

}  // namespace tangi
