// png_header.cpp: the chunks of a PNG file (ISO/IEC 15948, 5.3 and 11).
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "surface/base/words.h"
#include "surface/file/deflated.h"
#include "surface/image_file/exif_block.h"
#include "surface/image_file/icc_profile.h"
#include "surface/image_file/picture_header.h"

namespace tangi {

namespace {

constexpr std::uint64_t kChunkHead = 8, kChunkChecksum = 4;
constexpr double kMostInflated = 1032;                // RFC 1951: 258 bytes from 2 bits
constexpr std::size_t kLongestPngProfile = 1u << 25;  // [bytes] 32 MiB; those of printers have some
constexpr std::size_t kLongestPngText = 1u << 23;     // [bytes] 8 MiB, of which libpng reads no more

std::string png_chunk(const std::string& type, const std::string& content) {
    const auto number = [](std::uint64_t value) {
        std::string bytes;
        for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
        return bytes;
    };
    return number(content.size()) + type + content + number(crc32_of(type + content));
}

void read_size(const std::string& content, PictureHeader& header) {
    if (content.size() < 13) return;
    const std::string_view text = content;
    header.width = static_cast<double>(number_in(text.substr(0, 4), true));
    header.height = static_cast<double>(number_in(text.substr(4, 4), true));
    const int depth = text[8], colour = text[9];
    const int channels = colour == 2 ? 3 : colour == 4 ? 2 : colour == 6 ? 4 : 1;
    header.bytes = header.height * (1 + std::ceil(header.width * depth * channels / 8));
    constexpr int palette = 3, palette_channels = 4;  // colours with alpha, which it stands for
    const bool interlaced = text[12] != 0;            // 8.2: seven passes over the whole picture
    if (interlaced)
        header.held = header.width * header.height * (colour == palette ? palette_channels : channels) *
                      std::max(depth / 8, 1);
}

// The text of a tEXt, zTXt or iTXt chunk, behind its keyword; nothing where it is packed and damaged.
std::optional<std::string> text_in(const std::string& type, std::string_view content) {
    const auto cut_word = [&] {
        const std::size_t end = std::min(content.find('\0'), content.size());
        content.remove_prefix(std::min(end + 1, content.size()));
    };
    bool packed = type == "zTXt";
    cut_word();  // the keyword
    if (packed) content.remove_prefix(std::min<std::size_t>(1, content.size()));
    if (type == "iTXt") {
        packed = content.starts_with('\1');
        content.remove_prefix(std::min<std::size_t>(2, content.size()));
        cut_word();  // the language
        cut_word();  // the keyword in it
    }
    return packed ? inflated(content, kLongestPngText) : std::string(content);
}

// EXIF as ImageMagick writes it into a text: in hexadecimal digits, behind its name and length.
std::string exif_in_digits(std::string_view text) {
    const std::size_t name = text.find("exif");
    if (name == std::string_view::npos) return {};
    text.remove_prefix(name + 4);
    const std::size_t length = text.find_first_not_of(" \t\r\n");
    text.remove_prefix(std::min(text.find_first_of("\r\n", std::min(length, text.size())), text.size()));
    std::string block;
    int high = -1;
    for (const char c : text) {
        if (std::isxdigit(static_cast<unsigned char>(c)) == 0) continue;
        const int digit = c <= '9' ? c - '0' : (c | 32) - 'a' + 10;
        if (high >= 0) block += static_cast<char>(high << 4 | digit);
        high = high >= 0 ? -1 : digit;
    }
    if (block.starts_with(std::string_view("Exif\0\0", 6))) block.erase(0, 6);
    return block;
}

// What to show a library instead of a chunk: nothing where that is the chunk itself.
std::optional<std::string> instead_of_chunk(const std::string& type, const std::string& content) {
    if (type == "eXIf" && !is_sound_exif(content)) {
        const std::string sound = sound_part_of_exif(content);
        return sound.empty() ? sound : png_chunk(type, sound);
    }
    if (type != "tEXt" && type != "zTXt" && type != "iTXt") return {};
    const std::string keyword = lower_case(content.substr(0, content.find('\0')));
    if (keyword == "xml:com.adobe.xmp") {
        const auto xmp = text_in(type, content);
        return xmp && is_plain_xmp(*xmp) ? std::nullopt : std::optional<std::string>("");
    }
    if (keyword != "raw profile type exif") return {};
    // OpenImageIO reads digits in its own way, so that what is sound here may not be there.
    const std::string sound = sound_part_of_exif(exif_in_digits(text_in(type, content).value_or("")));
    return sound.empty() ? sound : png_chunk("eXIf", sound);
}

std::optional<std::string> damage_of_profile(std::string_view content) {
    const std::size_t name = content.find('\0');
    if (name == std::string_view::npos || name + 2 > content.size()) return {};  // which libpng skips
    const auto profile = inflated(content.substr(name + 2), kLongestPngProfile);
    return profile ? damage_of_icc(*profile) : std::optional<std::string>("it cannot be unpacked");
}

}  // namespace

void read_png_header(const FileBytes& file, PictureHeader& header) {
    double packed = 0;
    bool changed = false;
    std::vector<FilePiece> pieces = {{0, kChunkHead}};
    for (std::uint64_t at = kChunkHead;;) {
        const auto length = file.number(at, 4, true);
        const std::string type = file.bytes(at + 4, 4);
        const std::uint64_t whole = kChunkHead + length.value_or(0) + kChunkChecksum;
        if (!length || type.size() < 4 || whole > file.size() - at) break;
        std::optional<std::string> instead;
        if (type == "IDAT") {
            packed += static_cast<double>(*length);
        } else if (*length <= kLongestPngProfile) {
            const std::string content = file.bytes(at + kChunkHead, *length);
            if (type == "IHDR") read_size(content, header);
            instead = instead_of_chunk(type, content);
            if (type == "iCCP")
                if (const auto damage = damage_of_profile(content))
                    header.profile_damage = damage, instead = "";
        }
        changed = changed || instead;
        if (instead)
            pieces.push_back({at, 0, *instead});
        else if (pieces.back().instead.empty() && pieces.back().begin + pieces.back().length == at)
            pieces.back().length += whole;
        else
            pieces.push_back({at, whole});
        at += whole;
        if (type == "IEND") break;
    }
    if (changed) header.without = std::move(pieces);
    header.least_file = header.bytes / kMostInflated - packed + static_cast<double>(file.size());
}

}  // namespace tangi
