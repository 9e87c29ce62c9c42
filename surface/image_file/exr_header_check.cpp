#include "surface/image_file/exr_header_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string_view>

namespace tangi {

namespace {

constexpr std::uint32_t kMagic = 20000630, kTilesBit = 1u << 9, kPartsBit = 1u << 12;
constexpr double kBlockBytes = 16, kMostDeflated = 1032;
// What a byte can become at most, by the number of the compression: runs of 127 bytes from 2; deflate; of
// PIZ's Huffman codes, runs of 255 numbers from 9 bits; of PXR24's, 3 of 4 bytes deflated; B44's blocks of 32
// bytes from 3 at least. Nothing is known of DWA's.
constexpr std::array<double, 8> kMostUnpacked = {1, 64, kMostDeflated, kMostDeflated, 512, 1376, 16, 16};
// A tile is unpacked as a whole: [pixels] how many more it may have than the picture.
constexpr double kMostOfTile = 4 * 1024.0 * 1024;
constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMostRead = 1u << 20;  // [bytes] of an attribute that is looked at
// Rows in a block, by the number of the compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
constexpr std::array<int, 10> kRowsOf = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

struct Part {
    std::string name;
    std::optional<std::array<std::int32_t, 4>> window;  // smallest x, y, largest x, y
    std::optional<std::array<std::uint32_t, 2>> tile;
    bool in_levels = false;  // tiles of several sizes of the picture
    std::string type;        // "scanlineimage"; "" of the only part of old files
    unsigned char compression = 0;
    double pixel_bytes = 0;

    bool has_tiles(std::uint32_t version) const {
        return type.empty() ? (version & kTilesBit) != 0 : type == "tiledimage";
    }
    int rows_in_block() const { return compression < kRowsOf.size() ? kRowsOf[compression] : kRowsOf.back(); }
    // [blocks] Of rows, or tiles.
    double blocks(double width, double height) const {
        if (tile)
            return std::ceil(width / std::max((*tile)[0], 1u)) * std::ceil(height / std::max((*tile)[1], 1u));
        return std::ceil(height / rows_in_block());
    }
    // [bytes] of a block of rows, or a row of tiles.
    double held(double width, double height) const {
        const double rows = tile ? (*tile)[1] : rows_in_block();
        return width * std::min(rows, height) * pixel_bytes;
    }
};

class Reader {
public:
    Reader(const std::filesystem::path& path, std::uint64_t length)
        : file_(path, std::ios::binary), length_(length) {}

