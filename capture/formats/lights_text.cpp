#include "capture/formats/lights_text.h"

#include <utf8proc.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "capture/photo/photo_file.h"
#include "capture/photo/photo_names.h"
#include "surface/base/error.h"
#include "surface/base/words.h"

namespace tangi {

namespace {

constexpr std::string_view kBetweenColumns = " \t\r";

bool is_number_text(std::string_view word) {
    std::string text(word);
    std::replace(text.begin(), text.end(), ',', '.');
    if (text.starts_with('+')) text.erase(0, 1);
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    return !text.empty() && end == text.data() + text.size() && status != std::errc::invalid_argument;
}

std::vector<std::string_view> columns_of(std::string_view line, char separator) {
    std::vector<std::string_view> columns;
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t to = std::min(line.find(separator, from), line.size());
        columns.push_back(without_blanks(line.substr(from, to - from)));
        from = to + 1;
    }
    return columns;
}

// The line with blanks between its columns, where it has a name and at least three numbers; else nothing. By
// commas it must have no more than a decimal comma would leave: a name, and numbers with points.
std::string separated_by_blanks(std::string_view line, char separator) {
    const std::vector<std::string_view> columns = columns_of(line, separator);
    const std::size_t count = columns.size();
    if ((count != 4 && count != 5 && count != 7) || columns.front().empty()) return {};
    std::string text(columns.front());
    for (std::size_t k = 1; k < count; ++k) {
        if (!is_number_text(columns[k])) return {};
        text += fmt::format(" {}", columns[k]);
    }
    return text;
}

// Tables that spreadsheets write: where all lines but a title, and the count, are separated so.
void read_as_table(std::vector<LightsLine>& lines, const std::string& file_name,
                   std::vector<std::string>& warnings) {
    for (const char separator : {';', ','}) {
        std::vector<LightsLine> table;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            if (i == 0 && is_number_text(lines[i].text)) {
                table.push_back(lines[i]);
                continue;
            }
            std::string text = separated_by_blanks(lines[i].text, separator);
            if (!text.empty())
                table.push_back({lines[i].number, std::move(text)});
            else if (i > 0 || columns_of(lines[i].text, separator).size() < 4)
                break;  // a title may stand first
            if (i + 1 < lines.size()) continue;
            if (table.empty()) break;
            warnings.push_back(fmt::format("{}: its columns are separated by {}, and read so", file_name,
                                           separator == ';' ? "semicolons" : "commas"));
            lines = std::move(table);
            return;
        }
    }
}

// Numbers at the end of a line after a name with a picture's extension; 0 where there is no such name.
std::size_t numbers_after_name(std::string_view line, std::size_t& name_end) {
    std::size_t numbers = 0;
    std::string_view rest = without_blanks(line);
    while (true) {
        const std::size_t blank = rest.find_last_of(kBetweenColumns);
        if (blank == std::string_view::npos) return 0;
        if (!is_number_text(rest.substr(blank + 1))) return 0;
        rest = without_blanks(rest.substr(0, blank));
        ++numbers;
        std::string_view name = rest;
        if (name.size() > 2 && name.front() == '"' && name.back() == '"')
            name = name.substr(1, name.size() - 2);
        if (numbers >= 3 && is_photo_name(portable(std::string(name)))) {
            name_end = rest.size();
            return numbers;
        }
    }
}

// An intensity, or a colour, after z: read from the right they would be taken for the direction.
void cut_further_columns(std::vector<LightsLine>& lines, const std::string& file_name,
                         std::vector<std::string>& warnings) {
    std::size_t columns = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        std::size_t name_end = 0;
        const std::size_t here = numbers_after_name(lines[i].text, name_end);
        if (here == 0 && i == 0) continue;  // the count
        if ((here != 4 && here != 6) || (columns > 0 && here != columns)) return;
        columns = here;
    }
    if (columns == 0) return;
    for (LightsLine& line : lines) {
        std::size_t name_end = 0;
        if (numbers_after_name(line.text, name_end) == 0) continue;
        for (std::size_t cut = columns - 3; cut > 0; --cut)
            line.text = without_blanks(line.text.substr(0, line.text.find_last_of(kBetweenColumns)));
    }
    warnings.push_back(
        fmt::format("{}: has {} numbers after each name; the first three are the light's x, y and z, and {} "
                    "not used, since "
                    "the photographs tell how strong lights are",
                    file_name, columns,
                    columns == 4 ? "the fourth (its intensity?) is" : "the others (its colour?) are"));
}

