// tiff_header.cpp: what the directories of a TIFF file say of its pictures (TIFF 6.0).
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "surface/image_file/icc_profile.h"
#include "surface/image_file/picture_header.h"
#include "surface/image_file/tiff_directories.h"

namespace tangi {

namespace {

constexpr std::uint64_t kWidthTag = 256, kHeightTag = 257, kBitsTag = 258, kCompressionTag = 259,
                        kSamplesTag = 277, kXmpTag = 700, kTileWidthTag = 322, kTileHeightTag = 323,
                        kPhotometricTag = 262, kStripRowsTag = 278, kProfileTag = 34675;
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

struct TiffSizes {
    double width = 0, height = 0, bits = 1, samples = 1, compression = 1, photometric = 0, tile_width = 0,
           tile_height = 0, strip_rows = 0;

    void take(const TiffDirectories& in, const TiffEntry& entry) {
        const std::array<std::pair<std::uint64_t, double*>, 9> known = {{{kWidthTag, &width},
                                                                         {kHeightTag, &height},
                                                                         {kBitsTag, &bits},
                                                                         {kSamplesTag, &samples},
                                                                         {kCompressionTag, &compression},
                                                                         {kPhotometricTag, &photometric},
                                                                         {kTileWidthTag, &tile_width},
                                                                         {kTileHeightTag, &tile_height},
                                                                         {kStripRowsTag, &strip_rows}}};
        for (const auto& [tag, value] : known)
            if (entry.tag == tag) *value = in.value(entry);
    }
    double pixel() const { return bits * samples / 8; }
    // Runs of black and white (TIFF 6.0, sections 10 and 11; T.4, T.6), which take a bit a row at least.
    bool is_fax() const { return compression >= 2 && compression <= 4; }
    // A strip, or a row of tiles; all of what libtiff makes colours of (TIFFReadRGBAImage), as four bytes.
    double held() const {
        const bool is_tiled = tile_width > 0 && tile_height > 0;
        const double columns = is_tiled ? std::ceil(width / tile_width) * tile_width : width,
                     rows = is_tiled ? tile_height : std::min(strip_rows > 0 ? strip_rows : height, height);
        constexpr double rgba = 4;
        return columns * rows * pixel() + (photometric >= kYcbcr ? rgba * width * height : 0);
    }
    static constexpr double kYcbcr = 6;  // and above: L*a*b* and others
};

void read_directory(const TiffDirectories& in, const std::vector<TiffEntry>& entries, PictureHeader& header) {
    TiffSizes sizes;
    for (const TiffEntry& entry : entries) sizes.take(in, entry);
    const double unpacked = most_unpacked(sizes.compression, sizes.photometric == TiffSizes::kYcbcr);
    // A tile is unpacked as a whole, however small the picture is.
    const double bytes =
        std::max(sizes.width * sizes.height, sizes.tile_width * sizes.tile_height) * sizes.pixel();
    const double least = sizes.is_fax() ? sizes.height / 8 : bytes / unpacked;
    header.least_file = std::max(header.least_file, least);
    header.held = std::max(header.held, sizes.held());
    if (bytes < header.bytes) return;
    header.width = sizes.width;
    header.height = sizes.height;
    header.bytes = bytes;
}

std::optional<std::string> damage_of_profile_entry(const TiffDirectories& in, const TiffEntry& entry) {
    const bool lies_in = entry.bytes <= std::min(in.file().size(), kMostProfile) &&
                         entry.value_at + entry.bytes <= in.file().size();
    if (!lies_in) return "it lies outside of the file";
    return damage_of_icc(in.file().bytes(entry.value_at, entry.bytes));
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

// Where the directories below a page are (SubIFDs).
std::vector<std::uint64_t> places_below(const TiffDirectories& in, const TiffDirectory& directory) {
    constexpr std::uint64_t kSubIfdsTag = 330, kMostBelow = 64;
    for (const TiffEntry& entry : directory.entries)
        if (entry.tag == kSubIfdsTag) return in.values(entry, kMostBelow);
    return {};
}

}  // namespace

std::optional<PictureHeader> raw_header(const FileBytes& file) {
    const TiffDirectories in(file);
    if (in.first() == 0) return {};
    PictureHeader header;
    std::vector<std::uint64_t> places = {in.first()};
    std::set<std::uint64_t> seen;
    while (!places.empty() && seen.size() < kMostTiffDirectories) {
        const std::uint64_t at = places.back();
        places.pop_back();
        if (at == 0 || at >= file.size() || !seen.insert(at).second) continue;
        const auto directory = in.at(at);
        if (!directory) continue;  // of a kind of its maker's
        read_directory(in, directory->entries, header);
        places.push_back(directory->next);
        for (const std::uint64_t below : places_below(in, *directory)) places.push_back(below);
    }
    return header;
}

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
        for (const TiffEntry& entry : directory->entries) {
            if (entry.tag == kXmpTag && !is_plain_xmp_entry(in, entry)) hidden.insert(entry.count_at);
            if (entry.tag != kProfileTag) continue;
            if (const auto damage = damage_of_profile_entry(in, entry))
                header.profile_damage = damage, hidden.insert(entry.count_at);
        }
        at = directory->next;
    }
    header.without = with_no_values(std::move(hidden), in);
}

}  // namespace tangi