    template <class T>
    bool number(T& value) {
        return static_cast<bool>(file_.read(reinterpret_cast<char*>(&value), sizeof value));
    }
    // Up to the byte 0 that ends it; false where there is none.
    bool name(std::string& text) {
        text.clear();
        for (char c = 0; text.size() <= kLongestName && file_.get(c); text += c)
            if (c == 0) return true;
        return false;
    }
    bool bytes(std::string& text, std::uint32_t size) {
        text.resize(size);
        return static_cast<bool>(file_.read(text.data(), static_cast<std::streamsize>(size)));
    }
    // Whether the file goes on for so many bytes.
    bool has(std::uint32_t size) {
        const auto here = file_.tellg();
        return here >= 0 && size <= length_ - std::min(length_, static_cast<std::uint64_t>(here));
    }
    bool skip(std::uint32_t size) { return static_cast<bool>(file_.seekg(size, std::ios::cur)); }
    bool go_to(std::uint64_t place) {
        return static_cast<bool>(file_.seekg(static_cast<std::streamoff>(place)));
    }

private:
    std::ifstream file_;
    std::uint64_t length_;
};

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

// Of all channels that are not sampled more coarsely than the pixels.
double pixel_bytes_of(const std::string& channels) {
    double sum = 0;
    for (std::size_t at = 0; at < channels.size() && channels[at] != 0;) {
        const auto end = channels.find('\0', at);  // then type, linear, reserved, sampling of x, of y
        if (end == std::string::npos || end + 17 > channels.size()) break;
        const bool half = number_at<std::int32_t>(channels, end + 1) == 1;
        const bool whole = number_at<std::int32_t>(channels, end + 9) == 1 &&
                           number_at<std::int32_t>(channels, end + 13) == 1;
        if (whole) sum += half ? 2 : 4;
        at = end + 17;
    }
    return sum;
}

// Bytes of a value of a kind whose values all have as many (OpenEXR file layout, "Predefined attribute
// types").
const std::map<std::string_view, std::uint32_t> kBytesOfKind = {{"box2i", 16},
                                                                {"box2f", 16},
                                                                {"chromaticities", 32},
                                                                {"compression", 1},
                                                                {"deepImageState", 1},
                                                                {"double", 8},
                                                                {"envmap", 1},
                                                                {"float", 4},
                                                                {"int", 4},
                                                                {"keycode", 28},
                                                                {"lineOrder", 1},
                                                                {"m33f", 36},
                                                                {"m33d", 72},
                                                                {"m44f", 64},
                                                                {"m44d", 128},
                                                                {"rational", 8},
                                                                {"tiledesc", 9},
                                                                {"timecode", 8},
                                                                {"v2i", 8},
                                                                {"v2f", 8},
                                                                {"v2d", 16},
                                                                {"v3i", 12},
                                                                {"v3f", 12},
                                                                {"v3d", 24}};

// Names that end with 0, and 16 bytes each, up to an empty one, which is the end.
bool is_channel_list(const std::string& value) {
    for (std::size_t at = 0; at < value.size();) {
        if (value[at] == 0) return at + 1 == value.size();
        const auto end = value.find('\0', at);
        if (end == std::string::npos) return false;
        at = end + 17;
    }
    return false;
}

// Texts with their lengths before them.
bool is_list_of_texts(const std::string& value) {
    std::uint64_t at = 0;
    while (at + 4 <= value.size()) at += 4 + std::uint64_t{number_at<std::uint32_t>(value, at)};
    return at == value.size();
}

// Whether a value is as long as its kind is; `value` is there where looks_into(kind).
bool looks_into(const std::string& kind) {
    return kind == "chlist" || kind == "preview" || kind == "stringvector";
}
bool has_its_length(const std::string& kind, std::uint32_t size, const std::string& value) {
    if (const auto fixed = kBytesOfKind.find(kind); fixed != kBytesOfKind.end()) return size == fixed->second;
    if (kind == "chlist") return is_channel_list(value);
    if (kind == "stringvector") return is_list_of_texts(value);
    if (kind != "preview") return true;
    return size >= 8 && 8 + 4 * std::uint64_t{number_at<std::uint32_t>(value, 0)} *
                                    std::uint64_t{number_at<std::uint32_t>(value, 4)} ==
                            size;
}

void keep(Part& part, const std::string& name, const std::string& value) {
    if (name == "name") part.name = value;
    if (name == "channels") part.pixel_bytes = pixel_bytes_of(value);
    if (name == "compression" && !value.empty()) part.compression = static_cast<unsigned char>(value[0]);
    if (name == "dataWindow" && value.size() == 16)
        part.window = std::bit_cast<std::array<std::int32_t, 4>>(number_at<std::array<char, 16>>(value, 0));
    if (name == "type") part.type = value;
    if (name == "tiles" && value.size() >= 8)
        part.tile = {number_at<std::uint32_t>(value, 0), number_at<std::uint32_t>(value, 4)};
    if (name == "tiles" && value.size() > 8) part.in_levels = (value[8] & 0xf) != 0;
}

bool wanted(const std::string& name) {
    return name == "name" || name == "channels" || name == "compression" || name == "dataWindow" ||
           name == "tiles" || name == "type";
}

enum class Header { whole, empty, too_long, malformed, unreadable };

// One header up to the byte 0 that ends it: empty where that is all there is, too long where it claims an
// attribute of more bytes than the file has left.
Header read_part(Reader& in, Part& part) {
    bool empty = true;
    for (std::string name, type, value; in.name(name); empty = false) {
        if (name.empty()) return empty ? Header::empty : Header::whole;
        std::uint32_t size = 0;
        if (!in.name(type) || !in.number(size) || size > INT32_MAX) return Header::unreadable;
        if (!in.has(size)) return Header::too_long;
        const bool look = (wanted(name) || looks_into(type)) && size <= kMostRead;
        if (look ? !in.bytes(value, size) : !in.skip(size)) return Header::unreadable;
        if ((look || !looks_into(type)) && !has_its_length(type, size, value)) return Header::malformed;
        if (look) keep(part, name, value);
    }
    return Header::unreadable;
}

// [bytes] that a file with this part has at least.
double least_bytes(const Part& part, double width, double height) {
    const double tables = kBlockBytes * part.blocks(width, height),
                 pixels = part.pixel_bytes * width * height;
    const bool flat = part.type.empty() || part.type == "scanlineimage" || part.type == "tiledimage";
    const bool known = part.compression < kMostUnpacked.size();
    return tables + (flat && known ? pixels / kMostUnpacked[part.compression] : 0);
}

// Whether the file ends before the last block of the tables of offsets, which `in` has come to, or a block
// has no place. `blocks`: of each part.
bool ends_too_soon(Reader& in, std::uint32_t version, std::uint64_t length, const std::vector<Part>& parts,
                   const std::vector<double>& blocks) {
    std::uint64_t last = 0;
    const Part* last_part = nullptr;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (double block = 0; block < blocks[i]; ++block) {
            std::uint64_t offset = 0;
            if (!in.number(offset) || offset == 0) return true;
            if (offset > last) last = offset, last_part = &parts[i];
        }
    if (!last_part) return false;
    // Which part, where there are several; the first row, or column, row and level of a tile; its bytes.
    const std::uint64_t head = ((version & kPartsBit) != 0 ? 4u : 0u) +
                               (last_part->has_tiles(version) ? 16u : 4u) + sizeof(std::uint32_t);
    std::uint32_t size = 0;
    if (last >= length || head > length - last) return true;
    if (!in.go_to(last + head - sizeof size) || !in.number(size)) return true;
    return size > length - last - head;
}

}  // namespace

std::optional<ExrClaim> exr_claim(const std::filesystem::path& path) {
    if (std::endian::native != std::endian::little) return {};
    std::error_code unknown;
    const auto length = std::filesystem::file_size(path, unknown);
    if (unknown) return {};
    Reader in(path, length);
    std::uint32_t magic = 0, version = 0;
    if (!in.number(magic) || magic != kMagic || !in.number(version)) return {};
    ExrClaim claim;
    double least = 0;
    bool sized = true;  // all parts say how large they are
    bool plain = true;  // whose tables of offsets are as long as blocks() says
    std::vector<Part> parts;
    std::vector<double> blocks;
    for (bool more = true; more;) {
        Part part;
        const Header header = read_part(in, part);
        if (header == Header::unreadable) return {};
        if (header == Header::empty) break;
        claim.cut_off = header == Header::too_long;
        claim.malformed = header == Header::malformed;
        if (claim.cut_off || claim.malformed) {
            claim.parts.push_back(part.name);
            return claim;
        }
        more = (version & kPartsBit) != 0;
        claim.parts.push_back(part.name);
        // What is wrong with one header OpenEXR says after it has read all.
        const auto [x0, y0, x1, y1] = part.window.value_or(std::array{0, 0, -1, -1});
        const double width = static_cast<double>(x1) - x0 + 1, height = static_cast<double>(y1) - y0 + 1;
        sized = sized && width >= 1 && height >= 1;
        if (!sized) continue;
        least += least_bytes(part, width, height);
        claim.pixels = std::max(claim.pixels, width * height);
        claim.held = std::max(claim.held, part.held(width, height));
        const double tile = part.tile ? static_cast<double>((*part.tile)[0]) * (*part.tile)[1] : 0;
        if ((least > static_cast<double>(length) || tile > width * height + kMostOfTile) && !claim.impossible)
            claim.impossible = fmt::format("{} x {}", width, height);
        plain = plain && !part.in_levels && part.has_tiles(version) == part.tile.has_value() &&
                (part.type.empty() || part.type == "scanlineimage" || part.type == "tiledimage");
        blocks.push_back(part.blocks(width, height));
        parts.push_back(std::move(part));
    }
    if (!sized) return {};
    if (plain && !claim.impossible) claim.cut_off = ends_too_soon(in, version, length, parts, blocks);
    return claim;
}

}  // namespace tangi
