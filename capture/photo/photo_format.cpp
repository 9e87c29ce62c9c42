#include "capture/photo/photo_format.h"

#include <algorithm>
#include <array>

#include "capture/photo/photo_file.h"
#include "capture/photo/raw_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kJpegNames[] = {".jpg", ".jpeg"};
constexpr std::string_view kPngNames[] = {".png"};
constexpr std::string_view kTiffNames[] = {".tif", ".tiff"};
constexpr std::string_view kExrNames[] = {".exr"};
constexpr std::string_view kTgaNames[] = {".tga"};
constexpr std::string_view kBmpNames[] = {".bmp"};
constexpr std::string_view kRawNames[] = {".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".sr2", ".srf",
                                          ".dng", ".raf", ".orf", ".rw2", ".pef", ".ptx", ".srw", ".3fr",
                                          ".fff", ".iiq", ".mos", ".mef", ".erf", ".rwl", ".kdc"};

constexpr std::array kPhotoFormats = {
    PhotoFormat{.name = "JPEG", .extensions = kJpegNames, .is_lossy = true},
    PhotoFormat{.name = "PNG", .extensions = kPngNames, .has_png_chunks = true},
    PhotoFormat{.name = "TIFF", .extensions = kTiffNames, .kind = PhotoKind::any},
    PhotoFormat{.name = "EXR", .extensions = kExrNames, .kind = PhotoKind::linear},
    PhotoFormat{.name = "TGA", .extensions = kTgaNames},
    PhotoFormat{.name = "BMP", .extensions = kBmpNames},
    PhotoFormat{.name = "camera raw", .extensions = kRawNames, .kind = PhotoKind::camera_raw},
};

constexpr std::string_view kUnreadNames[] = {".heic", ".heif", ".avif", ".webp", ".gif",
                                             ".jp2",  ".j2k",  ".jxl",  ".psd",  ".psb"};

}  // namespace

std::span<const PhotoFormat> photo_formats() { return kPhotoFormats; }

const PhotoFormat* photo_format_named(const fs::path& path) {
    const std::string extension = lower_extension(path);
    const auto format = std::ranges::find_if(kPhotoFormats, [&](const PhotoFormat& known) {
        return std::ranges::find(known.extensions, extension) != known.extensions.end();
    });
    return format == kPhotoFormats.end() ? nullptr : &*format;
}

bool is_photo_name(const fs::path& path) { return photo_format_named(path) != nullptr; }

bool is_raw_name(const fs::path& path) {
    const PhotoFormat* format = photo_format_named(path);
    return format && format->kind == PhotoKind::camera_raw;
}

bool is_unread_picture_name(const fs::path& path) {
    return std::ranges::find(kUnreadNames, lower_extension(path)) != std::end(kUnreadNames);
}

std::string photo_formats_in_words() {
    std::string text;
    for (std::size_t i = 0; i < kPhotoFormats.size(); ++i) {
        if (i > 0) text += i + 1 < kPhotoFormats.size() ? ", " : " or ";
        text += kPhotoFormats[i].name;
    }
    return text;
}

}  // namespace tangi
