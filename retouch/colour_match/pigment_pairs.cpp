#include "retouch/colour_match/pigment_pairs.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "retouch/colour_match/pigment_pairs_json.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Lower case, one space between words and around them, none within colour index names: " p.b. 30 " and
// " pb30 " are " pb30 ".
std::string plain(std::string_view text) {
    std::string words = " ";
    for (char c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '.' || c == '\'') continue;
        const bool counts = is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 0x80;
        if (counts)
            words += c;
        else if (words.back() != ' ')
            words += ' ';
    }
    if (words.back() != ' ') words += ' ';
    std::string joined;
    for (std::size_t i = 0; i < words.size(); ++i) {
        // A space between the letters of a colour index name (p and one or two more) and its number.
        const bool number_follows = words[i] == ' ' && i + 1 < words.size() && is_digit(words[i + 1]);
        const auto start = joined.rfind(' ');
        const std::string last = start == std::string::npos ? "" : joined.substr(start + 1);
        if (number_follows && (last.size() == 2 || last.size() == 3) && (last[0] == 'p' || last[0] == 'n') &&
            std::all_of(last.begin(), last.end(), is_letter))
            continue;
        joined += words[i];
    }
    return joined;
}

std::vector<std::string> words_at(const nlohmann::json& pair, const char* key, const std::string& where) {
    const auto found = pair.find(key);
    if (found == pair.end() || !found->is_array() || found->empty())
        fail("{}/{}: is not a list of words that occur in names of paints", where, key);
    std::vector<std::string> words;
    for (const auto& word : *found) {
        if (!word.is_string() || plain(word.get<std::string>()) == " ")
            fail("{}/{}/{}: is not a word", where, key, words.size());
        words.push_back(word.get<std::string>());
    }
    return words;
}

}  // namespace

std::vector<PigmentPair> parse_pigment_pairs(std::string_view text, const std::string& where) {
    const nlohmann::json root = read_json(text, where);
    if (!root.is_object() || root.value("format", nlohmann::json()) != "tangipaint pigment pairs" ||
        root.value("version", nlohmann::json()) != 1)
        fail("{}: is no list of pigment pairs of version 1; match --save-pairs writes one to start from",
             where);
    if (!root.contains("pairs") || !root["pairs"].is_array()) fail("{}: /pairs is not a list", where);
    for (const auto& [key, value] : root.items())
        if (key != "format" && key != "version" && key != "pairs")
            fail("{}: /{} means nothing", where, shortened(key));
    std::vector<PigmentPair> pairs;
    for (const auto& pair : root["pairs"]) {
        const std::string place = fmt::format("{}: /pairs/{}", where, pairs.size());
        if (!pair.is_object()) fail("{}: is not an object", place);
        for (const auto& [key, value] : pair.items()) {
            if (key != "first" && key != "second" && key != "why" && key != "source")
                fail("{}/{}: means nothing; there are first, second, why and source", place, shortened(key));
            if ((key == "why" || key == "source") && !value.is_string())
                fail("{}/{}: is no text", place, key);
        }
        pairs.push_back({words_at(pair, "first", place), words_at(pair, "second", place),
                         pair.value("why", ""), pair.value("source", "")});
    }
    return pairs;
}

std::vector<PigmentPair> read_pigment_pairs(const std::filesystem::path& path) {
    return parse_pigment_pairs(read_text_file(path), path.string());
}

void write_pigment_pairs(const std::filesystem::path& path, const std::vector<PigmentPair>& pairs) {
    nlohmann::ordered_json root = {
        {"format", "tangipaint pigment pairs"}, {"version", 1}, {"pairs", nlohmann::ordered_json::array()}};
    for (const PigmentPair& pair : pairs)
        root["pairs"].push_back(
            {{"first", pair.first}, {"second", pair.second}, {"why", pair.why}, {"source", pair.source}});
    write_text_file(path, json_lines(root));
}

std::string_view usual_pigment_pairs_text() { return kPigmentPairsJson; }

const std::vector<PigmentPair>& usual_pigment_pairs() {
    static const auto pairs = parse_pigment_pairs(kPigmentPairsJson, "built-in pigment pairs");
    return pairs;
}

bool is_named(const Pigment& paint, const std::vector<std::string>& words, bool by_source) {
    const std::string name = plain(paint.name), source = by_source ? plain(paint.source) : " ";
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        const std::string wanted = plain(word);
        return name.find(wanted) != std::string::npos || source.find(wanted) != std::string::npos;
    });
}

std::vector<PairWarning> pairs_to_avoid(const std::vector<Pigment>& paints,
                                        const std::vector<PigmentPair>& pairs) {
    // A source that several paints share is their palette's, and names none of them.
    std::map<std::string_view, int> of_source;
    for (const Pigment& paint : paints) ++of_source[paint.source];
    const auto named = [&](int i, const std::vector<std::string>& words) {
        const Pigment& paint = paints[static_cast<std::size_t>(i)];
        return is_named(paint, words, of_source[paint.source] == 1);
    };
    std::vector<PairWarning> warnings;
    const int count = static_cast<int>(paints.size());
    for (const PigmentPair& pair : pairs)
        for (int a = 0; a < count; ++a) {
            if (!named(a, pair.first)) continue;
            for (int b = 0; b < count; ++b)
                if (a != b && named(b, pair.second)) warnings.push_back({a, b, &pair});
        }
    return warnings;
}

}  // namespace tangi
