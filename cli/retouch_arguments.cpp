#include "cli/retouch_arguments.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "cli/command.h"

namespace tangi {

void PaintBoxArguments::add_to(Flags& flags) {
    flags.option("--palette", palette,
                 "palette file (.json, docs/paint.md) with the paints at hand; the built-in artist acrylics "
                 "without");
    flags.option("--lamps", lamps, "lamps that a match counts under: of A, D50, D65, F11, LED")
        .show_default();
    flags.option("--goal", goal, "what is made small: the worst or the mean difference under these lamps")
        .check(one_of({"worst", "mean"}))
        .show_default();
    flags.option(
        "--pairs", pairs,
        "list of pigments that are kept apart (.json, docs/colour-matching.md); a built-in one without");
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
    box.pairs = a.pairs.empty() ? usual_pigment_pairs() : read_pigment_pairs(a.pairs);
    box.warnings = pairs_to_avoid(box.palette.paints, box.pairs);
    return box;
}

void set_options(const PaintBoxArguments& a, const PaintBox& box, MatchOptions& options) {
    options.lamps = lamps_in(a.lamps, "--lamps");
    options.goal = a.goal == "mean" ? MatchGoal::mean : MatchGoal::worst;
    if (!a.avoid_pairs || box.warnings.empty()) return;
    const std::size_t n = box.palette.paints.size();
    options.allowed.assign(n * n, 1);
    for (const PairWarning& w : box.warnings) {
        const auto i = static_cast<std::size_t>(w.a), j = static_cast<std::size_t>(w.b);
        options.allowed[i * n + j] = options.allowed[j * n + i] = 0;
    }
}

std::vector<Illuminant> lamps_in(const std::string& text, const std::string& flag) {
    std::vector<Illuminant> lamps;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
        const auto lamp = illuminant_named(word);
        if (!lamp)
            throw UsageError(fmt::format("{} {}: '{}' is not A, D50, D65, F11 or LED", flag, text, word));
        if (std::find(lamps.begin(), lamps.end(), *lamp) == lamps.end()) lamps.push_back(*lamp);
    }
    if (lamps.empty()) throw UsageError(fmt::format("{}: name a lamp, as in D65,A,F11", flag));
    return lamps;
}

nlohmann::json by_lamp(const std::array<double, kIlluminants>& values) {
    nlohmann::json json = nlohmann::json::object();
    for (std::size_t lamp = 0; lamp < kIlluminants; ++lamp)
        if (std::isfinite(values[lamp]))
            json[std::string(name_of(static_cast<Illuminant>(lamp)))] = values[lamp];
    return json;
}

nlohmann::json as_json(const std::vector<MixingStep>& steps, const Mixture& mixture,
                       const std::vector<Pigment>& paints) {
    nlohmann::json volumes = nlohmann::json::object(), measured = nlohmann::json::array();
    for (std::size_t i = 0; i < static_cast<std::size_t>(mixture.count); ++i)
        volumes[paints[static_cast<std::size_t>(mixture.paints[i])].name] = mixture.volumes[i];
    for (const MixingStep& step : steps)
        measured.push_back({{"of_mixture", step.so_far},
                            {"paint", paints[static_cast<std::size_t>(step.paint)].name},
                            {"measures", step.added}});
    return {{"recipe", text_of(steps, paints)}, {"parts_by_volume", volumes}, {"steps", measured}};
}

nlohmann::json warnings_of(const Mixture& mixture, const PaintBox& box) {
    nlohmann::json texts = nlohmann::json::array();
    const auto begin = mixture.paints.begin(), end = begin + mixture.count;
    std::set<std::string> said;
    for (const PairWarning& w : box.warnings) {
        if (std::find(begin, end, w.a) == end || std::find(begin, end, w.b) == end) continue;
        const std::string text =
            fmt::format("{} with {}: {} ({})", box.palette.paints[static_cast<std::size_t>(w.a)].name,
                        box.palette.paints[static_cast<std::size_t>(w.b)].name, w.pair->why, w.pair->source);
        if (said.insert(text).second) texts.push_back(text);
    }
    for (auto it = begin; it != end; ++it)
        if (box.palette.paints[static_cast<std::size_t>(*it)].approximate())
            texts.push_back(fmt::format("{}: only its colour is known; its mixtures are a guess",
                                        box.palette.paints[static_cast<std::size_t>(*it)].name));
    return texts;
}

}  // namespace tangi
