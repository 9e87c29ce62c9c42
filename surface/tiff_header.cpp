// tiff_header.cpp: the directories of a TIFF file (TIFF 6.0, section 2; BigTIFF).
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "surface/icc_profile.h"
#include "surface/picture_header.h"

namespace tangi {

namespace {

constexpr std::uint64_t kWidthTag = 256, kHeightTag = 257, kBitsTag = 258, kCompressionTag = 259,
                        kSamplesTag = 277, kXmpTag = 700, kTileWidthTag = 322, kTileHeightTag = 323,
                        kPhotometricTag = 262, kProfileTag = 34675;
constexpr std::uint64_t kMostProfile = 1u << 25;    // [bytes] 32 MiB; those of printers have some
constexpr std::size_t kMostTiffDirectories = 1000;  // pages and pyramids have some tens
constexpr std::uint64_t kMostTiffEntries = 4096;    // libtiff knows some 300 tags
// Bytes of a value by the number of its type; BigTIFF adds 16 to 18.
constexpr std::array<std::uint64_t, 19> kTiffBytesOf = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4,
                                                        8, 4, 8, 4, 0, 0, 8, 8, 8};

struct TiffEntry {
    std::uint64_t tag = 0, type = 0, count = 0;
    std::uint64_t count_at = 0;  // where the count stands
    std::uint64_t value_at = 0;  // where the value begins
    std::uint64_t bytes = 0;
};

struct TiffReader {
    const FileBytes& file;
    bool big_endian = false, big = false;

    std::uint64_t number(std::uint64_t at, int length) const {
        return file.number(at, length, big_endian).value_or(0);
    }
    int offset_bytes() const { return big ? 8 : 4; }

    // Nothing where it has more entries than there can be.
    std::optional<std::vector<TiffEntry>> directory(std::uint64_t at, std::uint64_t& next) const {
        const int count_bytes = big ? 8 : 2;
        const std::uint64_t count = number(at, count_bytes), entry_bytes = big ? 20 : 12;
        if (count > kMostTiffEntries) return {};
        std::vector<TiffEntry> entries;
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::uint64_t entry = at + static_cast<std::uint64_t>(count_bytes) + i * entry_bytes;
            const auto width = static_cast<std::uint64_t>(offset_bytes());
            TiffEntry e{number(entry, 2), number(entry + 2, 2), number(entry + 4, offset_bytes()), entry + 4};
            const std::uint64_t unit = e.type < kTiffBytesOf.size() ? kTiffBytesOf[e.type] : 0;
            e.bytes = e.count > file.size() ? file.size() + 1 : unit * e.count;
            const std::uint64_t field = entry + 4 + width;
            e.value_at = e.bytes <= width ? field : number(field, offset_bytes());
            entries.push_back(e);
        }
        next = number(at + static_cast<std::uint64_t>(count_bytes) + count * entry_bytes, offset_bytes());
        return entries;
    }
    double first(const TiffEntry& entry) const {
        const std::uint64_t unit = entry.type < kTiffBytesOf.size() ? kTiffBytesOf[entry.type] : 0;
        return unit == 0 ? 0 : static_cast<double>(number(entry.value_at, static_cast<int>(unit)));
    }
};

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

void read_directory(const TiffReader& in, const std::vector<TiffEntry>& entries, PictureHeader& header) {
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
            if (entry.tag == tag) *value = in.first(entry);
        if (entry.tag != kProfileTag || header.damage) continue;
        if (entry.bytes > std::min(in.file.size(), kMostProfile) ||
            entry.value_at + entry.bytes > in.file.size()) {
            header.damage = "its colour profile (ICC) lies outside of it";
        } else if (const auto damage = damage_of_icc(in.file.bytes(entry.value_at, entry.bytes))) {
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

bool is_plain_xmp_entry(const TiffReader& in, const TiffEntry& entry) {
    const bool lies_in = entry.bytes <= in.file.size() && entry.value_at + entry.bytes <= in.file.size();
    return !lies_in || is_plain_xmp(in.file.bytes(entry.value_at, entry.bytes));
}

// The file with values that count nothing, where their counts stand at these places.
std::vector<FilePiece> with_no_values(std::set<std::uint64_t> counts_at, const TiffReader& in) {
    std::vector<FilePiece> pieces;
    const auto width = static_cast<std::uint64_t>(in.offset_bytes());
    std::uint64_t from = 0;
    for (const std::uint64_t at : counts_at) {
        if (at < from) continue;
        pieces.push_back({from, at - from});
        pieces.push_back({at, 0, std::string(width, '\0')});
        from = at + width;
    }
    if (!pieces.empty()) pieces.push_back({from, in.file.size() - std::min(from, in.file.size())});
    return pieces;
}

}  // namespace

void read_tiff_header(const FileBytes& file, PictureHeader& header) {
    const std::string head = file.bytes(0, 4);
    TiffReader in{file, head.starts_with("MM"), false};
    in.big = in.number(2, 2) == 43;
    std::uint64_t at = in.big ? in.number(8, 8) : in.number(4, 4);
    std::set<std::uint64_t> seen, hidden;
    while (at != 0 && at < file.size() && seen.size() < kMostTiffDirectories && seen.insert(at).second) {
        std::uint64_t next = 0;
        const auto entries = in.directory(at, next);
        if (!entries) {
            header.damage = "its directory has more entries than there are kinds";
            break;
        }
        read_directory(in, *entries, header);
        for (const TiffEntry& entry : *entries)
            if (entry.tag == kXmpTag && !is_plain_xmp_entry(in, entry)) hidden.insert(entry.count_at);
        at = next;
    }
    header.without = with_no_values(std::move(hidden), in);
}

}  // namespace tangi
