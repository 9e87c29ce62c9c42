#include "surface/publish/tile_pyramid.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kWhole_px = 1024;  // of pictures of the whole

// Half the size, rounded up; means of two by two pixels.
Image<Rgb> halved(const Image<Rgb>& picture) {
    Image<Rgb> half((picture.width() + 1) / 2, (picture.height() + 1) / 2);
    for (int y = 0; y < half.height(); ++y)
        for (int x = 0; x < half.width(); ++x)
            half(x, y) = (picture.clamped(2 * x, 2 * y) + picture.clamped(2 * x + 1, 2 * y) +
                          picture.clamped(2 * x, 2 * y + 1) + picture.clamped(2 * x + 1, 2 * y + 1)) /
                         4.0f;
    return half;
}

// Levels of a picture, each half the size of the one before, down to one that has no side longer than
// `smallest_px`.
std::vector<Region> sizes_of(int width, int height, int smallest_px) {
    std::vector<Region> sizes = {{0, 0, width, height}};
    while (std::max(sizes.back().width(), sizes.back().height()) > smallest_px)
        sizes.push_back({0, 0, (sizes.back().width() + 1) / 2, (sizes.back().height() + 1) / 2});
    return sizes;
}

// Tiles of all levels, the finer ones before the coarser that is made of them: depth first, so that no more
// than four of each level are there at a time. What is so small that a picture of the whole is written is
// one.
class Pyramid {
public:
    // Told of each tile, and of where it lies in its level.
    using Take = std::function<void(int level, const Region& tile, const Image<Rgb>& picture)>;

    Pyramid(const PictureSource& source, std::vector<Region> sizes, Take take, const Progress& progress)
        : source_(source), sizes_(std::move(sizes)), take_(std::move(take)), progress_(progress) {}

    // The first level that is not larger than a picture of the whole, as a whole.
    Image<Rgb> whole(int& level) {
        level = 0;
        while (level + 1 < static_cast<int>(sizes_.size()) && longest(level) > kWhole_px) ++level;
        const Region& all = size(level);
        Image<Rgb> picture(all.width(), all.height());
        for (int y = 0; y < all.height(); y += kTile_px)
            for (int x = 0; x < all.width(); x += kTile_px) {
                const Region tile = tile_at(level, x, y);
                paste(made(level, tile), picture, x, y);
            }
        return picture;
    }

private:
    const Region& size(int level) const { return sizes_[static_cast<std::size_t>(level)]; }
    int longest(int level) const { return std::max(size(level).width(), size(level).height()); }
    Region tile_at(int level, int x, int y) const {
        return {x, y, std::min(x + kTile_px, size(level).width()),
                std::min(y + kTile_px, size(level).height())};
    }
    static void paste(const Image<Rgb>& part, Image<Rgb>& into, int x, int y) {
        for (int row = 0; row < part.height(); ++row)
            std::ranges::copy(part.row(row), into.row(y + row).begin() + x);
    }

    Image<Rgb> made(int level, const Region& tile) {
        if (level == 0) {
            report(progress_, "write tiles", static_cast<double>(done_) / static_cast<double>(tiles()));
            ++done_;
            return source_.part(tile);
        }
        Image<Rgb> finer(std::min(2 * tile.x1, size(level - 1).width()) - 2 * tile.x0,
                         std::min(2 * tile.y1, size(level - 1).height()) - 2 * tile.y0);
        for (int y = 2 * tile.y0; y < 2 * tile.y0 + finer.height(); y += kTile_px)
            for (int x = 2 * tile.x0; x < 2 * tile.x0 + finer.width(); x += kTile_px) {
                const Region below = tile_at(level - 1, x, y);
                const Image<Rgb> picture = made(level - 1, below);
                take_(level - 1, below, picture);
                paste(picture, finer, x - 2 * tile.x0, y - 2 * tile.y0);
            }
        return halved(finer);
    }
    std::size_t tiles() const {
        const auto across = [](int pixels) {
            return static_cast<std::size_t>((pixels + kTile_px - 1) / kTile_px);
        };
        return across(size(0).width()) * across(size(0).height());
    }

    const PictureSource& source_;
    std::vector<Region> sizes_;
    Take take_;
    const Progress& progress_;
    std::size_t done_ = 0;
};

Image<Rgb> cut(const Image<Rgb>& picture, const Region& region) {
    Image<Rgb> part(region.width(), region.height());
    for (int y = 0; y < part.height(); ++y)
        std::copy_n(picture.row(region.y0 + y).begin() + region.x0, part.width(), part.row(y).begin());
    return part;
}

