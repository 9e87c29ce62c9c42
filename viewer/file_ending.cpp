#include "viewer/file_ending.h"

#include <fmt/format.h>

#include "surface/picture_file.h"

namespace tangi {

namespace {

// One of "`.png .jpg`".
bool is_among(std::string_view ending, std::string_view endings) {
    while (!endings.empty()) {
        const auto blank = std::min(endings.find(' '), endings.size());
        if (endings.substr(0, blank) == ending) return true;
        endings.remove_prefix(std::min(blank + 1, endings.size()));
    }
    return false;
}

// Of files that the program reads or writes, and others that people mean when they type them.
constexpr std::string_view kKnown =
    ".exr .html .htm .pdf .png .jpg .jpeg .tif .tiff .tga .bmp .webp .hdr .ora .kra .psd .xcf .ptm .rti .mp4 "
    ".webm .mov .avi .mkv .json .jsonl .lp .csv .txt .zip .svg .gltf .glb .dng";

}  // namespace

NamedFile with_ending(const std::filesystem::path& typed, std::string_view endings) {
    std::filesystem::path path = typed;
    const std::string ending = lower_extension(path);
    if (!ending.empty() && is_among(ending, endings)) return {path, ""};
    const std::string first(endings.substr(0, endings.find(' ')));
    if (is_among(ending, kKnown))
        return {{}, fmt::format("is written as {}, not as {}: type another ending, or none", first, ending)};
    if (ending == ".") path.replace_extension();
    path += first;
    return {path, ""};
}

}  // namespace tangi
