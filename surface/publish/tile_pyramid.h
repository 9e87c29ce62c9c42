// tile_pyramid.h: pictures as tiles in several sizes, as files that a web server only has to hand out: Deep
// Zoom, and the IIIF Image API 3 at level 0.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "surface/base/progress.h"
#include "surface/image_file/image_io.h"

namespace tangi {

constexpr int kTile_px = 512;  // without the overlap, of which there is none

// A picture that may never be in memory as a whole: `part` gives a rectangle of it, sRGB-encoded, 0..1. Each
// rectangle is asked for once, tiles that lie together one after the other.
struct PictureSource {
    int width = 0, height = 0;
    std::function<Image<Rgb>(const Region& region)> part;
};
PictureSource source_of(const Image<Rgb>& encoded_srgb);  // which must live as long

// NAME.dzi, and NAME_files/LEVEL/COLUMN_ROW.FORMAT (jpg, png) from one pixel up to the whole. Takes the
// memory of four tiles of each level. Throws Error where the files cannot be written.
void write_deep_zoom(const std::filesystem::path& dzi, const PictureSource& picture,
                     const PictureStorage& storage = {}, const Progress& progress = {},
                     const std::string& format = "jpg");

// FOLDER/info.json, REGION/SIZE/0/default.jpg of all tiles, and full/SIZE/0/default.jpg of the whole in sizes
// of up to 1024 pixels. `id`: the address at which the folder will be. Returns what is in info.json. Memory
// is as above.
nlohmann::json write_iiif_image(const std::filesystem::path& folder, const std::string& id,
                                const PictureSource& picture, const PictureStorage& storage = {},
                                const Progress& progress = {});

}  // namespace tangi
