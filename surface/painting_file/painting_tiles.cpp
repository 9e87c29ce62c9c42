#include "surface/painting_file/painting_tiles.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <thread>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/maps/reduced_surface.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/surface_channels.h"
#include "surface/painting_file/tile_parts.h"
#include "surface/painting_file/tiles_description.h"
#include "surface/painting_file/tiles_reader.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kExtension = ".tangi";
constexpr const char* kPartial = ".partial";
constexpr std::chrono::milliseconds kAsksAgain{100};  // of a lock that another one has
constexpr int kHashedRows =
    64;  // at once, of which a row of tiles has a whole number: 130 MB of 40000 pixels

// What a tile says it is, where a painting says its provenance.
std::string words_of_tile(const PaintingTile& tile, const std::string& made_of) {
    return json_line({{"tile", {tile.level, tile.column, tile.row}}, {"made_of", made_of}});
}

void merge(const HeightRange& part, bool is_first, HeightRange& range) {
    range.lowest = is_first ? part.lowest : std::min(range.lowest, part.lowest);
    range.highest = is_first ? part.highest : std::max(range.highest, part.highest);
}

// What all pixels are needed for: the hash of the whole, and the heights of each tile.
void look_at_rows(const fs::path& folder, const TileGrid& grid, TilesDescription& description,
                  const Progress& progress) {
    std::vector<std::uint64_t> hashes(static_cast<std::size_t>(grid.height()));
    description.heights.resize(static_cast<std::size_t>(grid.count()));
    TileRows rows(folder, grid, description.header);
    for (int y = 0; y < grid.height(); y += kHashedRows) {
        report(progress, "check tiles", y / static_cast<double>(grid.height()));
        const int end = std::min(y + kHashedRows, grid.height());
        const Surface band = rows.read(y, end);
        hash_all_rows(
            band, std::span(hashes).subspan(static_cast<std::size_t>(y), static_cast<std::size_t>(end - y)));
        for (int column = 0; column < grid.columns(); ++column) {
            const Region tile = grid.region({0, column, y / kPaintingTile});
            const int number = y / kPaintingTile * grid.columns() + column;
            merge(height_range(band.height_mm, {tile.x0, 0, tile.x1, end - y}), y == tile.y0,
                  description.heights[static_cast<std::size_t>(number)]);
        }
    }
    description.header.dry_hash = joined_hash(hashes);
}

// What a folder holds beside tiles, their description, and what programs left that were stopped.
std::optional<fs::path> first_of_others(const fs::path& folder) {
    static const std::regex own(R"(painting\.json|\d+/\d+_\d+\.exr)");
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path name = entry.path().lexically_relative(folder);
        if (entry.is_directory() || entry.path().filename().string().starts_with('.')) continue;
        if (!std::regex_match(name.generic_string(), own)) return entry.path();
    }
    return {};
}

// Files of an earlier painting of another size, and of programs that were stopped.
void remove_others(const fs::path& folder, const TileGrid& grid) {
    std::set<fs::path> own = {folder / kTilesDescription};
    for (int level = 0; level < grid.levels(); ++level)
        for (int i = 0; i < grid.count(level); ++i) own.insert(file_of(folder, grid.tile(i, level)));
    std::vector<fs::path> others;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && !own.contains(entry.path())) others.push_back(entry.path());
    for (const fs::path& other : others) fs::remove(other);
}

}  // namespace

bool names_tiled_painting(const fs::path& path) {
    return (path.has_filename() ? path : path.parent_path()).extension() == kExtension;
}

bool is_tiled_painting(const fs::path& path) {
    std::error_code unreadable;
    if (path.empty() || fs::is_regular_file(path, unreadable)) return false;
    return names_tiled_painting(path) || fs::exists(path / kTilesDescription, unreadable) ||
           (path.extension() == kPartial && names_tiled_painting(path.stem()));
}

