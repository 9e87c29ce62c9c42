#include "surface/image_file/picture_header.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace tangi {

namespace {

// Uncompressed, or runs of up to 128 pixels that take a byte and one pixel (Truevision TGA 2.0).
void read_tga_header(const FileBytes& file, PictureHeader& header) {
    const auto kind = file.number(2, 1, false), width = file.number(12, 2, false),
               height = file.number(14, 2, false), bits = file.number(16, 1, false);
    if (!kind || !width || !height || !bits) return;
    const double pixel = std::max(1.0, static_cast<double>(*bits) / 8);
    header.width = static_cast<double>(*width);
    header.height = static_cast<double>(*height);
    header.bytes = header.width * header.height * pixel;
    const bool has_runs = (*kind & 8) != 0;
    header.least_file = has_runs ? header.width * header.height / 128 * (1 + pixel) : header.bytes;
    header.held = header.width * header.height * 4;  // OpenImageIO reads all of it, as up to four bytes
}

// Uncompressed, or runs of up to 255 pixels that take two bytes (BITMAPINFOHEADER; OS/2's header has 12
// bytes).
void read_bmp_header(const FileBytes& file, PictureHeader& header) {
    const bool is_short = file.number(14, 4, false) == 12;
    const int size_bytes = is_short ? 2 : 4;
    const auto width = file.number(18, size_bytes, false),
               height = file.number(is_short ? 20 : 22, size_bytes, false),
               bits = file.number(is_short ? 24 : 28, 2, false),
               packing = is_short ? std::optional<std::uint64_t>(0) : file.number(30, 4, false);
    if (!width || !height || !bits || !packing) return;
    header.width = static_cast<double>(*width);
    // A negative height: rows from the top down.
    header.height = is_short ? static_cast<double>(*height)
                             : std::abs(static_cast<double>(static_cast<std::int32_t>(*height)));
    header.bytes = header.width * header.height * static_cast<double>(*bits) / 8;
    constexpr std::uint64_t runs_of_bytes = 1, runs_of_halves = 2;
    const bool has_runs = *packing == runs_of_bytes || *packing == runs_of_halves;
    header.least_file = has_runs ? 2 * header.width * header.height / 255 : header.bytes;
    if (has_runs) header.held = header.width * header.height;
}

// It begins with no word of its own: a kind of picture, and bits a pixel, that there are.
bool is_tga(const std::string& head) {
    constexpr std::string_view kinds("\1\2\3\x9\xa\xb", 6), depths("\x8\xf\x10\x18\x20", 5);
    return head.size() == 18 && (head[1] == 0 || head[1] == 1) &&
           kinds.find(head[2]) != std::string_view::npos && depths.find(head[16]) != std::string_view::npos;
}

}  // namespace

std::optional<PictureFormat> picture_format(const FileBytes& file, const std::string& extension) {
    using namespace std::string_view_literals;
    const std::string head = file.bytes(0, 8);
    if (head == "\x89PNG\r\n\x1a\n"sv) return PictureFormat::png;
    if (head.starts_with("\xFF\xD8\xFF"sv)) return PictureFormat::jpeg;
    for (const std::string_view tiff : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
        if (head.starts_with(tiff)) return PictureFormat::tiff;
    if (head.starts_with("\x76\x2f\x31\x01"sv)) return PictureFormat::exr;
    if (head.starts_with("BM"sv)) return PictureFormat::bmp;
    return extension == ".tga" && is_tga(file.bytes(0, 18)) ? std::optional(PictureFormat::tga)
                                                            : std::nullopt;
}

PictureHeader picture_header(const FileBytes& file, PictureFormat format) {
    PictureHeader header;
    header.format = format;
    if (format == PictureFormat::png) read_png_header(file, header);
    if (format == PictureFormat::jpeg) read_jpeg_header(file, header);
    if (format == PictureFormat::tiff) read_tiff_header(file, header);
    if (format == PictureFormat::tga) read_tga_header(file, header);
    if (format == PictureFormat::bmp) read_bmp_header(file, header);
    return header;
}

bool is_plain_xmp(std::string_view xmp) {
    constexpr std::ptrdiff_t most_elements = 4000;
    return std::ranges::count(xmp, '<') <= 2 * most_elements;
}

}  // namespace tangi
