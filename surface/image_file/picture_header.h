// picture_header.h: what a picture's file says of itself, read by ourselves before a library decodes it: how
// large it is, and what lies beside its pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surface/file/file_bytes.h"

namespace tangi {

enum class PictureFormat { png, jpeg, tiff, exr, tga, bmp };

// A part of a file as a library is to see it: bytes of it, or others in their place.
struct FilePiece {
    std::uint64_t begin = 0, length = 0;
    std::string instead{};
};

struct PictureHeader {
    PictureFormat format = PictureFormat::png;
    double width = 0, height = 0;  // of the largest picture in it
    double bytes = 0;              // of its pixels, unpacked as the file stores them
    // [bytes] that a file with these pixels has at least, by what its packing can do at best.
    double least_file = 0;
    // [bytes] that a library holds at once to give the first row: the picture, where its rows are not stored
    // one behind the other; else a strip.
    double held = 0;
    bool of_inks = false;  // CMYK or YCCK, of JPEG
    // What is damaged, in words that follow "is damaged: ": only what nobody can do without.
    std::optional<std::string> damage{};
    // What is damaged of its colour profile (ICC), which `without` leaves out.
    std::optional<std::string> profile_damage{};
    // Where metadata would lead a library astray: the file without them. Else empty.
    std::vector<FilePiece> without{};
};

// By the first bytes, or else by the extension (".tga", which has none of its own). Nothing for other files.
std::optional<PictureFormat> picture_format(const FileBytes& file, const std::string& extension);

// Of a PNG, JPEG, TIFF, TGA or BMP file. What cannot be followed is left to the library to complain of;
// nothing for EXR, which exr_claim() reads.
PictureHeader picture_header(const FileBytes& file, PictureFormat format);

// Of a file of camera raw that is built as a TIFF file (DNG, CR2, NEF, ARW and others), the pictures below
// its pages among what it claims; nothing of others.
std::optional<PictureHeader> raw_header(const FileBytes& file);

// The formats, one by one.
void read_png_header(const FileBytes& file, PictureHeader& header);
void read_jpeg_header(const FileBytes& file, PictureHeader& header);
void read_tiff_header(const FileBytes& file, PictureHeader& header);

// XMP with more elements than this is not shown to OpenImageIO 2.4, which calls itself for each that lies in
// another: they take 300 bytes of stack, of which threads have 8 MiB.
bool is_plain_xmp(std::string_view xmp);

}  // namespace tangi
