#include "paint/optics/palette.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "paint/optics/artist_acrylics_json.h"
#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/words.h"
#include "surface/file/atomic_file.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr std::string_view kFormat = "tangipaint palette";
constexpr int kVersion = 1;
// The specular reflection of a surface of refractive index 1.5 at normal incidence, in measurements that
// include it.
constexpr float kSpecularReflection = 0.04f;
constexpr double kLargestCoefficient = 1e5;  // [1/mm]

// A value in a palette file, which knows where it is.
struct JsonPlace {
    const json& value;
    std::string where;  // "file.json: /paints/3"

    template <class... Args>
    [[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) const {
        const bool whole = where.ends_with(": ");  // no place in it
        fail("{}{}{}", where, whole ? "" : ": ", fmt::format(format, std::forward<Args>(args)...));
    }
    bool has(const char* key) const { return value.contains(key); }
    JsonPlace at(const char* key) const {
        if (!has(key)) refuse("has no \"{}\"", key);
        return {value[key], where + "/" + key};
    }
    JsonPlace at(std::size_t index) const { return {value[index], fmt::format("{}/{}", where, index)}; }

    std::string text() const {
        if (!value.is_string()) refuse("is {}, not a text in quotes", shown(value));
        return value.get<std::string>();
    }
    double number(double minimum, double maximum) const {
        if (!value.is_number()) refuse("is {}, not a number", shown(value));
        const double x = value.get<double>();
        if (!(x >= minimum && x <= maximum)) refuse("{} is outside of [{}, {}]", x, minimum, maximum);
        return x;
    }
    std::vector<double> numbers(double minimum, double maximum) const {
        if (!value.is_array()) refuse("is not a list of numbers in [ ]");
        std::vector<double> result;
        for (std::size_t i = 0; i < value.size(); ++i) result.push_back(at(i).number(minimum, maximum));
        return result;
    }
    void require_object() const {
        if (!value.is_object()) refuse("is not an object in {{ }}");
    }
    void allow_only(const std::set<std::string>& keys) const {
        for (const auto& [key, unused] : value.items())
            if (!keys.contains(key))
                refuse("has \"{}\", which means nothing here; there may be: {}", shortened(key),
                       fmt::join(keys, ", "));
    }
};

std::vector<double> wavelengths_at(const JsonPlace& place) {
    std::vector<double> nm = place.numbers(300, 900);
    if (nm.size() < 2)
        place.refuse("needs wavelengths from {} nm to {} nm", kBand_nm.front(), kBand_nm.back());
    for (std::size_t i = 1; i < nm.size(); ++i)
        if (!(nm[i] > nm[i - 1] && nm[i] <= nm[i - 1] + 50))
            place.at(i).refuse("{} nm after {} nm; wavelengths rise by 50 nm at most", nm[i], nm[i - 1]);
    if (nm.front() > static_cast<double>(kBand_nm.front()) ||
        nm.back() < static_cast<double>(kBand_nm.back()))
        place.refuse("covers {} to {} nm only; {} to {} nm are needed", nm.front(), nm.back(),
                     kBand_nm.front(), kBand_nm.back());
    return nm;
}

// A list over the wavelengths, interpolated linearly at the bands.
Spectrum spectrum_at(const JsonPlace& place, const std::vector<double>& nm, double maximum) {
    const std::vector<double> values = place.numbers(0, maximum);
    if (values.size() != nm.size())
        place.refuse("has {} numbers for {} wavelengths", values.size(), nm.size());
    Spectrum result;
    for (std::size_t band = 0; band < kBands; ++band) {
        const double target = kBand_nm[band];
        const auto above = std::lower_bound(nm.begin() + 1, nm.end() - 1, target);
        const auto i = static_cast<std::size_t>(above - nm.begin());
        const double t = (target - nm[i - 1]) / (nm[i] - nm[i - 1]);
        result[band] = static_cast<float>((1 - t) * values[i - 1] + t * values[i]);
    }
    return result;
}

Spectrum reflectance_at(const JsonPlace& paint, const char* key, const std::vector<double>& nm) {
    Spectrum reflectance = spectrum_at(paint.at(key), nm, 1);
    if (!paint.has("specular_included")) return reflectance;
    const JsonPlace included = paint.at("specular_included");
    if (!included.value.is_boolean()) included.refuse("is neither true nor false");
    if (!included.value.get<bool>()) return reflectance;
    for (float& r : reflectance) r = std::max(r - kSpecularReflection, 0.0f) / (1 - kSpecularReflection);
    return reflectance;
}

// "#8040c0" or three numbers from 0 to 255.
Rgb linear_at(const JsonPlace& place) {
    const Transfer srgb{Transfer::Kind::srgb};
    Rgb encoded;
    if (place.value.is_string()) {
        const std::string text = place.text();
        const bool hex = text.size() == 7 && text[0] == '#' &&
                         text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
        if (!hex)
            place.refuse("'{}' is no colour; write \"#rrggbb\" or [red, green, blue] from 0 to 255",
                         shortened(text));
        const int rgb = std::stoi(text.substr(1), nullptr, 16);
        encoded = Rgb(rgb >> 16, rgb >> 8 & 255, rgb & 255);
    } else {
        const std::vector<double> numbers = place.numbers(0, 255);
        if (numbers.size() != 3) place.refuse("has {} numbers; a colour has three", numbers.size());
        for (int c = 0; c < 3; ++c) encoded[c] = static_cast<float>(numbers[static_cast<std::size_t>(c)]);
        if (std::ranges::max(numbers) <= 1 &&
            std::ranges::any_of(numbers, [](double n) { return n != std::floor(n); }))
            place.refuse("[{}] are parts of 1, as it seems; write numbers from 0 to 255",
                         fmt::join(numbers, ", "));
    }
    Rgb linear;
    for (int c = 0; c < 3; ++c) linear[c] = std::min(srgb.decode(encoded[c] / 255), 1.0f);
    return linear;
}

float hiding_mm_at(const JsonPlace& paint) {
    return paint.has("hiding_mm") ? static_cast<float>(paint.at("hiding_mm").number(0.001, 10))
                                  : kHidingThickness_mm;
}

PigmentOrigin origin_at(const JsonPlace& paint) {
    if (!paint.has("origin")) return PigmentOrigin::measured;
    const JsonPlace place = paint.at("origin");
    std::vector<std::string_view> names;
    for (const auto origin : {PigmentOrigin::measured, PigmentOrigin::masstone_and_tint,
                              PigmentOrigin::masstone, PigmentOrigin::colour}) {
        names.push_back(name_of(origin));
        if (place.text() == names.back()) return origin;
    }
    place.refuse("'{}' is none of: {}", shortened(place.text()), fmt::join(names, ", "));
}

const Pigment& white_of(const JsonPlace& paint, const Palette& before) {
    const JsonPlace place = paint.at("white");
    const int index = before.find(place.text());
    if (index < 0)
        place.refuse("there is no paint '{}' before this one; put the white first", shortened(place.text()));
    return before.paints[static_cast<std::size_t>(index)];
}

Pigment pigment_at(const JsonPlace& paint, const std::string& name, const std::vector<double>& nm,
                   const Palette& before) {
    const std::set<std::string> common = {"name", "source", "specular", "roughness"};
    const auto allow = [&](std::set<std::string> keys) {
        keys.insert(common.begin(), common.end());
        paint.allow_only(keys);
    };
    if (paint.has("k_per_mm") || paint.has("s_per_mm")) {
        allow({"k_per_mm", "s_per_mm", "wavelengths_nm", "origin"});
        Pigment pigment;
        pigment.name = name;
        pigment.k = spectrum_at(paint.at("k_per_mm"), nm, kLargestCoefficient);
        pigment.s = spectrum_at(paint.at("s_per_mm"), nm, kLargestCoefficient);
        pigment.origin = origin_at(paint);
        return pigment;
    }
    if (paint.has("tint")) {
        allow({"masstone", "tint", "tint_concentration", "white", "wavelengths_nm", "specular_included"});
        const float concentration = static_cast<float>(paint.at("tint_concentration").number(0, 1));
        return pigment_of_tint(name, reflectance_at(paint, "masstone", nm), reflectance_at(paint, "tint", nm),
                               concentration, white_of(paint, before));
    }
    if (paint.has("masstone")) {
        allow({"masstone", "hiding_mm", "wavelengths_nm", "specular_included"});
        return pigment_of_masstone(name, reflectance_at(paint, "masstone", nm), hiding_mm_at(paint));
    }
    if (paint.has("srgb")) {
        allow({"srgb", "hiding_mm"});
        return pigment_of_rgb(name, linear_at(paint.at("srgb")), hiding_mm_at(paint));
    }
    std::string unknown;
    for (const auto& [key, value] : paint.value.items())
        if (!common.contains(key))
            unknown += fmt::format("{}'{}'", unknown.empty() ? "" : ", ", shortened(key));
    paint.refuse("'{}' has no colour: give k_per_mm and s_per_mm, masstone (with or without tint), or srgb{}",
                 shortened(name), unknown.empty() ? "" : fmt::format("; {} is none of these", unknown));
}

void add_paint(Palette& palette, const JsonPlace& paint, const std::vector<double>& nm) {
    paint.require_object();
    const JsonPlace name_place = paint.at("name");
    const std::string name = name_place.text();
    if (name.empty()) name_place.refuse("is empty");
    if (!is_one_line(name)) name_place.refuse("is to be in one line, without control characters");
    if (name.size() > kMostOfName)
        name_place.refuse("is a name of {} bytes; {} at most", name.size(), kMostOfName);
    if (palette.find(name) >= 0) name_place.refuse("there are two paints '{}'", shortened(name));
    const std::vector<double> own =
        paint.has("wavelengths_nm") ? wavelengths_at(paint.at("wavelengths_nm")) : std::vector<double>();
    Pigment pigment;
    try {
        pigment = pigment_at(paint, name, own.empty() ? nm : own, palette);
    } catch (const Error& error) {
        // What pigment_of_...() say has no place in the file yet.
        const std::string message = error.what();
        if (message.starts_with(paint.where)) throw;
        paint.refuse("{}", message);
    }
    for (std::size_t band = 0; band < kBands; ++band)
        if (!(pigment.k[band] <= kLargestCoefficient && pigment.s[band] <= kLargestCoefficient))
            paint.refuse("no paint looks like that: at {} nm it would have K = {} and S = {} per mm",
                         kBand_nm[band], pigment.k[band], pigment.s[band]);
    if (paint.has("source")) pigment.source = paint.at("source").text();
    if (pigment.source.empty()) pigment.source = palette.source;
    if (paint.has("specular")) pigment.specular = static_cast<float>(paint.at("specular").number(0, 1));
    if (paint.has("roughness")) pigment.roughness = static_cast<float>(paint.at("roughness").number(1e-4, 1));
    if (name == kClearMedium && !is_clear(pigment))
        name_place.refuse("is what medium without pigment is counted as; give it another name");
    palette.paints.push_back(std::move(pigment));
}

std::string listed(const Spectrum& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }

}  // namespace

