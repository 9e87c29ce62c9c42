#include "surface/painting_file/painting_output.h"

#include <algorithm>
#include <utility>

#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/tile_parts.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// All that tiles have of a surface, and its levels of detail.
std::string words_of(const Surface& s) {
    return fmt::format("{} {} {} {}", hash_of(s), s.mm_per_pixel, s.reflectance_model.diffuse_roughness,
                       s.reflectance_model.second_lobe_weight);
}

bool covers(const PartToWrite& part, const Surface& surface) {
    return part.info.width == surface.width() && part.info.height == surface.height();
}

// The rows of a part that a row of tiles has.
PartToWrite rows_of(const PartToWrite& part, int y0, int y1) {
    PartToWrite rows = part;
    rows.info.height = y1 - y0;
    rows.fill = [&part, y0](int first, int end, std::span<float* const> planes) {
        part.fill(y0 + first, y0 + end, planes);
    };
    return rows;
}

}  // namespace

bool names_painting(const fs::path& path) {
    return names_tiled_painting(path) || lower_extension(path) == ".exr";
}

PaintingOutput::PaintingOutput(fs::path target) : target_(std::move(target)) {
    if (names_tiled_painting(target_)) {
        if (!target_.has_filename()) target_ = target_.parent_path();
        if (fs::is_symlink(target_)) target_ = fs::weakly_canonical(target_);  // as with files
    }
    if (names_tiled_painting(target_))
        PaintingTilesWriter::require_place(target_);
    else
        file_.emplace(target_);
}

void PaintingOutput::fill(const Surface& surface, std::vector<PartToWrite> parts, const Progress& progress) {
    const auto overview = std::ranges::find_if(parts, is_overview);
    if (!file_) {  // levels of detail are one
        if (overview != parts.end()) parts.erase(overview);
        return fill_tiles(surface, parts, progress);
    }
    if (overview == parts.end()) add_overview(parts, surface, surface);
    fill_painting(*file_, surface, parts, progress);
}

void PaintingOutput::fill_tiles(const Surface& surface, std::span<const PartToWrite> parts,
                                const Progress& progress) {
    claim_ = PaintingTilesWriter::claim(target_, progress);
    PaintingTilesWriter writer(target_, surface.width(), surface.height(), words_of(surface));
    std::vector<PartPlanes> bands;  // of each part that covers the surface, of a row of tiles
    for (int i = 0, row = -1; i < writer.grid().count(); ++i) {
        report(progress, "write tiles", i / static_cast<double>(writer.grid().count()));
        const PaintingTile tile = writer.grid().tile(i);
        const Region region = writer.grid().region(tile);
        if (std::exchange(row, tile.row) != tile.row) {
            bands.clear();
            for (const PartToWrite& part : parts)
                if (covers(part, surface)) bands.push_back(filled(rows_of(part, region.y0, region.y1)));
        }
        std::vector<PartToWrite> own;
        std::size_t covering = 0;
        for (const PartToWrite& part : parts) {
            if (!covers(part, surface)) continue;
            PartPlanes planes;
            for (const Image<float>& plane : bands[covering++])
                planes.push_back(cut(plane, {region.x0, 0, region.x1, region.height()}));
            PartInfo info = part.info;
            info.width = region.width(), info.height = region.height();
            if (auto kept = sealed(std::move(info), std::move(planes))) own.push_back(std::move(*kept));
        }
        writer.write_if_other(tile, cut(surface, region), own);
    }
    std::vector<PartToWrite> whole;
    std::ranges::copy_if(parts, std::back_inserter(whole),
                         [&](const PartToWrite& part) { return !covers(part, surface); });
    PaintingHeader header = header_of(surface);
    for (const PartToWrite& part : parts) header.parts.push_back(part.info);
    writer.complete(header, whole, progress);
}

void PaintingOutput::add_to(OutputSet& set) {
    if (file_)
        set.add(*file_);
    else
        set.add_folder(PaintingTilesWriter::partial_of(target_), target_,
                       [this](bool) { claim_.give_back(); });
}

}  // namespace tangi
