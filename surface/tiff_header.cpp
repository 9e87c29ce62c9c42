// tiff_header.cpp: what the directories of a TIFF file say of its pictures (TIFF 6.0).
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "surface/icc_profile.h"
#include "surface/picture_header.h"
#include "surface/tiff_directories.h"

namespace tangi {

namespace {

constexpr std::uint64_t kWidthTag = 256, kHeightTag = 257, kBitsTag = 258, kCompressionTag = 259,
                        kSamplesTag = 277, kXmpTag = 700, kTileWidthTag = 322, kTileHeightTag = 323,
                        kPhotometricTag = 262, kProfileTag = 34675;
constexpr std::uint64_t kMostProfile = 1u << 25;  // [bytes] 32 MiB; those of printers have some

// How many bytes a byte of the file can become, by the number of the compression; of uncompressed colours
// that are stored coarser than the brightness, six for two.
double most_unpacked(double compression, bool coarse_colours) {
    constexpr double none = 1, lzw = 2048, deflate = 1032, runs = 64, any = 1e6;
    if (compression <= 1) return coarse_colours ? 4 : none;
    if (compression == 5)
        return lzw;  // TIFF 6.0, section 13: strings of up to 4096 bytes, one longer each time
    if (compression == 8 || compression == 32946) return deflate;
    if (compression == 32773) return runs;  // PackBits: 128 bytes from 2
    if (compression == 7) return 512 * 4;   // JPEG, as in jpeg_header.cpp, of up to four channels
    return any;                             // of black and white a bit a row; others pack runs of any length
}

void read_directory(const TiffDirectories& in, const std::vector<TiffEntry>& entries, PictureHeader& header) {
    double width = 0, height = 0, bits = 1, samples = 1, compression = 1, photometric = 0, tile_width = 0,
           tile_height = 0;
    const std::array<std::pair<std::uint64_t, double*>, 8> sizes = {{{kWidthTag, &width},
                                                                     {kHeightTag, &height},
                                                                     {kBitsTag, &bits},
                                                                     {kSamplesTag, &samples},
                                                                     {kCompressionTag, &compression},
                                                                     {kPhotometricTag, &photometric},
                                                                     {kTileWidthTag, &tile_width},
                                                                     {kTileHeightTag, &tile_height}}};
    for (const TiffEntry& entry : entries) {
        for (const auto& [tag, value] : sizes)
            if (entry.tag == tag) *value = in.value(entry);
        if (entry.tag != kProfileTag || header.damage) continue;
        if (entry.bytes > std::min(in.file().size(), kMostProfile) ||
            entry.value_at + entry.bytes > in.file().size()) {
            header.damage = "its colour profile (ICC) lies outside of it";
        } else if (const auto damage = damage_of_icc(in.file().bytes(entry.value_at, entry.bytes))) {
            header.damage = "its colour profile (ICC): " + *damage;
        }
    }
    constexpr double ycbcr = 6;
    const double pixel = bits * samples / 8, unpacked = most_unpacked(compression, photometric == ycbcr);
    // A tile is unpacked as a whole, however small the picture is.
    const double bytes = std::max(width * height, tile_width * tile_height) * pixel;
    header.least_file = std::max(header.least_file, bytes / unpacked);
    if (bytes < header.bytes) return;
    header.width = width;
    header.height = height;
    header.bytes = bytes;
}

bool is_plain_xmp_entry(const TiffDirectories& in, const TiffEntry& entry) {
    const bool lies_in = entry.bytes <= in.file().size() && entry.value_at + entry.bytes <= in.file().size();
    return !lies_in || is_plain_xmp(in.file().bytes(entry.value_at, entry.bytes));
}

// The file with values that count nothing, where their counts stand at these places.
std::vector<FilePiece> with_no_values(std::set<std::uint64_t> counts_at, const TiffDirectories& in) {
    std::vector<FilePiece> pieces;
    const auto width = static_cast<std::uint64_t>(in.offset_bytes());
    std::uint64_t from = 0;
    for (const std::uint64_t at : counts_at) {
        if (at < from) continue;
        pieces.push_back({from, at - from});
        pieces.push_back({at, 0, std::string(width, '\0')});
        from = at + width;
    }
    if (!pieces.empty()) pieces.push_back({from, in.file().size() - std::min(from, in.file().size())});
    return pieces;
}

}  // namespace

void read_tiff_header(const FileBytes& file, PictureHeader& header) {
    const TiffDirectories in(file);
    std::uint64_t at = in.first();
    std::set<std::uint64_t> seen, hidden;
    while (at != 0 && at < file.size() && seen.size() < kMostTiffDirectories && seen.insert(at).second) {
        const auto directory = in.at(at);
        if (!directory) {
            header.damage = "its directory has more entries than there are kinds";
            break;
        }
        read_directory(in, directory->entries, header);
        for (const TiffEntry& entry : directory->entries)
            if (entry.tag == kXmpTag && !is_plain_xmp_entry(in, entry)) hidden.insert(entry.count_at);
        at = directory->next;
    }
    header.without = with_no_values(std::move(hidden), in);
}

}  // namespace tangi