int Palette::find(std::string_view paint) const {
    const std::string wanted = lower_case(paint);
    for (std::size_t i = 0; i < paints.size(); ++i)
        if (lower_case(paints[i].name) == wanted) return static_cast<int>(i);
    return -1;
}

const Pigment& Palette::at(std::string_view paint) const {
    const int index = find(paint);
    if (index >= 0) return paints[static_cast<std::size_t>(index)];
    std::vector<std::string> names;
    for (const Pigment& pigment : paints) names.push_back(pigment.name);
    fail("palette '{}' has no paint '{}'; name one that it has, or give a palette that has it: {}",
         shortened(name), shortened(paint), shortened(fmt::format("{}", fmt::join(names, ", ")), 2000));
}

Palette parse_palette(std::string_view text, const std::string& where) {
    const json document = read_json(text, where);
    const JsonPlace root{document, where + ": "};
    root.require_object();
    if (!root.has("format") || document["format"] != kFormat)
        fail("{}: is no palette: a palette file has \"format\": \"{}\"", where, kFormat);
    const JsonPlace version = root.at("version");
    if (!version.value.is_number_integer())
        version.refuse("is {}, not the whole number {}",
                       version.value.is_number_float() ? json_line(version.value) : shown(version.value),
                       kVersion);
    if (version.value != kVersion)
        version.refuse("is {}, but this program reads version {}{}", shown(version.value), kVersion,
                       version.value > kVersion ? "; the file was made by a newer one" : "");
    root.allow_only({"format", "version", "name", "source", "wavelengths_nm", "paints"});

    Palette palette;
    palette.name = root.at("name").text();
    if (root.has("source")) palette.source = root.at("source").text();
    const std::vector<double> nm = root.has("wavelengths_nm")
                                       ? wavelengths_at(root.at("wavelengths_nm"))
                                       : std::vector<double>(kBand_nm.begin(), kBand_nm.end());
    const JsonPlace paints = root.at("paints");
    if (!paints.value.is_array()) paints.refuse("is not a list of paints in [ ]");
    if (paints.value.empty()) paints.refuse("is an empty list; a palette has one paint at least");
    for (std::size_t i = 0; i < paints.value.size(); ++i) add_paint(palette, paints.at(i), nm);
    return palette;
}

