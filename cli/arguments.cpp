#include "cli/arguments.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <glm/geometric.hpp>
#include <sstream>

#include "capture/formats/lights_format.h"
#include "capture/photo/raw_file.h"
#include "cli/command.h"
#include "retouch/treatment/treatment_folder.h"
#include "surface/base/error.h"
#include "surface/base/words.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_output.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace {

constexpr const char* kNoMask = "none";  // --mask

std::vector<double> numbers_of(const std::string& text, const std::string& flag, std::size_t count,
                               const std::string& form) {
    std::vector<double> numbers = numbers_in(text, flag, form);
    if (numbers.size() == count) return numbers;
    // "0,5,0,3,1" for 0.5, 0.3, 1: there are more numbers than wanted.
    throw UsageError(fmt::format("{} {}: expected {}{}", flag, text, form,
                                 numbers.size() > count
                                     ? fmt::format("; these are {} numbers: commas separate "
                                                   "them, so write 0.5 with a point",
                                                   numbers.size())
                                     : ""));
}

}  // namespace

std::vector<double> numbers_in(const std::string& text, const std::string& flag, const std::string& form) {
    std::vector<double> numbers;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) {
        const std::string word(without_blanks(part));
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        const bool is_number = end != word.c_str() && *end == '\0' && !std::isnan(value);
        // "inf" is no number that somebody means; 1e400 is one that is too large.
        if (!is_number || (std::isinf(value) && word.find_first_of("0123456789") == std::string::npos))
            throw UsageError(fmt::format("{} {}: '{}' is not a number; expected {}", flag, text, word, form));
        if (std::isinf(value)) throw UsageError(fmt::format("{} {}: '{}' is out of range", flag, text, word));
        numbers.push_back(value);
    }
    return numbers;
}

void DevelopArguments::add_to(Flags& flags) {
    flags.option("--dark", dark,
                 "dark frame to subtract: a picture taken with the lens covered, or a folder of such");
    flags.option("--flat", flat,
                 "flat field to divide by: a picture of an even white surface, or a folder of such");
    flags.option("--ambient", ambient,
                 "light of the room to subtract: a picture taken with the light off, or a folder of such");
    flags.option(
        "--brackets", brackets,
        "merge exposures of the same light: auto, for photographs NAME_1, NAME_2 … of the light NAME, or a "
        "JSON file {\"NAME\": [\"FILE\", …], …}");
    flags
        .option("--raw-demosaic", demosaic,
                "camera raw: how the colours that a pixel did not measure are filled in")
        .check(one_of(demosaic_methods()))
        .show_default();
    flags
        .option(
            "--raw-colour", raw_colour,
            "camera raw: rec709, by the camera's white balance and matrix; camera, as the sensor sees them")
        .check(one_of({"rec709", "camera"}))
        .show_default();
}

DevelopOptions DevelopArguments::options() const {
    DevelopOptions options;
    if (!dark.empty()) options.dark = dark;
    if (!flat.empty()) options.flat = flat;
    if (!ambient.empty()) options.ambient = ambient;
    if (!brackets.empty()) options.brackets = brackets;
    options.demosaic = demosaic;
    options.raw_colour = raw_colour == "camera" ? RawColour::camera : RawColour::rec709;
    return options;
}

std::vector<std::filesystem::path> DevelopArguments::inputs() const {
    std::vector<std::filesystem::path> files;
    if (!brackets.empty() && brackets != "auto") files.push_back(brackets);
    for (const std::string& frame : {dark, flat, ambient}) {
        if (frame.empty()) continue;
        if (!std::filesystem::is_directory(frame))
            files.push_back(frame);
        else
            for (const auto& entry : std::filesystem::directory_iterator(frame))
                files.push_back(entry.path());
    }
    return files;
}

std::optional<Transfer> parse_transfer(const std::string& text) {
    if (text == "auto") return {};
    const std::optional<Transfer> transfer = transfer_named(text);
    if (!transfer)
        throw UsageError(fmt::format(
            "--transfer {}: is not auto, linear, srgb, a gamma in [0.2, 5], or a curve that increases",
            text));
    return transfer;
}

// Where the lights were.
void PhotosArguments::add_light_flags(Flags& flags) {
    flags.option(
        "--lights", lights,
        fmt::format(
            "lights file ({}), or the capture.json of calibrate; where not given, the only one in the "
            "folder",
            extensions_in_words([](const LightsFormat& format) { return !format.is_capture; })));
    flags.flag(
        "--lights-mm", lights_mm,
        "the vectors of the .lp are the lights' positions in mm from the picture's centre (x right, y up, "
        "z towards the camera), not directions; --capture tells the scale");
    flags
        .option("--light-axes", light_axes,
                "how the axes of the .lp point, x right and y up: x,-y,z where y points down, as rows of a "
                "picture do; y,x,z where they are exchanged")
        .check([](const std::string& text) {
            return light_axes_of(text)
                       ? ""
                       : text + " is none of x,y,z with signs, x and y in either order, as x,-y,z";
        });
    flags
        .option("--light-rotation-deg", light_rotation_deg,
                "rotate the vectors of the .lp by so many degrees, counter-clockwise as the camera sees it: "
                "where the camera was turned against the lights")
        .check(within(-360, 360));
}

