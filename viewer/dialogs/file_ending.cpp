#include "viewer/dialogs/file_ending.h"

#include <fmt/format.h>

#include <cstdlib>

#include "surface/file/file_name.h"
#include "surface/image_file/image_io.h"

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

namespace fs = std::filesystem;

std::string_view without_blanks_at_ends(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r\n";
    const auto begin = text.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

// An ending with nothing before it, or dots: a file of that name would be hidden.
bool is_no_name(const std::string& name, std::string_view endings) {
    const std::string ending = name.starts_with('.') ? lower_extension("x" + name) : "";
    return name.find_first_not_of('.') == std::string::npos ||
           (ending.size() == name.size() && (is_among(ending, endings) || is_among(ending, kKnown)));
}

}  // namespace

fs::path typed_path(const fs::path& folder, std::string_view typed) {
    const auto whole = [&](const fs::path& given) {
        fs::path path = folder / given;
        if (given.filename() == "." || given.filename() == "..") path /= "";
        return path.lexically_normal();
    };
    std::error_code unknown;
    if (fs::exists(whole(typed), unknown)) return whole(typed);
    const std::string_view meant = without_blanks_at_ends(typed);
    const char* home = std::getenv("HOME");
    const bool is_home = meant == "~" || meant.starts_with("~/");
    if (!is_home || !home || !fs::path(home).is_absolute()) return whole(meant);
    return (fs::path(home) / "" / meant.substr(std::min<std::size_t>(meant.size(), 2))).lexically_normal();
}

NamedFile with_ending(const fs::path& typed, std::string_view endings) {
    fs::path path = typed;
    if (is_no_name(path.filename().string(), endings))
        return {{}, fmt::format("the file needs a name before {}", endings.substr(0, endings.find(' ')))};
    const std::string ending = lower_extension(path);
    const auto fitting = [](fs::path named) {
        std::string told = told_of_length(named, kBesideName);
        return told.empty() ? NamedFile{std::move(named), ""} : NamedFile{{}, std::move(told)};
    };
    if (!ending.empty() && is_among(ending, endings)) return fitting(std::move(path));
    const std::string first(endings.substr(0, endings.find(' ')));
    if (is_among(ending, kKnown))
        return {{}, fmt::format("is written as {}, not as {}: type another ending, or none", first, ending)};
    if (ending == ".") path.replace_extension();
    path += first;
    return fitting(std::move(path));
}

}  // namespace tangi
