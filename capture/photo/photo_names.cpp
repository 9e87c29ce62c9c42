#include "capture/photo/photo_names.h"

#include <utf8proc.h>

#include <algorithm>
#include <cstdlib>

#include "capture/photo/photo_format.h"
#include "capture/photo/raw_file.h"
#include "surface/base/words.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

bool leads_out(const fs::path& relative) {
    return relative.empty() || relative.is_absolute() || *relative.begin() == "..";
}

// The path where it lies in the folder, from there.
std::optional<fs::path> path_inside(const fs::path& folder, const fs::path& listed) {
    fs::path relative = listed.lexically_normal();
    if (listed.is_absolute()) {
        std::error_code unknown;
        const fs::path here = fs::weakly_canonical(fs::absolute(folder), unknown);
        if (unknown) return {};
        relative = fs::weakly_canonical(listed, unknown).lexically_relative(here);
    }
    if (leads_out(relative)) return {};
    std::error_code unknown;
    return fs::is_regular_file(folder / relative, unknown) ? std::optional(folder / relative) : std::nullopt;
}

// Of several files with one stem.
NamedPhoto choose(std::vector<fs::path> files) {
    if (files.size() == 1) return {files.front()};
    const auto only = [&](auto is) -> std::optional<fs::path> {
        if (std::count_if(files.begin(), files.end(), is) != 1) return {};
        return *std::find_if(files.begin(), files.end(), is);
    };
    // Cameras store a JPEG beside each raw, of the same name.
    if (const auto raw = only(is_raw_name)) return {raw};
    const auto is_lossless = [](const fs::path& path) {
        const PhotoFormat* format = photo_format_named(path);
        return !format || !format->is_lossy;
    };
    if (const auto better = only(is_lossless)) {
        std::erase(files, *better);
        return {better, {}, std::move(files)};
    }
    return {std::nullopt, std::move(files)};
}

// Latin-1 bytes are the first 256 code points.
std::string utf8_of_latin1(std::string_view text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80)
            result += c;
        else
            result += static_cast<char>(0xC0 | byte >> 6), result += static_cast<char>(0x80 | (byte & 0x3F));
    }
    return result;
}

}  // namespace

std::string alike(const std::string& text) {
    utf8proc_uint8_t* mapped = nullptr;
    const utf8proc_ssize_t size = utf8proc_map(
        reinterpret_cast<const utf8proc_uint8_t*>(text.data()), static_cast<utf8proc_ssize_t>(text.size()),
        &mapped, static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_DECOMPOSE | UTF8PROC_CASEFOLD));
    if (size < 0) return alike(utf8_of_latin1(text));
    std::string result(reinterpret_cast<const char*>(mapped), static_cast<std::size_t>(size));
    std::free(mapped);
    return result;
}

bool before_as_counted(std::string_view a, std::string_view b) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto number = [&](std::string_view& text) {
        std::size_t end = 0;
        while (end < text.size() && is_digit(text[end])) ++end;
        std::string_view digits = text.substr(0, end);
        text.remove_prefix(end);
        while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
        return digits;
    };
    const std::string_view whole_a = a, whole_b = b;
    while (!a.empty() && !b.empty()) {
        if (is_digit(a.front()) && is_digit(b.front())) {
            const std::string_view of_a = number(a), of_b = number(b);
            if (of_a.size() != of_b.size()) return of_a.size() < of_b.size();
            if (of_a != of_b) return of_a < of_b;
        } else {
            if (a.front() != b.front()) return a.front() < b.front();
            a.remove_prefix(1), b.remove_prefix(1);
        }
    }
    return a.empty() && b.empty() ? whole_a < whole_b : a.empty();
}

fs::path portable(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return fs::path(name);
}

NamedPhoto photo_named(const std::string& name, const fs::path& folder, const std::vector<fs::path>& photos) {
    const fs::path listed = portable(name);
    if (auto path = path_inside(folder, listed)) return {std::move(path)};
    std::error_code unknown;
    if (const fs::path file = folder / listed.filename(); fs::is_regular_file(file, unknown)) return {file};
    const std::string file_name = alike(listed.filename().string()), stem = alike(listed.stem().string());
    std::vector<fs::path> same_name, same_stem;
    for (const fs::path& photo : photos) {
        if (alike(photo.filename().string()) == file_name) same_name.push_back(photo);
        if (alike(photo.stem().string()) == stem) same_stem.push_back(photo);
    }
    if (!same_name.empty()) return choose(std::move(same_name));
    return same_stem.empty() ? NamedPhoto{} : choose(std::move(same_stem));
}

std::optional<fs::path> file_listed(const std::string& name, const fs::path& lights_file) {
    const fs::path listed = portable(name).lexically_normal();
    if (!listed.has_parent_path()) return {};
    const fs::path file = lights_file.parent_path() / listed;
    std::error_code unknown;
    return fs::is_regular_file(file, unknown) ? std::optional(file.lexically_normal()) : std::nullopt;
}

std::vector<fs::path> unread_pictures(const std::string& name, const fs::path& folder) {
    const std::string stem = alike(portable(name).stem().string());
    std::vector<fs::path> found;
    std::error_code unknown;
    for (const auto& entry : fs::directory_iterator(folder, unknown))
        if (is_unread_picture_name(entry.path()) && alike(entry.path().stem().string()) == stem)
            found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace tangi