bool is_utf8(std::string_view text) {
    const auto* at = reinterpret_cast<const utf8proc_uint8_t*>(text.data());
    for (auto left = static_cast<utf8proc_ssize_t>(text.size()); left > 0;) {
        utf8proc_int32_t letter = 0;
        const utf8proc_ssize_t length = utf8proc_iterate(at, left, &letter);
        if (length <= 0) return false;
        at += length, left -= length;
    }
    return true;
}

}  // namespace

std::vector<LightsLine> lines_of_lights(std::string text, const std::string& file_name,
                                        std::vector<std::string>& warnings) {
    if (!is_utf8(text))
        warnings.push_back(fmt::format(
            "{}: is not UTF-8; its names are compared with those of files as Latin-1", file_name));
    std::istringstream stream(std::move(text));
    std::vector<LightsLine> lines;
    std::vector<int> commented_out;
    int number = 0;
    for (std::string raw; std::getline(stream, raw);) {
        ++number;
        const std::string_view line = without_blanks(raw);
        if (line.empty()) continue;
        std::size_t name_end = 0;
        if (line.front() != '#' && line.front() != ';')
            lines.push_back({number, std::string(line)});
        else if (numbers_after_name(line, name_end) > 0)
            commented_out.push_back(number);
    }
    if (!commented_out.empty())
        warnings.push_back(
            fmt::format("{}, line {}: begins with # or ;, which makes the light in it a comment{}", file_name,
                        commented_out.front(),
                        commented_out.size() == 1 ? std::string()
                                                  : fmt::format(" (so do {} lines)", commented_out.size())));
    read_as_table(lines, file_name, warnings);
    cut_further_columns(lines, file_name, warnings);
    return lines;
}

std::string decode_vectors(std::vector<glm::dvec3>& vectors, const std::string& file_name) {
    constexpr std::size_t fewest = 4;  // that are unit vectors by more than chance
    if (vectors.size() < fewest) return {};
    const auto all = [&](auto is) { return std::all_of(vectors.begin(), vectors.end(), is); };
    // Three times what rounding to 8 bits makes of a length (half a code in each of three components).
    constexpr double rounding = 0.02;
    const auto is_unit = [](const glm::dvec3& v) { return std::abs(glm::length(v) - 1) < rounding; };
    if (all(is_unit)) return {};
    for (const double full : {1.0, 255.0, 65535.0}) {
        const auto decoded = [&](const glm::dvec3& v) { return 2.0 / full * v - 1.0; };
        if (!all([&](const glm::dvec3& v) {
                return std::min({v.x, v.y, v.z}) >= 0 && std::max({v.x, v.y, v.z}) <= full &&
                       is_unit(decoded(v));
            }))
            continue;
        for (glm::dvec3& v : vectors) v = glm::normalize(decoded(v));
        return fmt::format(
            "{}: its components run from 0 to {:.0f}, as normal maps store them from -1 to 1, and are read "
            "so",
            file_name, full);
    }
    // No light of a stack stands lower than this throughout, nor 1 mm above a painting.
    constexpr double grazing = 10;  // [1] x and y by z: 6 degrees above the picture
    constexpr double same = 1e-4;   // [1] floats of hundreds are that exact
    const double third = std::round(vectors.front().z);
    const bool is_angles =
        (third == 1 || third == 0) && all([&](const glm::dvec3& v) {
            return std::abs(v.z - third) < same && std::abs(v.x) <= 360 && v.y >= 0 && v.y <= 90;
        });
    double farthest = 0;
    for (const glm::dvec3& v : vectors) farthest = std::max(farthest, std::hypot(v.x, v.y));
    if (is_angles && farthest > grazing)
        fail(
            "{}: its numbers seem to be azimuth and elevation in degrees (the third is {:.0f} throughout); "
            "give x = cos(elevation) cos(azimuth), y = cos(elevation) sin(azimuth), z = sin(elevation)",
            file_name, third);
    return {};
}

}  // namespace tangi
