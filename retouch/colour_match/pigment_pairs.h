// pigment_pairs.h: pigments that practice keeps apart, as a list that the user can edit.
//
// JSON: {"format": "tangipaint pigment pairs", "version": 1, "pairs": [{"first": ["azurite", "PB30"],
// "second": ["cadmium"], "why": "…", "source": "…"}]}. Words are looked for in the names of paints,
// and in a source that is one paint's own, in any case, whole words only; "PB30" finds "P.B. 30" too.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "paint/optics/pigment.h"

namespace tangi {

struct PigmentPair {
    std::vector<std::string> first, second;
    std::string why, source;
};

// The built-in list (pigment_pairs.json, with its literature), and its text.
const std::vector<PigmentPair>& usual_pigment_pairs();
std::string_view usual_pigment_pairs_text();

// Errors name the file and the place in it ("/pairs/3/first").
std::vector<PigmentPair> read_pigment_pairs(const std::filesystem::path& path);
void write_pigment_pairs(const std::filesystem::path& path, const std::vector<PigmentPair>& pairs);
std::vector<PigmentPair> parse_pigment_pairs(std::string_view text, const std::string& where);

struct PairWarning {
    int a = 0, b = 0;  // paints of the box
    const PigmentPair* pair = nullptr;
};
// All pairs of paints that the list keeps apart; the list must outlive them.
std::vector<PairWarning> pairs_to_avoid(const std::vector<Pigment>& paints,
                                        const std::vector<PigmentPair>& pairs);

// True where one of the words occurs in the paint's name or, by choice, in its source.
bool is_named(const Pigment& paint, const std::vector<std::string>& words, bool by_source = true);

}  // namespace tangi
