// tiles_conversion.cpp: a painting file as a folder of tiles, and back (painting_tiles.h).
#include <algorithm>
#include <memory>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"
#include "surface/painting_file/dry_part.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/surface_channels.h"
#include "surface/painting_file/tile_parts.h"
#include "surface/painting_file/tiles_description.h"
#include "surface/painting_file/tiles_reader.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

bool has_size_of_painting(const PartInfo& part, const PaintingReader& painting) {
    return part.width == painting.width() && part.height == painting.height();
}

std::vector<PartToWrite> parts_within(const PaintingReader& painting, const Region& region) {
    std::vector<PartToWrite> parts;
    for (PartInfo info : painting.header().parts) {
        if (!has_size_of_painting(info, painting)) continue;
        PartPlanes planes = painting.read_part(info, region);
        info.width = region.width();
        info.height = region.height();
        if (auto part = sealed(std::move(info), std::move(planes))) parts.push_back(std::move(*part));
    }
    return parts;
}

// A part of a size of its own, in memory.
PartToWrite part_of_other_size(const PaintingReader& painting, const PartInfo& info) {
    const auto planes =
        std::make_shared<PartPlanes>(info.channels.size(), Image<float>(info.width, info.height));
    read_painting_part(painting.path(), info, [&](int y0, int y1, std::span<const float* const> rows) {
        for (std::size_t c = 0; c < rows.size(); ++c)
            std::copy_n(rows[c], static_cast<std::ptrdiff_t>(y1 - y0) * info.width,
                        (*planes)[c].row(y0).data());
    });
    return {info, [planes](int y0, int y1, std::span<float* const> rows) {
                for (std::size_t c = 0; c < rows.size(); ++c) {
                    const Image<float>& plane = (*planes)[c];
                    std::copy_n(plane.row(y0).data(), static_cast<std::ptrdiff_t>(y1 - y0) * plane.width(),
                                rows[c]);
                }
            }};
}

// A part of the painting's size, read as it is written.
PartToWrite part_read_later(const PaintingReader& painting, const PartInfo& info) {
    return {info, [&painting, info](int y0, int y1, std::span<float* const> rows) {
                const PartPlanes planes = painting.read_part(info, {0, y0, painting.width(), y1});
                for (std::size_t c = 0; c < rows.size(); ++c) std::ranges::copy(planes[c].pixels(), rows[c]);
            }};
}

}  // namespace

fs::path main_file_of(const fs::path& path) {
    return is_tiled_painting(path) ? path / kTilesDescription : path;
}

std::string sha256_of_painting(const fs::path& path) { return sha256_of_file(main_file_of(path)); }

void write_tiles(const PaintingReader& painting, const fs::path& target, const Progress& progress) {
    PaintingTilesWriter::require_place(target);
    const HeldFile claim = PaintingTilesWriter::claim(target, progress);
    PaintingTilesWriter writer(target, painting.width(), painting.height(),
                               "copy of " + sha256_of_painting(painting.path()));
    const std::vector<int> missing = writer.missing(progress);
    for (std::size_t i = 0; i < missing.size(); ++i) {
        report(progress, "write tiles", static_cast<double>(i) / static_cast<double>(missing.size()));
        const PaintingTile tile = writer.grid().tile(missing[i]);
        const Region region = writer.grid().region(tile);
        writer.write(tile, painting.read(region), parts_within(painting, region));
    }
    std::vector<PartToWrite> whole;
    for (const PartInfo& info : painting.header().parts)
        if (!has_size_of_painting(info, painting)) whole.push_back(part_of_other_size(painting, info));
    writer.finish(painting.header(), whole, progress);
}

void write_file(const PaintingReader& painting, const fs::path& target, const Progress& progress) {
    AtomicFile file(target);
    std::vector<PartToWrite> parts;
    for (const PartInfo& info : painting.header().parts)
        parts.push_back(has_size_of_painting(info, painting) ? part_read_later(painting, info)
                                                             : part_of_other_size(painting, info));
    for (PartToWrite& part : parts) part.info.attributes.erase("hash");  // of tiles
    // One that came along shows paint, too.
    const auto shows = [&](const PartToWrite& part) {
        return is_overview_of(part, painting.header().dry_hash);
    };
    if (std::ranges::none_of(parts, shows)) add_overview(parts, painting);
    const PaintingHeader& header = painting.header();
    std::vector<std::uint64_t> hashes(static_cast<std::size_t>(header.height));
    Surface band;
    const auto rows = [&](int y0, int y1) {
        band = painting.read_rows(y0, y1);
        hash_all_rows(
            band, std::span(hashes).subspan(static_cast<std::size_t>(y0), static_cast<std::size_t>(y1 - y0)));
        return DryRows{&band, y0};
    };
    fill_painting(file, header, rows, parts, progress);
    if (const std::string found = joined_hash(hashes); found != header.dry_hash)
        fail("{}: the dry layer is not the one that was saved (hash {} expected, {} found)",
             painting.path().string(), shortened(header.dry_hash), found);
    file.commit();
}

}  // namespace tangi
