// photo_file.h: one photograph on disk, read a few rows at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tangi {

// What a photograph's header says.
struct PhotoHeader {
    int width = 0, height = 0;  // of an EXR file's display window
    int channels = 0;           // 1 (grey) or 3
    int bits = 0;               // 8 or 16 (of integers of 32 bits, too); 32 for any kind of float
    bool is_float = false;      // EXR, float TIFF or L*a*b*
    // Floats that are linear light for certain: EXR, L*a*b*, and where an ICC profile says how they are
    // stored, by which they are decoded. Of other floats it is only likely.
    bool says_linear = false;
    bool is_raw = false;  // camera raw: linear light in the camera's primaries, 16 bit
    int orientation = 1;  // EXIF; anything but 1 means that viewers turn the picture
    // What is to be told of how the file was understood, without its name: several pictures in it, pixels
    // that are not square, an EXR file whose data window is not all of its display window, a damaged profile,
    // floats that a profile says are encoded.
    std::vector<std::string> doubts{};
};

// Whether a file of floats means light by this value, and not that there is nothing: not NaN or infinite; not
// 65504, the largest half, for which programs take what is infinite; below 1e10, as no unit gives even the
// sun's disc more (1.6e9 cd/m2), and marks for "no data" are 1e20 to 3.4e38. And above -1000: -9999 and
// -32768 are such marks as well, while noise below black is small beside full scale, of which 65535 is the
// largest in use.
bool is_light(float value);

// One of photo_formats() (photo_format.h), judged by the extension (in any case).
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
    // NaN in all channels, which is no sample, where the file has no pixel (outside of an EXR file's data
    // window), is more transparent than not (alpha below 0.5), or a channel holds no number that light can
    // have (is_light()). Colours that were multiplied by alpha are divided by it. Of floats that a profile
    // says are encoded: linear light, and no sample where a channel has full scale, which is what clipping
    // leaves. `values` holds at least (y1 - y0) * width * channels floats. Throws Error naming file and row.
    void read_rows(int y0, int y1, std::span<float> values);

    // Pixels of the rows read so far that held what is no number.
    long without_number() const { return without_number_; }
    // ... that are transparent.
    long transparent() const { return transparent_; }

private:
    struct Decoder;
    void read_raw_rows(int y0, int y1, std::span<float> values);
    void open_picture();
    void read_with_alpha(int y0, int y1, std::span<float> values);
    void require_no_negative(int y0, int y1, std::span<const float> values) const;
    void mask_transparent(std::span<float> values);
    void mask_what_is_no_number(int y0, std::span<float> values);
    std::filesystem::path path_;
    PhotoHeader header_;
    long without_number_ = 0, transparent_ = 0;
    std::unique_ptr<Decoder> decoder_;
};

// Values in units of full scale; of codes none is above it or below 0. NaN stays.
void divide_by_full_scale(std::span<float> values, double full_scale, bool codes);

}  // namespace tangi
