// file_name.h: whether a file can have its name, what lies beside a painting, and what the file system says,
// in words for people.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace tangi {

// [bytes] What the names that lie beside a painting have more than its own: "x.annotations.unsaved.json"
// beside "x.exr" (viewer/annotations/annotation_document.h).
inline constexpr std::size_t kBesideName = 21;

// Why no file can be written under this name: with what is put round it until it is whole
// (stale_temporaries.h), and `beside` more bytes, it is longer than the file system of its folder takes. Says
// by how many characters to shorten it; empty where it fits.
std::string told_of_length(const std::filesystem::path& file, std::size_t beside = 0);

// Whether there is one; no where nobody may look.
bool file_exists(const std::filesystem::path& file);

// What belongs to a painting: x.exr has x.ENDING beside it, wherever links lead to it. Only .exr is left out:
// x.EXR is another painting than x.exr.
std::filesystem::path beside_painting(const std::filesystem::path& painting, const std::string& ending);

// Such a name that is free: x.WHY.EXTENSION, or x.WHY-2.EXTENSION.
std::filesystem::path free_name_beside(const std::filesystem::path& painting, std::string_view why,
                                       std::string_view extension);

// Renames a file to such a name, which it returns without its folder; nothing, where there is no such file.
// Throws Error where it can't.
std::string put_aside(const std::filesystem::path& file, const std::filesystem::path& painting,
                      std::string_view why, std::string_view extension);

// What the operating system said of a file, with the file's name, and without the library's words.
std::string words_of(const std::filesystem::filesystem_error& error);

}  // namespace tangi
