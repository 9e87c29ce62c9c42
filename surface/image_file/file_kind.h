// file_kind.h: what a file is that is no picture of the formats that are read, by its first bytes.
#pragma once

#include <string>

#include "surface/file/file_bytes.h"

namespace tangi {

// In words that follow the file's name, with the remedy: "is a HEIC photograph, …". Whatever it is called;
// "is not a picture that can be read: …" where its beginning is that of none of some thirty formats.
std::string what_it_is_instead(const FileBytes& file);

}  // namespace tangi