std::string palette_text(const Palette& palette) {
    const auto quoted = [](std::string_view text) { return json_line(json(text)); };
    std::string text = fmt::format(
        "{{\n  \"format\": {},\n  \"version\": {},\n  \"name\": {},\n  \"source\": {},\n  "
        "\"wavelengths_nm\": {},\n"
        "  \"paints\": [",
        quoted(kFormat), kVersion, quoted(palette.name), quoted(palette.source), listed(kBand_nm));
    const char* separator = "\n";
    for (const Pigment& paint : palette.paints) {
        text += separator;
        text += fmt::format("    {{\"name\": {},", quoted(paint.name));
        if (!paint.source.empty() && paint.source != palette.source)
            text += fmt::format(" \"source\": {},", quoted(paint.source));
        text += fmt::format(" \"origin\": {}, \"specular\": {}, \"roughness\": {},\n",
                            quoted(name_of(paint.origin)), paint.specular, paint.roughness);
        text +=
            fmt::format("     \"k_per_mm\": {},\n     \"s_per_mm\": {}}}", listed(paint.k), listed(paint.s));
        separator = ",\n";
    }
    return text + "\n  ]\n}\n";
}

Palette read_palette(const std::filesystem::path& path) {
    return parse_palette(read_text_file(path), path.string());
}

void write_palette(const std::filesystem::path& path, const Palette& palette) {
    write_text_file(path, palette_text(palette));
}

const Palette& artist_acrylics() {
    static const Palette palette = parse_palette(kArtistAcrylicsJson, "artist_acrylics.json");
    return palette;
}

}  // namespace tangi