void PhotosArguments::add_fit_flags(Flags& flags) {
    flags
        .option("--register", registration,
                "auto: find out whether the camera moved between photographs, and undo it; off: take them "
                "as they are")
        .check(one_of({"auto", "off"}))
        .show_default();
    flags.option("--hold-out", hold_out,
                 "keep photographs from the fit, to compare with: positions from 0, START:STEP or names, "
                 "separated by commas");
}

void PhotosArguments::add_to(Flags& flags, bool for_fit) {
    flags.option("PHOTOS", folder, "folder of photographs, one for each light").required();
    add_light_flags(flags);
    flags.option(
        "--capture", capture,
        "capture.json of calibrate: colours, scale, lens, rectification, and the lights unless --lights "
        "tells them");
    flags
        .option(
            "--transfer", transfer,
            "how the photographs are encoded: auto, linear, srgb, a gamma such as 2.2, or a curve as `fit` "
            "reports it ('curve 2.2 -0.5 0.1')")
        .show_default();
    flags.option(
        "--crop", crop,
        "only a part of the photographs: X,Y,WIDTH,HEIGHT in pixels, of the rectified picture where a "
        "capture file rectifies");
    flags.option(
        "--mask", mask,
        "picture of the photographs' size; what is black in it is left out. Where not given, the black and "
        "white picture in the folder whose name says mask; none: the whole picture");
    develop.add_to(flags);
    if (for_fit) add_fit_flags(flags);
}

StackOptions PhotosArguments::options() const {
    StackOptions options;
    if (!lights.empty()) options.lights_file = lights;
    options.lights_in_mm = lights_mm;
    if (!capture.empty()) options.capture_file = capture;
    if (!mask.empty() && mask != kNoMask) options.mask_file = mask;
    if (!crop.empty()) {
        const auto n = numbers_of(crop, "--crop", 4, "X,Y,WIDTH,HEIGHT");
        const auto pixel = [&](double value) {
            if (value != std::floor(value) || std::abs(value) > 1e6)
                throw UsageError(fmt::format("--crop {}: pixels are whole numbers", crop));
            return static_cast<int>(value);
        };
        for (const std::size_t i : {0u, 1u})
            if (!(n[i] >= 0 && n[i + 2] >= 1))
                throw UsageError(fmt::format(
                    "--crop {}: is no part of a picture; X and Y are from 0, WIDTH and HEIGHT from 1", crop));
        options.crop = Region{pixel(n[0]), pixel(n[1]), pixel(n[0]) + pixel(n[2]), pixel(n[1]) + pixel(n[3])};
    }
    options.transfer = parse_transfer(transfer);
    options.develop = develop.options();
    return options;
}

UsableOptions PhotosArguments::usable_options() const {
    return {.finds_mask = mask.empty(), .light_axes = axes()};
}

Stack PhotosArguments::open_any() const {
    UsableOptions usable = usable_options();
    usable.any_loss = true;
    UsableStack opened = open_usable_stack(folder, options(), usable);
    opened.stack.warnings.insert(opened.stack.warnings.end(), opened.poor.begin(), opened.poor.end());
    return std::move(opened.stack);
}

UsableStack PhotosArguments::open() const {
    UsableStack opened = open_usable_stack(folder, options(), usable_options());
    if (hold_out.empty()) return opened;
    tangi::hold_out(opened.stack, hold_out);
    if (opened.stack.photos.empty())
        fail(
            "--hold-out {}: all {} photographs are held out, which leaves 0 usable photographs; at least 4 "
            "under different lights are needed",
            hold_out, opened.stack.held_out.size());
    return opened;
}

std::vector<std::filesystem::path> PhotosArguments::inputs(const Stack& stack) const {
    std::vector<std::filesystem::path> files;
    for (const auto* photos : {&stack.photos, &stack.held_out})
        for (const StackPhoto& photo : *photos) {
            if (photo.exposures.empty()) files.push_back(photo.path);
            for (const Exposure& exposure : photo.exposures) files.push_back(exposure.path);
        }
    if (!lights.empty()) files.push_back(lights);
    if (!capture.empty()) files.push_back(capture);
    if (!mask.empty() && mask != kNoMask) files.push_back(mask);
    for (const std::filesystem::path& file : develop.inputs()) files.push_back(file);
    return files;
}

LightAxes PhotosArguments::axes() const {
    LightAxes axes = light_axes_of(light_axes).value_or(LightAxes{});
    axes.rotation_deg = light_rotation_deg;
    return axes;
}

nlohmann::json PhotosArguments::as_json() const {
    const auto portable = [&](const std::string& file) { return portable_path(file, folder); };
    return {{"lights", portable(lights)},
            {"lights_mm", lights_mm},
            {"light_axes", light_axes},
            {"light_rotation_deg", light_rotation_deg},
            {"capture", portable(capture)},
            {"transfer", transfer},
            {"crop", crop},
            {"mask", mask == kNoMask ? mask : portable(mask)},
            {"hold_out", hold_out},
            {"register", registration},
            {"dark", portable(develop.dark)},
            {"flat", portable(develop.flat)},
            {"ambient", portable(develop.ambient)},
            {"brackets", develop.brackets == "auto" ? develop.brackets : portable(develop.brackets)},
            {"raw_demosaic", develop.demosaic},
            {"raw_colour", develop.raw_colour}};
}