fs::path file_of(const fs::path& folder, const PaintingTile& tile) {
    return folder / std::to_string(tile.level) / fmt::format("{}_{}.exr", tile.column, tile.row);
}

TileGrid::TileGrid(int width, int height) : width_(width), height_(height) {
    TP_REQUIRE(width > 0 && height > 0, "a painting has pixels");
}

int TileGrid::levels() const {
    int levels = 1;
    while (count(levels - 1) > 1) ++levels;
    return levels;
}

int TileGrid::columns(int level) const {
    return (level_extent(width_, height_, level).width + kPaintingTile - 1) / kPaintingTile;
}

int TileGrid::rows(int level) const {
    return (level_extent(width_, height_, level).height + kPaintingTile - 1) / kPaintingTile;
}

PaintingTile TileGrid::tile(int number, int level) const {
    return {level, number % columns(level), number / columns(level)};
}

Region TileGrid::region(const PaintingTile& tile) const {
    const LevelExtent extent = level_extent(width_, height_, tile.level);
    const int x = tile.column * kPaintingTile, y = tile.row * kPaintingTile;
    return {x, y, std::min(x + kPaintingTile, extent.width), std::min(y + kPaintingTile, extent.height)};
}

void PaintingTilesWriter::require_place(const fs::path& target) {
    if (!names_tiled_painting(target))
        fail("{}: a painting of tiles is a folder whose name ends in {}", target.string(), kExtension);
    for (const fs::path& folder : {target, partial_of(target)}) {
        if (!fs::exists(folder)) continue;
        const auto other = fs::is_directory(folder) ? first_of_others(folder) : std::optional(folder);
        if (other)
            fail(
                "{}: is there, and holds what is no painting of tiles ({}); choose another name, or move "
                "that "
                "away",
                folder.string(), other->filename().string());
    }
    fs::path parent = target.parent_path();
    if (parent.empty()) parent = ".";
    if (!fs::is_directory(parent))
        fail("{}: there is no folder {}; make it, or choose another place", target.string(), parent.string());
    if (::access(parent.c_str(), W_OK | X_OK) != 0)
        fail("{}: cannot be written in {}: {}; choose another place", target.string(), parent.string(),
             std::strerror(errno));
}

HeldFile PaintingTilesWriter::claim(const fs::path& target, const Progress& progress) {
    const std::string name = target.filename().string();
    const fs::path file = target.parent_path() / ("." + name + ".lock");
    const std::string stage = "wait for who writes " + name;
    HeldFile claim;
    while (claim.take(file) == HeldFile::Taken::by_another) {
        report(progress, stage, 0);
        std::this_thread::sleep_for(kAsksAgain);
    }
    return claim;
}

fs::path PaintingTilesWriter::partial_of(const fs::path& target) {
    fs::path partial = target;
    partial += kPartial;
    return partial;
}

PaintingTilesWriter::PaintingTilesWriter(fs::path target, int width, int height, std::string made_of)
    : target_(std::move(target)),
      partial_(partial_of(target_)),
      grid_(width, height),
      made_of_(std::move(made_of)) {
    require_place(target_);
    for (int level = 0; level < grid_.levels(); ++level) make_folder(partial_ / std::to_string(level));
}

void PaintingTilesWriter::store(const PaintingTile& tile, Surface surface,
                                std::span<const PartToWrite> parts) {
    const Region region = grid_.region(tile);
    TP_REQUIRE(surface.width() == region.width() && surface.height() == region.height(),
               "a tile has the size of its region");
    surface.provenance = words_of_tile(tile, made_of_);
    surface.photography = {};
    AtomicFile file(file_of(partial_, tile));
    write_painting(file, surface, parts);
}

void PaintingTilesWriter::write(const PaintingTile& tile, Surface surface,
                                std::span<const PartToWrite> parts) {
    TP_REQUIRE(tile.level == 0, "coarser levels are made of level 0");
    std::vector<PartToWrite> kept;
    for (const PartToWrite& part : parts)
        if (auto with_hash = sealed(part.info, filled(part))) kept.push_back(std::move(*with_hash));
    store(tile, std::move(surface), kept);
}

