#include "surface/painting_file/painting_reader.h"

#include <algorithm>
#include <limits>

#include "surface/base/error.h"
#include "surface/maps/reduced_surface.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/dry_part.h"
#include "surface/painting_file/file_reader.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/tiles_reader.h"

namespace tangi {

namespace {

// [pixels] A side of what is made of pixels of the painting at once, for levels that are not stored.
constexpr int kReducedAtOnce = 1024;

class SurfaceReader : public FullSizeReader {
public:
    SurfaceReader(std::shared_ptr<const Surface> surface, std::filesystem::path path)
        : FullSizeReader(std::move(path), header_of(*surface)), surface_(std::move(surface)) {}

    std::vector<Image<float>> read_part(const PartInfo& part, const Region&) const override {
        fail("{}: has no part '{}'", path().string(), part.name);
    }
    Image<float> read_heights(const Region& region, int level) const override {
        return level == 0 ? cut(surface_->height_mm, region) : FullSizeReader::read_heights(region, level);
    }
    std::vector<Region> blocks() const override { return {surface_->height_mm.region()}; }

private:
    void read_pixels(const Region& region, Surface& into, int x, int y) const override {
        paste(*surface_, region, into, x, y);
    }

    std::shared_ptr<const Surface> surface_;
};

}  // namespace

PaintingHeader header_of(const Surface& s) {
    PaintingHeader header;
    header.width = s.width();
    header.height = s.height();
    header.has_specular_colour = !s.specular_colour.empty();
    header.has_lobe_axes = !s.lobe_axes.empty();
    header.reflectance_model = s.reflectance_model;
    header.mm_per_pixel = s.mm_per_pixel;
    header.scale_known = s.scale_known;
    header.photography = s.photography;
    header.provenance = s.provenance;
    return header;
}

void describe(const PaintingHeader& header, Surface& s) {
    s.reflectance_model = header.reflectance_model;
    s.mm_per_pixel = header.mm_per_pixel;
    s.scale_known = header.scale_known;
    s.photography = header.photography;
    s.provenance = header.provenance;
}

HeightRange height_range(const Image<float>& height_mm, const Region& region) {
    HeightRange range{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) {  // what is not a number is in no comparison
            const float height = height_mm(x, y);
            if (height < range.lowest) range.lowest = height;
            if (height > range.highest) range.highest = height;
        }
    return range.lowest <= range.highest ? range : HeightRange{};
}

LevelExtent level_extent(int width, int height, int level) {
    const int up = (1 << level) - 1;
    return {(width + up) >> level, (height + up) >> level};
}

int PaintingReader::levels() const { return TileGrid(width(), height()).levels(); }

Surface PaintingReader::blank(const Region& region, int level) const {
    TP_REQUIRE(level >= 0 && level < levels() && !region.empty() && region.x0 >= 0 && region.y0 >= 0 &&
                   region.x1 <= extent(level).width && region.y1 <= extent(level).height,
               "a rectangle of a level");
    Surface s = blank_surface(header_, region.width(), region.height());
    describe(header_, s);
    const double pixel = 1 << level;
    s.mm_per_pixel = header_.mm_per_pixel * pixel;
    s.part_of = {region.x0, region.y0, width() / pixel, height() / pixel};
    return s;
}

Surface FullSizeReader::read(const Region& region, int level) const {
    Surface s = blank(region, level);
    const int step = std::max(kReducedAtOnce >> level, 1);
    for (int y = region.y0; y < region.y1; y += step)
        for (int x = region.x0; x < region.x1; x += step) {
            const Region some = {x, y, std::min(x + step, region.x1), std::min(y + step, region.y1)};
            if (level == 0) {
                read_pixels(some, s, x - region.x0, y - region.y0);
                continue;
            }
            const Region full = {some.x0 << level, some.y0 << level, std::min(some.x1 << level, width()),
                                 std::min(some.y1 << level, height())};
            Surface pixels = blank_surface(header(), full.width(), full.height());
            read_pixels(full, pixels, 0, 0);
            for (int i = 0; i < level; ++i) pixels = halved(pixels);
            paste(pixels, s, x - region.x0, y - region.y0);
        }
    return s;
}

std::vector<HeightRange> FullSizeReader::height_ranges() const {
    std::vector<HeightRange> ranges;
    for (const Region& block : blocks()) {
        const Image<float> heights = read(block, 0).height_mm;
        ranges.push_back(height_range(heights, heights.region()));
    }
    return ranges;
}

Image<float> FullSizeReader::read_heights(const Region& region, int level) const {
    constexpr int rows_at_once = 64;  // so that the other maps of a large rectangle are never there together
    Image<float> heights(region.width(), region.height());
    for (int y = region.y0; y < region.y1; y += rows_at_once) {
        const Surface rows = read({region.x0, y, region.x1, std::min(y + rows_at_once, region.y1)}, level);
        paste(rows.height_mm, rows.height_mm.region(), heights, 0, y - region.y0);
    }
    return heights;
}

std::shared_ptr<const PaintingReader> open_painting(const std::filesystem::path& path,
                                                    std::size_t cache_bytes) {
    if (is_tiled_painting(path)) return std::make_shared<TilesReader>(path, cache_bytes);
    return std::make_shared<FileReader>(path, cache_bytes);
}

std::shared_ptr<const PaintingReader> reader_of(std::shared_ptr<const Surface> surface,
                                                std::filesystem::path path) {
    return std::make_shared<SurfaceReader>(std::move(surface), std::move(path));
}

}  // namespace tangi
