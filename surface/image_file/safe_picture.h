// safe_picture.h: a picture's file, looked through before a library opens it.
//
// A file of a few bytes that claims to be large costs hours and gigabytes before a library notices; metadata
// that nobody needs ends the process in OpenImageIO 2.4 (profiles, EXIF, XMP). Every picture from outside is
// opened through this.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "surface/image/memory_budget.h"

namespace tangi {

class SafePicture {
public:
    // Throws Error naming the file where it is none of PNG, JPEG, TIFF, EXR, TGA and BMP, where it claims
    // more pixels than a file of its length can hold, this program takes, or there is the memory to unpack.
    // Reads headers only. Metadata that would lead a library astray are left out of what it sees.
    explicit SafePicture(const std::filesystem::path& path);
    ~SafePicture();
    SafePicture(SafePicture&& other) noexcept;
    SafePicture& operator=(SafePicture&& other) noexcept;

    // What to open: the file, or a copy of what is sound of it, which is there as long as this is.
    const std::string& path() const { return path_; }
    // OpenImageIO's reader for it: "png". It looks at no other, whatever the file is called.
    const char* reader() const { return reader_; }
    // What is damaged of its colour profile (ICC), in a few words: libraries see none then.
    const std::optional<std::string>& profile_damage() const { return profile_damage_; }
    // A JPEG of printing inks (CMYK), which its reader makes colours of.
    bool of_inks() const { return of_inks_; }
    // The memory to unpack it was taken: from now on it is no claim, but missing.
    void unpacked() { claim_.give_back(); }

private:
    std::string path_;
    MemoryClaim claim_;
    bool of_inks_ = false;
    const char* reader_ = nullptr;
    std::optional<std::string> profile_damage_;
    int copy_ = -1;
};

// What a library said of a picture that it cannot open, or of the pixels of one that it opened, in words of
// ours, with what to do.
std::string trouble_with_picture(const std::filesystem::path& path, std::string_view library_words);
std::string trouble_with_pixels(const std::filesystem::path& path, std::string_view library_words);

// [pixels] Of a picture: as many as OpenCV takes (CV_IO_MAX_IMAGE_PIXELS, 2^30). Photographs have a tenth.
constexpr double kMostPixels = 1024.0 * 1024 * 1024;

}  // namespace tangi