template <class Write>
void each_tile(const Image<Rgb>& level, Write&& write) {
    for (int y = 0; y < level.height(); y += kTile_px)
        for (int x = 0; x < level.width(); x += kTile_px)
            write(
                Region{x, y, std::min(x + kTile_px, level.width()), std::min(y + kTile_px, level.height())});
}

}  // namespace

PictureSource source_of(const Image<Rgb>& encoded_srgb) {
    return {encoded_srgb.width(), encoded_srgb.height(),
            [&](const Region& region) { return cut(encoded_srgb, region); }};
}

void write_deep_zoom(const fs::path& dzi, const PictureSource& picture, const PictureStorage& storage,
                     const Progress& progress, const std::string& format) {
    const std::vector<Region> sizes = sizes_of(picture.width, picture.height, 1);
    fs::path tiles = dzi;
    tiles.replace_extension();
    tiles += "_files";
    const auto folder_of = [&](int level) {
        return tiles / std::to_string(static_cast<int>(sizes.size()) - 1 - level);
    };
    for (int level = 0; level < static_cast<int>(sizes.size()); ++level) make_folder(folder_of(level));
    const auto write = [&](int level, const Region& tile, const Image<Rgb>& drawn) {
        write_picture_8bit(
            folder_of(level) / fmt::format("{}_{}.{}", tile.x0 / kTile_px, tile.y0 / kTile_px, format), drawn,
            storage);
    };
    int level = 0;
    Image<Rgb> whole = Pyramid(picture, sizes, write, progress).whole(level);
    for (; level < static_cast<int>(sizes.size()); ++level) {
        each_tile(whole, [&](const Region& tile) { write(level, tile, cut(whole, tile)); });
        whole = halved(whole);
    }
    write_text_file(dzi,
                    fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {} -->\n"
                                "<Image xmlns=\"http://schemas.microsoft.com/deepzoom/2008\" Format=\"{}\" "
                                "Overlap=\"0\" TileSize=\"{}\"><Size Width=\"{}\" Height=\"{}\"/></Image>\n",
                                program_name(), format, kTile_px, picture.width, picture.height));
}

nlohmann::json write_iiif_image(const fs::path& folder, const std::string& id, const PictureSource& picture,
                                const PictureStorage& storage, const Progress& progress) {
    const int width = picture.width, height = picture.height;
    const std::vector<Region> levels = sizes_of(width, height, kTile_px);
    const auto write = [&](const std::string& region, const Image<Rgb>& drawn) {
        const fs::path place = folder / region / fmt::format("{},{}", drawn.width(), drawn.height()) / "0";
        make_folder(place);
        write_picture_8bit(place / "default.jpg", drawn, storage);
    };
    const auto write_tile = [&](int level, const Region& tile, const Image<Rgb>& drawn) {
        // In pixels of the whole; its border cuts the last tiles.
        const int factor = 1 << level, x = tile.x0 * factor, y = tile.y0 * factor;
        const int across = std::min(tile.width() * factor, width - x),
                  down = std::min(tile.height() * factor, height - y);
        if (across == width && down == height) return;  // the whole, below
        write(fmt::format("{},{},{},{}", x, y, across, down), drawn);
    };
    nlohmann::json factors = nlohmann::json::array(), sizes = nlohmann::json::array();
    for (std::size_t i = 0; i < levels.size(); ++i) factors.push_back(1 << i);
    int level = 0;
    Image<Rgb> whole = Pyramid(picture, levels, write_tile, progress).whole(level);
    for (; level < static_cast<int>(levels.size()); ++level) {
        each_tile(whole, [&](const Region& tile) { write_tile(level, tile, cut(whole, tile)); });
        write("full", whole);
        const nlohmann::json size = {{"width", whole.width()}, {"height", whole.height()}};
        sizes.insert(sizes.begin(), size);
        whole = halved(whole);
    }
    const nlohmann::json info = {
        {"@context", "http://iiif.io/api/image/3/context.json"},
        {"id", id},
        {"type", "ImageService3"},
        {"protocol", "http://iiif.io/api/image"},
        {"profile", "level0"},
        {"width", width},
        {"height", height},
        {"sizes", sizes},
        {"tiles", {{{"width", kTile_px}, {"height", kTile_px}, {"scaleFactors", factors}}}}};
    write_text_file(folder / "info.json", json_lines(info));
    return info;
}

}  // namespace tangi
