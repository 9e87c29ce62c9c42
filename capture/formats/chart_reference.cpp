// chart_reference.cpp: the classic values, and files with others.
#include "capture/formats/chart_reference.h"

#include <charconv>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

using nlohmann::json;

namespace {

struct Published {
    const char* name;
    Lab lab_d50;
};

constexpr Published kClassic[kChartPatches] = {{"dark skin", {37.986, 13.555, 14.059}},
                                               {"light skin", {65.711, 18.13, 17.81}},
                                               {"blue sky", {49.927, -4.88, -21.925}},
                                               {"foliage", {43.139, -13.095, 21.905}},
                                               {"blue flower", {55.112, 8.844, -25.399}},
                                               {"bluish green", {70.719, -33.397, -0.199}},
                                               {"orange", {62.661, 36.067, 57.096}},
                                               {"purplish blue", {40.02, 10.41, -45.964}},
                                               {"moderate red", {51.124, 48.239, 16.248}},
                                               {"purple", {30.325, 22.976, -21.587}},
                                               {"yellow green", {72.532, -23.709, 57.255}},
                                               {"orange yellow", {71.941, 19.363, 67.857}},
                                               {"blue", {28.778, 14.179, -50.297}},
                                               {"green", {55.261, -38.342, 31.37}},
                                               {"red", {42.101, 53.378, 28.19}},
                                               {"yellow", {81.733, 4.039, 79.819}},
                                               {"magenta", {51.935, 49.986, -14.574}},
                                               {"cyan", {51.038, -28.631, -28.638}},
                                               {"white 9.5", {96.539, -0.425, 1.186}},
                                               {"neutral 8", {81.257, -0.638, -0.335}},
                                               {"neutral 6.5", {66.766, -0.734, -0.504}},
                                               {"neutral 5", {50.867, -0.153, -0.27}},
                                               {"neutral 3.5", {35.656, -0.421, -1.231}},
                                               {"black 2", {20.461, -0.079, -0.973}}};

std::string text_of(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        fail("{}: cannot be read; give a .csv or .json file with the values of the chart", path.string());
    return read_text_file(path);
}

// Far outside of what a surface can reflect: percent instead of parts, or columns in another order.
void require_plausible(const Rgb& linear, const std::string& where) {
    for (int k = 0; k < 3; ++k)
        if (!(linear[k] > -0.3f && linear[k] < 1.5f))
            fail("{}: ({:.3g}, {:.3g}, {:.3g}) is no linear reflectance 0..1; L*a*b* is 0..100 and for D50",
                 where, linear.r, linear.g, linear.b);
}

std::vector<std::string> fields_of(std::string line) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) {
        const auto first = field.find_first_not_of(" \t\""), last = field.find_last_not_of(" \t\"");
        fields.push_back(first == std::string::npos ? "" : field.substr(first, last - first + 1));
    }
    return fields;
}

ChartReference read_csv(const std::filesystem::path& path) {
    ChartReference reference{{}, path.filename().string()};
    std::istringstream lines(text_of(path));
    int number = 0, patch = 0;
    bool is_lab = false;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const std::vector<std::string> fields = fields_of(line);
        if (fields.empty() || (fields.size() == 1 && fields[0].empty())) continue;
        const std::string where = fmt::format("{}:{}", path.string(), number);
        if (number == 1) {
            const bool four = fields.size() == 4 && fields[0] == "name";
            is_lab = four && fields[1] == "L" && fields[2] == "a" && fields[3] == "b";
            if (!is_lab && !(four && fields[1] == "R" && fields[2] == "G" && fields[3] == "B"))
                fail(
                    "{}: begins with '{}'; the first line must be 'name,L,a,b' (D50) or 'name,R,G,B' "
                    "(linear)",
                    where, shortened(line));
            continue;
        }
        if (fields.size() != 4)
            fail("{}: has {} fields instead of a name and three numbers", where, fields.size());
        if (patch == kChartPatches) fail("{}: is a patch too many; the chart has {}", where, kChartPatches);
        double value[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string& field = fields[k + 1];
            const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value[k]);
            if (status != std::errc() || end != field.data() + field.size())
                fail("{}: '{}' is not a number", where, shortened(field));
        }
        const Rgb linear = is_lab ? linear_from_lab_d50({value[0], value[1], value[2]})
                                  : Rgb(glm::dvec3(value[0], value[1], value[2]));
        require_plausible(linear, where);
        reference.patches[static_cast<std::size_t>(patch++)] = {fields[0], linear};
    }
    if (patch != kChartPatches)
        fail("{}: ends after {} patches; the chart has {}", path.string(), patch, kChartPatches);
    return reference;
}

glm::dvec3 three_numbers(const json& list, const std::string& where) {
    if (!list.is_array() || list.size() != 3 || !list[0].is_number() || !list[1].is_number() ||
        !list[2].is_number())
        fail("{}: is not a list of three numbers", where);
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

ChartReference read_json_chart(const std::filesystem::path& path) {
    const json list = read_json(text_of(path), path.string());
    if (!list.is_array() || list.size() != kChartPatches)
        fail("{}: is not a JSON list of {} patches", path.string(), kChartPatches);
    ChartReference reference{{}, path.filename().string()};
    std::array<bool, kChartPatches> seen{};
    for (std::size_t i = 0; i < list.size(); ++i) {
        const json& entry = list[i];
        const std::string where = fmt::format("{}: patch {}", path.string(), i + 1);
        if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
            fail("{}: has no name", where);
        std::size_t at = i;
        if (entry.contains("n")) {
            const long long n = entry["n"].is_number_integer() ? entry["n"].get<long long>() : 0;
            if (n < 1 || n > kChartPatches) fail("{}: its number n is not 1..{}", where, kChartPatches);
            at = static_cast<std::size_t>(n - 1);
        }
        if (seen[at]) fail("{}: number {} is there twice", where, at + 1);
        seen[at] = true;
        Rgb linear;
        if (entry.contains("linear_srgb")) {
            linear = Rgb(three_numbers(entry["linear_srgb"], where + ": linear_srgb"));
        } else if (entry.contains("lab_d50")) {
            const glm::dvec3 lab = three_numbers(entry["lab_d50"], where + ": lab_d50");
            linear = linear_from_lab_d50({lab.x, lab.y, lab.z});
        } else {
            fail("{}: has neither linear_srgb nor lab_d50", where);
        }
        require_plausible(linear, where);
        reference.patches[at] = {entry["name"].get<std::string>(), linear};
    }
    return reference;
}

}  // namespace

ChartReference classic_chart() {
    ChartReference reference{{}, "classic chart before November 2014 (GretagMacbeth 2005)"};
    for (std::size_t i = 0; i < kChartPatches; ++i)
        reference.patches[i] = {kClassic[i].name, linear_from_lab_d50(kClassic[i].lab_d50)};
    return reference;
}

ChartReference read_chart_reference(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    if (extension == ".csv") return read_csv(path);
    if (extension == ".json") return read_json_chart(path);
    fail("{}: the values of a chart are read from .csv or .json files", path.string());
}

}  // namespace tangi
