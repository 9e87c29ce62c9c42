#include "capture/formats/lights_format.h"

#include <algorithm>
#include <array>

#include "capture/formats/dome_file.h"
#include "capture/formats/lights_file.h"
#include "capture/formats/relight_file.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

LightList bare_list(const fs::path& path) {
    LightsFile file = read_lights_file(path);
    return {.lights = std::move(file.lights),
            .warnings = std::move(file.warnings),
            .rejected = std::move(file.rejected),
            .lengths = std::move(file.lengths),
            .decimals = file.decimals};
}

LightList dome_list(const fs::path& path) {
    DomeFile dome = read_dome_file(path);
    return {.lights = std::move(dome.lights),
            .warnings = std::move(dome.warnings),
            .capture = CaptureFile(),
            .picture_width_mm = dome.picture_width_mm};
}

LightList relight_list(const fs::path& path) {
    RelightFile project = read_relight_file(path);
    CaptureFile capture;
    capture.mm_per_pixel = project.mm_per_pixel;
    return {.lights = std::move(project.lights),
            .warnings = std::move(project.warnings),
            .capture = std::move(capture),
            .picture_width_mm = project.picture_width_mm};
}

LightList capture_list(const fs::path& path) {
    CaptureFile capture = read_capture_file(path);
    return {.lights = capture.lights, .warnings = capture.warnings, .capture = std::move(capture)};
}

constexpr std::array kFormats = {
    LightsFormat{.name = "lights file",
                 .extension = ".lp",
                 .search = LightsSearch::first,
                 .bare_vectors = true,
                 .is_written = true,
                 .sniff = looks_like_lights,
                 .read = bare_list},
    LightsFormat{
        .name = "dome of Relight", .extension = ".dome", .sniff = looks_like_dome, .read = dome_list},
    LightsFormat{.name = "project of Relight",
                 .extension = ".relight",
                 .sniff = looks_like_relight,
                 .read = relight_list},
    LightsFormat{.name = "capture file",
                 .extension = ".json",
                 .search = LightsSearch::never,
                 .is_capture = true,
                 .shares_extension = true,
                 .is_written = true,
                 .sniff = looks_like_capture,
                 .read = capture_list},
};

bool sniffs(const LightsFormat& format, const fs::path& path) {
    std::error_code missing;
    return fs::is_regular_file(path, missing) && format.sniff(read_text_file(path));
}

}  // namespace

std::span<const LightsFormat> lights_formats() { return kFormats; }

const LightsFormat* lights_format_named(const fs::path& path) {
    const auto format = std::ranges::find(kFormats, lower_extension(path), &LightsFormat::extension);
    return format == kFormats.end() ? nullptr : &*format;
}

const LightsFormat& lights_format_of(const fs::path& path) {
    if (const LightsFormat* named = lights_format_named(path)) return *named;
    const auto format =
        std::ranges::find_if(kFormats, [&](const LightsFormat& f) { return sniffs(f, path); });
    return format == kFormats.end() ? *std::ranges::find_if(kFormats, &LightsFormat::bare_vectors) : *format;
}

bool is_lights_file(const fs::path& path) {
    const LightsFormat* format = lights_format_named(path);
    return format && (!format->shares_extension || sniffs(*format, path));
}

LightList read_lights(const fs::path& path) { return lights_format_of(path).read(path); }

std::string extensions_in_words(bool (*wanted)(const LightsFormat&)) {
    std::vector<std::string> all;
    for (const LightsFormat& format : kFormats)
        if (!wanted || wanted(format)) all.emplace_back(format.extension);
    std::string text;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i > 0) text += i + 1 < all.size() ? ", " : " or ";
        text += all[i];
    }
    return text;
}

}  // namespace tangi
