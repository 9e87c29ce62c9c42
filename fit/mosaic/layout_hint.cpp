#include "fit/mosaic/layout_hint.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

using Places = std::map<std::string, glm::dvec2>;

constexpr double kNeighbour = 1.5;  // [steps] those across a corner are beside each other, too

void add(Places& places, const std::string& name, const glm::dvec2& place, const std::string& where) {
    if (!places.emplace(name, place).second) fail("{}: {} is there twice; leave out one", where, name);
}

Places places_of_json(const std::string& text, const std::string& file) {
    const nlohmann::json json = read_json(text, file);
    Places places;
    try {
        for (const nlohmann::json& p : json.at("positions"))
            add(places, p.at("name").get<std::string>(),
                {p.at("column").get<double>(), p.at("row").get<double>()}, file);
    } catch (const nlohmann::json::exception& error) {
        fail("{}: {}; a layout is {{\"positions\": [{{\"name\", \"column\", \"row\"}}, …]}}", file,
             why_wrong_field(error));
    }
    return places;
}

std::string trimmed(const std::string& text) {
    const auto begin = text.find_first_not_of(" \t\r\""), end = text.find_last_not_of(" \t\r\"");
    return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

std::optional<double> number_in(const std::string& text) {
    double value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || rest != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

Places places_of_csv(const std::string& text, const std::string& file) {
    Places places;
    std::size_t begin = 0;
    for (int line = 1; begin < text.size(); ++line) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::vector<std::string> fields(1);
        for (const char c : text.substr(begin, end - begin))
            if (c == ',' || c == ';')
                fields.emplace_back();
            else
                fields.back() += c;
        begin = end + 1;
        for (std::string& field : fields) field = trimmed(field);
        if (fields.size() == 1 && fields[0].empty()) continue;
        const std::string where = fmt::format("{}, line {}", file, line);
        if (fields.size() != 3)
            fail("{}: has {} columns; give three, name, column, row", where, fields.size());
        const auto column = number_in(fields[1]), row = number_in(fields[2]);
        if (line == 1 && !column && !row) continue;  // a title
        if (!column || !row)
            fail("{}: {} is no number; give name, column, row", where,
                 shortened(column ? fields[2] : fields[1]));
        add(places, fields[0], {*column, *row}, where);
    }
    return places;
}

}  // namespace

bool LayoutHint::may_overlap(std::size_t a, std::size_t b) const {
    const glm::dvec2 off = glm::abs(places[a] - places[b]);
    return std::max(off.x, off.y) < kNeighbour;
}

LayoutHint read_layout_hint(const std::filesystem::path& path, const std::vector<std::string>& names) {
    const std::string text = read_text_file(path), file = path.string();
    const auto first = text.find_first_not_of(" \t\r\n");
    const bool is_json = first != std::string::npos && text[first] == '{';
    const Places places = is_json ? places_of_json(text, file) : places_of_csv(text, file);
    LayoutHint hint;
    for (const std::string& name : names) {
        const auto place = places.find(name);
        if (place == places.end())
            fail("{}: has no position {}; name each with its column and row", file, name);
        hint.places.push_back(place->second);
    }
    return hint;
}

std::optional<LayoutHint> layout_hint_of(const std::vector<std::string>& names) {
    LayoutHint hint;
    std::set<std::pair<double, double>> taken;
    for (const std::string& name : names) {
        std::vector<double> numbers;
        for (std::size_t at = 0; at < name.size();) {
            const std::size_t begin = name.find_first_of("0123456789", at);
            if (begin == std::string::npos) break;
            at = std::min(name.find_first_not_of("0123456789", begin), name.size());
            numbers.push_back(*number_in(name.substr(begin, at - begin)));
        }
        if (numbers.size() < 2) return std::nullopt;
        const double row = numbers[numbers.size() - 2], column = numbers.back();
        if (!taken.insert({row, column}).second) return std::nullopt;
        hint.places.emplace_back(column, row);
    }
    return hint;
}

}  // namespace tangi