void refuse_in_treatment(const std::filesystem::path& output) {
    if (const auto treatment = treatment_that_keeps(output))
        fail("{}: is a file that the treatment {} keeps by its log; choose another name or folder",
             output.string(), treatment->string());
}

void refuse_to_overwrite(const std::filesystem::path& output,
                         const std::vector<std::filesystem::path>& inputs, std::string_view flag) {
    refuse_in_treatment(output);
    std::error_code missing;  // what is not there cannot be lost
    const auto lies_in = [&](const std::filesystem::path& folder) {
        for (auto place = std::filesystem::absolute(output); place.has_relative_path();
             place = place.parent_path())
            if (std::filesystem::equivalent(place, folder, missing)) return true;
        return false;
    };
    for (const std::filesystem::path& input : inputs)
        if (std::filesystem::equivalent(output, input, missing) ||
            (is_tiled_painting(input) && lies_in(input)))
            fail("{} {}: would overwrite {}, from which it is made; choose another name or folder", flag,
                 output.string(), input.string());
}

namespace {

[[noreturn]] void refuse_ending(std::string_view flag, const std::string& file, std::string_view what) {
    throw UsageError(fmt::format("{} {}: {}; give it such an ending", flag, file, what));
}

}  // namespace

void require_ending(const std::string& file, std::initializer_list<std::string_view> endings,
                    std::string_view what, std::string_view flag) {
    if (std::ranges::find(endings, lower_extension(file)) == endings.end()) refuse_ending(flag, file, what);
}

void require_painting_ending(const std::string& file, std::string_view flag) {
    if (!names_painting(file)) refuse_ending(flag, file, "a painting is an .exr file, or a .tangi folder");
}

void require_picture_ending(const std::string& file, std::string_view flag) {
    try {
        require_picture_format(file);
    } catch (const Error& error) {
        throw UsageError(fmt::format("{} {}", flag, error.what()));
    }
}

void refuse_typed(const std::vector<std::string>& typed, std::initializer_list<std::string_view> flags,
                  const std::string& reason) {
    for (const std::string_view flag : flags)
        if (std::find(typed.begin(), typed.end(), flag) != typed.end())
            throw UsageError(fmt::format("{}: {}", flag, reason));
}

void require_writable_folder(const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    refuse_in_treatment(folder);
    fs::path there = fs::absolute(folder);
    while (!fs::exists(there) && there.has_relative_path()) there = there.parent_path();
    if (fs::is_directory(there) && ::access(there.c_str(), W_OK | X_OK) != 0)
        fail("--out {}: {} cannot be written: {}; choose a folder where you may write", folder.string(),
             there.string(), std::strerror(errno));
}

Vec3 parse_direction(const std::string& text, const std::string& flag) {
    const auto n = numbers_of(text, flag, 3, "X,Y,Z");
    const glm::dvec3 v(n[0], n[1], n[2]);
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0)) throw UsageError(fmt::format("{} {}: a direction cannot be zero", flag, text));
    const Vec3 direction(glm::normalize(v / largest));  // squares of huge or tiny numbers would be lost
    if (v.z != 0 && direction.z == 0)
        throw UsageError(fmt::format(
            "{} {}: its numbers are too far apart for one direction: beside the largest, z is nothing", flag,
            text));
    return direction;
}

Vec3 parse_direction_in_front(const std::string& text, const std::string& flag) {
    const Vec3 direction = parse_direction(text, flag);
    if (!(direction.z > 0))
        throw UsageError(fmt::format(
            "{} {}: comes from behind the painting; z is above 0, towards the viewer", flag, text));
    return direction;
}

Illuminant parse_illuminant(const std::string& word, const std::string& flag) {
    const auto illuminant = illuminant_named(word);
    if (!illuminant) throw UsageError(fmt::format("{} {}: is not A, D50, D65, F11 or LED", flag, word));
    return *illuminant;
}

Vec3 parse_position(const std::string& text, const std::string& flag) {
    constexpr double nearest_mm = 0.001, farthest_mm = 1e6;  // squares of which a float holds with ease
    const auto n = numbers_of(text, flag, 3, "X,Y,Z");
    if (!(n[2] >= nearest_mm))
        throw UsageError(
            fmt::format("{} {}: z must be positive, in front of the painting, and at least {} mm", flag, text,
                        nearest_mm));
    for (const double x : n)
        if (std::abs(x) > farthest_mm)
            throw UsageError(fmt::format(
                "{} {}: a position lies within {} mm (1 km); for a light farther away give its direction "
                "with --light",
                flag, text, farthest_mm));
    return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}

nlohmann::json told(const std::vector<std::string>& warnings, std::size_t before) {
    for (std::size_t i = before; i < warnings.size(); ++i) warn(warnings[i]);
    return warnings;
}

}  // namespace tangi
