// photo_format.h: the table of formats of photographs: by what name each is known, and what its values mean.
//
// A folder's photographs are the files that this table knows. A further format is one row where OpenImageIO
// and surface/image_file/safe_picture.h read it (docs/developer/how-to.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace tangi {

enum class PhotoKind {
    encoded,    // for a screen: integers by a transfer curve, which metadata or the photographs tell
    any,        // integers, or floats that may be linear light: its header tells
    linear,     // light by definition
    camera_raw  // linear light in the camera's primaries, developed as a whole by LibRaw (raw_file.h)
};

struct PhotoFormat {
    std::string_view name;                         // as messages have it: "JPEG"
    std::span<const std::string_view> extensions;  // with the point, in lower case; no two rows share one
    PhotoKind kind = PhotoKind::encoded;
    bool is_lossy = false;        // of files of one stem another one is taken
    bool has_png_chunks = false;  // sRGB and gAMA, which OpenImageIO does not tell from its own guess
};

// The table, in the order in which messages list the formats.
std::span<const PhotoFormat> photo_formats();

// The format that an extension means, in any case; null where it is none of a photograph.
const PhotoFormat* photo_format_named(const std::filesystem::path& path);

// A picture that other programs show, and this one does not read: HEIC, WebP, PSD and others.
bool is_unread_picture_name(const std::filesystem::path& path);

// All formats, for messages: "JPEG, PNG or camera raw".
std::string photo_formats_in_words();

}  // namespace tangi
