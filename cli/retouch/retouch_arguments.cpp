#include "cli/retouch/retouch_arguments.h"

#include <algorithm>
#include <sstream>

#include "cli/command.h"
#include "retouch/colour_match/paint_media.h"

namespace tangi {

void PaintBoxArguments::add_to(Flags& flags) {
    flags.option("--palette", palette,
                 "palette file (.json, docs/reference/palette-format.md) with the paints at hand; the "
                 "built-in artist acrylics "
                 "without");
    flags
        .option("--illuminants", illuminants,
                "illuminants that a match counts under: of A, D50, D65, F11, LED")
        .show_default();
    flags
        .option("--goal", goal,
                "what is made small: the worst or the mean difference under these illuminants")
        .check(one_of({"worst", "mean"}))
        .show_default();
    flags.option("--pairs", pairs,
                 "list of pigments that are kept apart (.json, docs/reference/palette-format.md); a built-in "
                 "one without");
    flags.flag("--avoid-pairs", avoid_pairs,
               "leave out recipes with such a pair; without, they are warned of");
}

std::vector<std::filesystem::path> PaintBoxArguments::inputs() const {
    std::vector<std::filesystem::path> files;
    for (const std::string& file : {palette, pairs})
        if (!file.empty()) files.emplace_back(file);
    return files;
}

PaintBox paint_box(const PaintBoxArguments& a) {
    PaintBox box;
    box.palette = a.palette.empty() ? artist_acrylics() : read_palette(a.palette);
    box.media = take_out_media(box.palette);
    if (box.palette.paints.empty())
        fail("{}: holds media only ({}), and no paint that colours", a.palette, fmt::join(box.media, ", "));
    box.pairs = a.pairs.empty() ? usual_pigment_pairs() : read_pigment_pairs(a.pairs);
    box.warnings = pairs_to_avoid(box.palette.paints, box.pairs);
    return box;
}

void set_options(const PaintBoxArguments& a, const PaintBox& box, MatchOptions& options) {
    options.illuminants = illuminants_in(a.illuminants, "--illuminants");
    options.goal = a.goal == "mean" ? MatchGoal::mean : MatchGoal::worst;
    if (a.avoid_pairs) options.allowed = without_pairs(box.palette.paints.size(), box.warnings);
}

std::vector<Illuminant> illuminants_in(const std::string& text, const std::string& flag) {
    std::vector<Illuminant> illuminants;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
        const auto illuminant = illuminant_named(word);
        if (!illuminant)
            throw UsageError(fmt::format("{} {}: '{}' is not A, D50, D65, F11 or LED", flag, text, word));
        if (std::find(illuminants.begin(), illuminants.end(), *illuminant) == illuminants.end())
            illuminants.push_back(*illuminant);
    }
    if (illuminants.empty()) throw UsageError(fmt::format("{}: name a illuminant, as in D65,A,F11", flag));
    return illuminants;
}

}  // namespace tangi
