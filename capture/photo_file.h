// photo_file.h: one photograph on disk, read a few rows at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace tangi {

// What a photograph's header says.
struct PhotoHeader {
    int width = 0, height = 0;
    int channels = 0;       // 1 (grey) or 3; alpha is dropped
    int bits = 0;           // 8 or 16; 32 for any kind of float
    bool is_float = false;  // EXR or float TIFF: linear light
    bool is_raw = false;    // camera raw: linear light in the camera's primaries, 16 bit
    int orientation = 1;    // EXIF; anything but 1 means that viewers turn the picture
};

// JPEG, PNG, TIFF, EXR, TGA or camera raw, judged by the extension (in any case).
bool is_photo_name(const std::filesystem::path& path);

// An open photograph. Rows are decoded once when read in ascending order; going back starts over. Camera raw
// is developed as a whole (develop_raw) when the first row is read, and held until the last row was: stacks
// keep raws in a scratch file instead (develop_stack).
class PhotoFile {
public:
    // `demosaic` is for camera raw. Throws Error naming the file: missing, not a picture, truncated.
    explicit PhotoFile(std::filesystem::path path, std::string demosaic = "AHD");
    ~PhotoFile();
    PhotoFile(PhotoFile&&) noexcept;
    PhotoFile& operator=(PhotoFile&&) noexcept;

    const PhotoHeader& header() const { return header_; }
    const std::filesystem::path& path() const { return path_; }

    // Rows y0 <= y < y1 as stored, interleaved, width * channels values a row; integers are scaled to 0..1.
    // `values` holds at least (y1 - y0) * width * channels floats. Throws Error naming file and row.
    void read_rows(int y0, int y1, std::span<float> values);

private:
    struct Decoder;
    void read_raw_rows(int y0, int y1, std::span<float> values);
    std::filesystem::path path_;
    PhotoHeader header_;
    std::unique_ptr<Decoder> decoder_;
};

}  // namespace tangi
