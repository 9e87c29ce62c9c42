// photo_names.h: which photograph of a folder a lights file means by a name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tangi {

// Names in whatever case, and whether a letter with a mark is one code point (as most programs write it) or
// two (as macOS does), are the same; what is no UTF-8 is taken for Latin-1.
std::string alike(const std::string& text);

// Names as people count: photo_2 before photo_10.
bool before_as_counted(std::string_view a, std::string_view b);

// Windows programs write their folders with backslashes.
std::filesystem::path portable(std::string name);

struct NamedPhoto {
    std::optional<std::filesystem::path> photo;
    // Files of the name's stem of which nothing says which is meant; empty where `photo` is known.
    std::vector<std::filesystem::path> candidates{};
    // JPEG files that have the stem, too, beside `photo`, which was chosen since it lost less.
    std::vector<std::filesystem::path> beside{};
};

// `photos`: the pictures of `folder`. Tried from the strictest reading to the loosest: the path, where it
// lies in the folder; the file name; the stem, where one file has it, or one camera raw, or one that is no
// JPEG. A path that leads out of the folder counts by its file name alone: who names a folder means what is
// there.
NamedPhoto photo_named(const std::string& name, const std::filesystem::path& folder,
                       const std::vector<std::filesystem::path>& photos);

// The file that a lights file's name with a folder in it means by itself, wherever that is: absolute, or from
// the lights file's folder. Empty where there is none; a name alone means no folder.
std::optional<std::filesystem::path> file_listed(const std::string& name,
                                                 const std::filesystem::path& lights_file);

// Pictures of the name's stem in formats that are not read: of a phone, of the web.
std::vector<std::filesystem::path> unread_pictures(const std::string& name,
                                                   const std::filesystem::path& folder);

}  // namespace tangi