bool PaintingTilesWriter::holds(const PaintingTile& tile, const Surface& surface,
                                std::span<const PartToWrite> parts) const {
    if (state(tile) != TileState::valid) return false;
    const fs::path file = file_of(partial_, tile);
    TP_REQUIRE(DryPart(file).header().dry_hash == hash_of(surface), "words tell the surface");
    // Parts of the whole lie in a tile, too, where it is the only one of the coarsest level.
    std::vector<PartInfo> there = painting_parts(file);
    std::erase_if(there, [&](const PartInfo& part) {
        return part.width != surface.width() || part.height != surface.height();
    });
    return std::ranges::equal(there, parts, [](const PartInfo& a, const PartToWrite& b) {
        return a.name == b.info.name && a.channels == b.info.channels && a.attributes == b.info.attributes;
    });
}

void PaintingTilesWriter::write_if_other(const PaintingTile& tile, Surface surface,
                                         std::span<const PartToWrite> sealed_parts) {
    TP_REQUIRE(tile.level == 0, "coarser levels are made of level 0");
    if (holds(tile, surface, sealed_parts)) return;
    store(tile, std::move(surface), sealed_parts);
}

TileState PaintingTilesWriter::state_in(const fs::path& folder, const PaintingTile& tile) const {
    const fs::path file = file_of(folder, tile);
    if (!fs::exists(file)) return TileState::missing;
    try {
        const nlohmann::json said = json_or_discarded(DryPart(file).header().provenance);
        if (!said.is_object() || said.value("made_of", nlohmann::json()) != made_of_)
            return TileState::foreign;
        read_tile(folder, grid_, tile);
        for (const PartInfo& part : painting_parts(file)) checked_planes(file, part);
        return TileState::valid;
    } catch (const Error&) {
        return TileState::damaged;
    }
}

TileState PaintingTilesWriter::state(const PaintingTile& tile) const {
    const TileState here = state_in(partial_, tile);
    if (here == TileState::valid || state_in(target_, tile) != TileState::valid) return here;
    std::error_code failed;
    const fs::path from = file_of(target_, tile), to = file_of(partial_, tile);
    fs::remove(to, failed);
    fs::create_hard_link(from, to, failed);
    if (failed && !fs::exists(to)) {  // a file system without links
        AtomicFile copy(to);
        copy.copy_from(from);
        copy.commit();
    }
    return TileState::valid;
}

std::vector<int> PaintingTilesWriter::missing(const Progress& progress) const {
    std::vector<int> missing;
    for (int i = 0; i < grid_.count(); ++i) {
        report(progress, "look for tiles", i / static_cast<double>(grid_.count()));
        if (state(grid_.tile(i)) != TileState::valid) missing.push_back(i);
    }
    return missing;
}

void PaintingTilesWriter::reduce(int level, int first, int end, const Progress& progress) {
    TP_REQUIRE(level > 0 && level < grid_.levels() && first >= 0 && end <= grid_.count(level),
               "tiles of a coarser level");
    for (int i = first; i < end; ++i) {
        report(progress, "levels of detail", (i - first) / static_cast<double>(end - first));
        const PaintingTile tile = grid_.tile(i, level);
        if (state(tile) == TileState::valid) continue;
        const Region region = grid_.region(tile);
        std::optional<Surface> mean;
        for (int below = 0; below < 4; ++below) {
            const PaintingTile finer{level - 1, 2 * tile.column + below % 2, 2 * tile.row + below / 2};
            if (finer.column >= grid_.columns(level - 1) || finer.row >= grid_.rows(level - 1)) continue;
            const Surface half = halved(read_tile(partial_, grid_, finer));
            if (!mean) {
                mean = blank_surface(header_of(half), region.width(), region.height());
                describe(header_of(half), *mean);
            }
            paste(half, *mean, below % 2 * kPaintingTile / 2, below / 2 * kPaintingTile / 2);
        }
        store(tile, std::move(*mean), {});
    }
}

