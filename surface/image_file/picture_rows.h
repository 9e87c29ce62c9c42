// picture_rows.h: one picture on disk, decoded a few rows at a time. Photographs, masks, maps and relief
// pictures are all read through this, so that a file means the same wherever it is given.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

constexpr float kSquarePixels = 0.01f;  // [1] resolutions are often rounded

struct PictureContent {
    int width = 0, height = 0;  // of an EXR file's display window
    Region window;              // what the file has of it; may reach beyond
    std::vector<std::string> channels;
    int alpha = -1;           // which of them; -1: none
    bool multiplied = false;  // colours are, by alpha
    // A fourth byte that many programs leave at 0, and that is alpha in few (BMP, TGA).
    bool alpha_is_vague = false;
    int bits = 0;  // of a channel as stored
    bool is_float = false;
    bool is_signed = false;  // integers that may be negative
    bool of_inks = false;    // stored as CMYK, and converted as if inks were ideal
    bool is_exr = false;
    int page = 0;            // of the file's pictures
    std::size_t alike = 1;   // pictures that might be meant as well, itself among them (TIFF)
    int photometric = -1;    // PhotometricInterpretation (TIFF); else -1
    int orientation = 1;     // EXIF
    float pixel_aspect = 1;  // [1] width of a pixel over its height, as the file says
    std::optional<std::string> profile_damage{};  // why it is read as if it had no ICC profile

    bool has(int x, int y) const {
        return x >= window.x0 && x < window.x1 && y >= window.y0 && y < window.y1;
    }
    // Whether the file has every pixel of the picture.
    bool is_complete() const {
        return window.x0 <= 0 && window.y0 <= 0 && window.x1 >= width && window.y1 >= height;
    }
};

class PictureRows {
public:
    // `lab_as_stored`: L*a*b* stays that, where OpenImageIO would make 8 bits of sRGB of it. Throws Error
    // naming the file: missing, no picture (SafePicture), cut off, its picture where it cannot be read, or a
    // size that there is not the memory for.
    explicit PictureRows(const std::filesystem::path& path, bool lab_as_stored = false);
    ~PictureRows();
    PictureRows(PictureRows&&) noexcept;
    PictureRows& operator=(PictureRows&&) noexcept;

    const PictureContent& content() const { return content_; }

    // Rows y0 <= y < y1 of `count` channels from `first` on, as stored, interleaved, width * count values a
    // row; integers are scaled to 0..1. NaN where the file has no pixel. Rows are decoded once when read in
    // ascending order; going back starts over. Throws Error naming file and rows.
    void read(int y0, int y1, int first, int count, std::span<float> values);

private:
    struct Decoder;
    void decode(int y0, int y1, int first, int count, std::span<float> values);
    std::filesystem::path path_;
    PictureContent content_;
    std::unique_ptr<Decoder> decoder_;
};

}  // namespace tangi
