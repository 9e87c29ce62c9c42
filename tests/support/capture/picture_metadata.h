// picture_metadata.h: pictures with what cameras and programs put beside the pixels, byte by byte: EXIF,
// colour profiles, XMP.
#pragma once

#include <filesystem>
#include <string>

#include "surface/file/deflated.h"
#include "surface/image_file/icc_profile.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {

inline std::string number_bytes(std::uint64_t value, int length, bool big_endian) {
    std::string bytes;
    for (int i = 0; i < length; ++i)
        bytes += static_cast<char>(value >> 8 * (big_endian ? length - 1 - i : i) & 255);
    return bytes;
}
inline std::string be32(std::uint64_t value) { return number_bytes(value, 4, true); }

// An entry of a TIFF directory, little-endian: its value, or where it lies.
inline std::string tiff_entry(std::uint64_t tag, std::uint64_t type, std::uint64_t count,
                              std::uint64_t value) {
    return number_bytes(tag, 2, false) + number_bytes(type, 2, false) + number_bytes(count, 4, false) +
           number_bytes(value, 4, false);
}

// A block of EXIF: Orientation 1, 1/50 s at f/8 and ISO 200, and a maker's note of one entry, with this tag
// and value, of a camera of Canon, which OpenImageIO reads as a directory.
inline std::string exif_with_note(std::uint64_t note_tag, std::uint64_t note_value) {
    constexpr std::uint64_t exif = 8 + 2 + 3 * 12 + 4, note = exif + 2 + 4 * 12 + 4,
                            values = note + 2 + 12 + 4;
    std::string block("II*\0\x08\0\0\0", 8);
    block += number_bytes(3, 2, false) + tiff_entry(0x010F, 2, 6, values) + tiff_entry(0x0112, 3, 1, 1) +
             tiff_entry(0x8769, 4, 1, exif) + be32(0);
    block += number_bytes(4, 2, false) + tiff_entry(0x829A, 5, 1, values + 6) +
             tiff_entry(0x829D, 5, 1, values + 14) + tiff_entry(0x8827, 3, 1, 200) +
             tiff_entry(0x927C, 7, 18, note) + be32(0);
    block += number_bytes(1, 2, false) + tiff_entry(note_tag, 4, 1, note_value) + be32(0);
    block += std::string("Canon\0", 6);
    for (const std::uint64_t number : {1, 50, 8, 1}) block += number_bytes(number, 4, false);
    return block;
}
inline std::string plain_exif() { return exif_with_note(0x0006, 0); }
// Whose note leads back to the directory that holds it.
inline std::string exif_in_a_circle() { return exif_with_note(0x8769, 8 + 2 + 3 * 12 + 4); }

inline std::string jpeg_segment(int marker, const std::string& content) {
    return "\xFF" + std::string(1, static_cast<char>(marker)) + number_bytes(content.size() + 2, 2, true) +
           content;
}
inline std::string png_chunk_of(const std::string& type, const std::string& content) {
    return be32(content.size()) + type + content + be32(crc32_of(type + content));
}
inline std::string exif_segment(const std::string& block) {
    return jpeg_segment(0xE1, std::string("Exif\0\0", 6) + block);
}
inline std::string xmp_of(const std::string& elements) {
    return "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF><rdf:Description rdf:about=\"\">" + elements +
           "</rdf:Description></rdf:RDF></x:xmpmeta>";
}
inline std::string xmp_segment(const std::string& xmp) {
    return jpeg_segment(0xE1, std::string("http://ns.adobe.com/xap/1.0/\0", 29) + xmp);
}
// Elements in each other.
inline std::string nest(std::size_t depth) {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i) text += "<a>";
    for (std::size_t i = 0; i < depth; ++i) text += "</a>";
    return text;
}

// A JPEG or PNG file with more behind its first marker, or its first chunk.
inline std::string with_segments(const std::string& jpeg, const std::string& segments) {
    return jpeg.substr(0, 2) + segments + jpeg.substr(2);
}
inline std::string with_chunks(const std::string& png, const std::string& chunks) {
    constexpr std::size_t first = 8 + 8 + 13 + 4;
    return png.substr(0, first) + chunks + png.substr(first);
}

// A TIFF of one colour, 8 bits a channel, with these entries beside those that it needs; their values follow
// the pixels in the file, from `tiff_values_at()` on.
inline std::uint64_t tiff_values_at(int width, int height) {
    return 8 + 6 + static_cast<std::uint64_t>(3 * width * height);
}
inline std::string tiff_with(int width, int height, const std::string& entries, const std::string& values) {
    const auto w = static_cast<std::uint64_t>(width), h = static_cast<std::uint64_t>(height);
    std::string file;
    file += number_bytes(8, 2, false) + number_bytes(8, 2, false) + number_bytes(8, 2, false);
    file += std::string(3 * w * h, '\x40') + values;
    if (file.size() % 2 == 1) file += '\0';
    std::string directory = tiff_entry(256, 3, 1, w) + tiff_entry(257, 3, 1, h) + tiff_entry(258, 3, 3, 8) +
                            tiff_entry(259, 3, 1, 1) + tiff_entry(262, 3, 1, 2) + tiff_entry(273, 4, 1, 14) +
                            tiff_entry(277, 3, 1, 3) + tiff_entry(278, 3, 1, h) +
                            tiff_entry(279, 4, 1, 3 * w * h) + entries;
    return std::string("II*\0", 4) + number_bytes(8 + file.size(), 4, false) + file +
           number_bytes(directory.size() / 12, 2, false) + directory + be32(0);
}

// An sRGB picture in the format of the extension, with EXIF, a profile and XMP where the format has them.
inline void write_picture_with_metadata(const std::filesystem::path& path, const Image<Rgb>& picture) {
    const std::string extension = lower_extension(path);
    if (extension == ".tga") {
        std::string head(18, '\0');
        head[2] = 2;
        head[12] = static_cast<char>(picture.width());
        head[14] = static_cast<char>(picture.height());
        head[16] = 24;
        return write_bytes(path, head + std::string(3 * picture.size(), '\x50'));
    }
    const bool is_exr = extension == ".exr";
    write_picture(path, picture, is_exr ? Transfer{} : Transfer{Transfer::Kind::srgb}, {.bits = 8});
    const std::string bytes = bytes_of(path);
    if (extension == ".jpg")
        write_bytes(path, with_segments(bytes, exif_segment(plain_exif()) + xmp_segment(xmp_of(nest(3)))));
    if (extension == ".png") write_bytes(path, with_chunks(bytes, png_chunk_of("eXIf", plain_exif())));
    if (extension != ".tif") return;
    const std::string profile = srgb_icc_profile(), xmp = xmp_of(nest(3));
    const std::uint64_t at = tiff_values_at(picture.width(), picture.height());
    write_bytes(path, tiff_with(picture.width(), picture.height(),
                                tiff_entry(700, 1, xmp.size(), at) +
                                    tiff_entry(34675, 7, profile.size(), at + xmp.size()),
                                xmp + profile));
}

}  // namespace tangi
