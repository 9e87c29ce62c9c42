// tiff_writer.h: TIFF files as other programs write them, which OpenImageIO does not: previews, pictures
// below pictures, L*a*b*.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tangi {

// Uncompressed, in one strip.
struct TiffPicture {
    int width = 1, height = 1, samples = 3, bits = 8;
    int photometric = 2;  // RGB
    int new_subfile_type = 0;
    int sample_format = 1;  // unsigned integers
    int extra_samples = 0;  // what those beyond the colours are: 1 associated alpha, 2 another alpha
    int tile_width = 0;     // said, where it is not 0, and not done
    std::vector<std::uint32_t> colour_map{};  // of a palette: all reds, all greens, all blues, of 16 bits
    std::string bytes;                        // of the pixels
    std::vector<TiffPicture> below{};         // in SubIFDs
};

// Little-endian (TIFF 6.0, section 2).
class TiffWriter {
public:
    explicit TiffWriter(const std::vector<TiffPicture>& pictures) {
        put(0x002A4949, 4);
        put(0, 4);
        std::size_t link = 4;  // where the place of the next directory is kept
        for (const TiffPicture& picture : pictures) {
            const std::size_t directory = add(picture);
            patch(link, directory);
            link = end_of_directory_;
        }
    }
    const std::string& bytes() const { return bytes_; }

private:
    struct Entry {
        int type;  // 3: SHORT, 4: LONG
        std::vector<std::uint32_t> values;
    };

    void put(std::uint64_t value, int size) {
        for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 255);
    }
    void patch(std::size_t at, std::size_t value) {
        for (std::size_t i = 0; i < 4; ++i) bytes_[at + i] = static_cast<char>(value >> (8 * i) & 255);
    }

    // Where the picture's directory is.
    std::size_t add(const TiffPicture& p) {
        std::vector<std::uint32_t> below;
        for (const TiffPicture& picture : p.below) below.push_back(static_cast<std::uint32_t>(add(picture)));
        const auto strip = static_cast<std::uint32_t>(bytes_.size());
        bytes_ += p.bytes;
        const auto number = [](int value) { return static_cast<std::uint32_t>(value); };
        std::map<int, Entry> entries = {
            {254, {4, {number(p.new_subfile_type)}}},
            {256, {4, {number(p.width)}}},
            {257, {4, {number(p.height)}}},
            {258, {3, std::vector<std::uint32_t>(static_cast<std::size_t>(p.samples), number(p.bits))}},
            {259, {3, {1}}},
            {262, {3, {number(p.photometric)}}},
            {273, {4, {strip}}},
            {277, {3, {number(p.samples)}}},
            {278, {4, {number(p.height)}}},
            {279, {4, {static_cast<std::uint32_t>(p.bytes.size())}}}};
        if (!below.empty()) entries[330] = {4, below};
        const bool is_single = p.photometric <= 1 || p.photometric == 3 || p.photometric == 32803;
        if (const int colours = is_single ? 1 : p.photometric == 5 ? 4 : 3; p.samples > colours)
            entries[338] = {3, std::vector<std::uint32_t>(static_cast<std::size_t>(p.samples - colours),
                                                          number(p.extra_samples))};
        if (p.sample_format != 1)
            entries[339] = {
                3, std::vector<std::uint32_t>(static_cast<std::size_t>(p.samples), number(p.sample_format))};
        if (p.photometric == 6) entries[530] = {3, {1, 1}};  // colours as fine as the brightness
        if (p.tile_width > 0) entries[322] = {3, {number(p.tile_width)}};
        if (!p.colour_map.empty()) entries[320] = {3, p.colour_map};
        std::map<int, std::size_t> elsewhere;  // values that do not fit into their entry
        for (const auto& [tag, entry] : entries)
            if (entry.values.size() * (entry.type == 3 ? 2 : 4) > 4) {
                elsewhere[tag] = bytes_.size();
                for (const std::uint32_t value : entry.values) put(value, entry.type == 3 ? 2 : 4);
            }
        if (bytes_.size() % 2 == 1) bytes_ += '\0';
        const std::size_t directory = bytes_.size();
        put(entries.size(), 2);
        for (const auto& [tag, entry] : entries) {
            put(static_cast<std::uint64_t>(tag), 2);
            put(static_cast<std::uint64_t>(entry.type), 2);
            put(entry.values.size(), 4);
            const std::size_t begin = bytes_.size();
            if (elsewhere.contains(tag))
                put(elsewhere[tag], 4);
            else
                for (const std::uint32_t value : entry.values) put(value, entry.type == 3 ? 2 : 4);
            bytes_.resize(begin + 4);
        }
        end_of_directory_ = bytes_.size();
        put(0, 4);
        return directory;
    }

    std::string bytes_;
    std::size_t end_of_directory_ = 0;
};

inline std::string tiff_of(const std::vector<TiffPicture>& pictures) { return TiffWriter(pictures).bytes(); }

// All pixels alike.
inline TiffPicture even_tiff(int width, int height, const std::string& pixel, int new_subfile_type = 0) {
    TiffPicture picture{.width = width,
                        .height = height,
                        .samples = static_cast<int>(pixel.size()),
                        .new_subfile_type = new_subfile_type,
                        .bytes = {}};
    for (int i = 0; i < width * height; ++i) picture.bytes += pixel;
    return picture;
}

}  // namespace tangi