void PaintingTilesWriter::require_tiles(const Progress& progress) const {
    const std::vector<int> left = missing(progress);
    if (left.empty()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(left.size(), 3); ++i) {
        const PaintingTile tile = grid_.tile(left[i]);
        names += fmt::format("{}{}_{}.exr", i > 0 ? ", " : "", tile.column, tile.row);
    }
    fail(
        "{}: {} of {} tiles are missing or damaged ({}{}); make them with the same command, which keeps the "
        "others",
        partial_.string(), left.size(), grid_.count(), names, left.size() > 3 ? ", …" : "");
}

void PaintingTilesWriter::add_whole_parts(std::span<const PartToWrite> whole) {
    const PaintingTile coarsest{grid_.levels() - 1, 0, 0};
    const fs::path file = file_of(partial_, coarsest);
    std::vector<PartToWrite> parts;
    for (const PartInfo& part : painting_parts(file))
        if (std::ranges::none_of(whole, [&](const auto& w) { return w.info.name == part.name; }))
            if (auto kept = sealed(part, checked_planes(file, part))) parts.push_back(std::move(*kept));
    for (const PartToWrite& part : whole) {
        auto kept = sealed(part.info, filled(part));
        if (kept)
            parts.push_back(std::move(*kept));
        else
            parts.push_back(part);
    }
    store(coarsest, read_tile(partial_, grid_, coarsest), parts);
}

void PaintingTilesWriter::complete(const PaintingHeader& header, std::span<const PartToWrite> whole,
                                   const Progress& progress) {
    require_tiles(progress);
    TilesDescription description{header, made_of_, {}, {}};
    PaintingHeader& h = description.header;
    std::vector<PartInfo> parts = parts_of_tiles(partial_, grid_);
    for (const PartToWrite& part : whole) parts.push_back(part.info);
    h.parts = in_order_of(header.parts, std::move(parts));
    for (int level = 1; level < grid_.levels(); ++level) reduce(level, 0, grid_.count(level), progress);
    if (!whole.empty()) add_whole_parts(whole);
    const PaintingHeader first = DryPart(file_of(partial_, {})).header();
    h.width = grid_.width();
    h.height = grid_.height();
    h.has_specular_colour = first.has_specular_colour;
    h.has_lobe_axes = first.has_lobe_axes;
    h.mm_per_pixel = kept_scale_mm(h.mm_per_pixel);
    for (int level = 0; level < grid_.levels(); ++level) {
        auto& hashes = description.hashes.emplace_back();
        for (int i = 0; i < grid_.count(level); ++i)
            hashes.push_back(DryPart(file_of(partial_, grid_.tile(i, level))).header().dry_hash);
    }
    look_at_rows(partial_, grid_, description, progress);
    remove_others(partial_, grid_);
    report(progress, "check tiles", 1);  // the last chance to stop
    write_text_file(partial_ / kTilesDescription, words_of(description));
}

void PaintingTilesWriter::finish(const PaintingHeader& header, std::span<const PartToWrite> whole,
                                 const Progress& progress) {
    complete(header, whole, progress);
    put_in_place();
}

// An older painting is gone once this one is in its place.
void PaintingTilesWriter::put_in_place() {
    std::error_code status;
    if (!fs::exists(target_)) {
        fs::rename(partial_, target_, status);
    } else if (exchange_folders(partial_, target_)) {
        fs::remove_all(partial_, status);
    } else {
        fail("{}: cannot be put in place: {}", target_.string(), std::strerror(errno));
    }
    if (status) fail("{}: cannot be put in place: {}", target_.string(), status.message());
    const fs::path parent = target_.parent_path();
    sync_folder(parent.empty() ? fs::path(".") : parent, target_);
}

}  // namespace tangi
