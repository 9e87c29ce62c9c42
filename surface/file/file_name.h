// file_name.h: whether a file can have its name, and what the file system says, in words for people.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace tangi {

// [bytes] What the names that lie beside a painting have more than its own: "x.annotations.unsaved.json"
// beside "x.exr" (viewer/annotations/annotation_document.h).
inline constexpr std::size_t kBesideName = 21;

// Why no file can be written under this name: with what is put round it until it is whole
// (stale_temporaries.h), and `beside` more bytes, it is longer than the file system of its folder takes. Says
// by how many characters to shorten it; empty where it fits.
std::string told_of_length(const std::filesystem::path& file, std::size_t beside = 0);

// What the operating system said of a file, with the file's name, and without the library's words.
std::string words_of(const std::filesystem::filesystem_error& error);

}  // namespace tangi
