// image_io.h: finished pictures to files and back (PNG, TIFF, JPEG, EXR), through OpenImageIO.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "surface/image/colour.h"
#include "surface/image/image.h"
#include "surface/image_file/picture_notes.h"

namespace tangi {

// How numbers are stored, where a format leaves the choice.
struct PictureStorage {
    int bits = 16;          // 8 or 16 a sample, for .png and .tif
    int jpeg_quality = 95;  // 1..100
    PictureNotes notes{};   // what the file says of itself
};

// Writes a linear picture, encoded by `transfer`, whole or not at all. The extension chooses the format and
// depth: .png .tif as `storage` says, .jpg 8 bit, .exr 32-bit float. EXR files are linear by definition:
// `transfer` must be linear, or Error. Throws Error where the file can't be written or the extension is none
// of these.
void write_picture(const std::filesystem::path& path, const Image<Rgb>& linear, const Transfer& transfer,
                   const PictureStorage& storage = {});

// A picture that is never in memory as a whole, as write_picture() writes it: whole or not at all.
class PictureWriter {
public:
    // Throws Error where the file cannot be written or the extension is none that pictures have.
    PictureWriter(const std::filesystem::path& path, int width, int height, const Transfer& transfer,
                  const PictureStorage& storage = {});
    ~PictureWriter();
    PictureWriter(PictureWriter&&) noexcept;

    // The next rows, linear, in the picture's width.
    void write(const Image<Rgb>& linear);
    // Once all rows are written. Throws Error, as on a full disk.
    void commit();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// Writes numbers as they are, one or three channels, in the same formats; integers hold 0..1. Numbers are no
// colours: the file says nothing of a colour space, by which browsers and editors would convert them.
void write_map(const std::filesystem::path& path, const Image<float>& values,
               const PictureStorage& storage = {});
void write_map(const std::filesystem::path& path, const Image<Rgb>& values,
               const PictureStorage& storage = {});

// Writes numbers that are pictures already (0..1, sRGB-encoded), 8 bit: contact sheets, error maps.
void write_picture_8bit(const std::filesystem::path& path, const Image<Rgb>& encoded_srgb,
                        const PictureStorage& storage = {});

// Reads any picture as stored, scaled to 0..1 where it holds integers; grey becomes RGB, alpha is dropped. Of
// an EXR file: its display window; 0 where its data window has no pixel. Throws Error as PictureRows does
// (picture_rows.h), and where there is not the memory for it.
Image<Rgb> read_picture(const std::filesystem::path& path);

// ".exr" of "A.EXR": formats are told apart by it, in any case.
std::string lower_extension(const std::filesystem::path& path);

// Throws Error where write_picture() would not know the format.
void require_picture_format(const std::filesystem::path& path);

}  // namespace tangi
