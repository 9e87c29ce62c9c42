// renderer_textures.cpp: what the renderer keeps on the device: tiles, horizons, the monitor's colours.
#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/error.h"
#include "viewer/render/renderer.h"
#include "viewer/render/view.h"

namespace tangi {

namespace {

constexpr std::size_t kTileBytes = kTileTexels * sizeof(Texel);
constexpr std::size_t kFewestLayers = 16;  // a piece of 256 x 256 pixels needs 14 at most
constexpr int kFirstLayers = 128;          // a screen of 1920 x 1080 and what is around it
constexpr std::size_t kMostLayers = 2047;  // that the table's 11 bits tell apart
constexpr std::size_t kTableWidth = 1024;  // as in surface.glsl
// So do tiles lie in a layer: as strips of columns, one below the other.
constexpr int kStripBits = 4, kStripSide = 1 << kStripBits, kStrips = kTileSide / kStripSide;

int device_limit(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

// Texels of a tile into its layer of the texture that is bound. `r`: within the tile.
void put(std::span<const Texel> tile, const Region& r, int layer) {
    glPixelStorei(GL_UNPACK_ROW_LENGTH, kTileSide);
    for (int strip = r.x0 >> kStripBits; strip << kStripBits < r.x1; ++strip) {
        const int left = strip << kStripBits;
        const int x0 = std::max(r.x0, left), x1 = std::min(r.x1, left + kStripSide);
        glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, x0 - left, strip * kTileSide + r.y0, layer, x1 - x0,
                        r.height(), 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                        &tile[static_cast<std::size_t>((r.y0 << kTileBits) + x0)]);
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

std::size_t tile_megabytes(int tiles) { return static_cast<std::size_t>(tiles) * kTileBytes >> 20; }

}  // namespace

Renderer::Renderer(std::size_t texel_bytes) : nothing_(gl::make_vertex_array()) {
    const std::size_t tiles = std::max<std::size_t>(texel_bytes / kTileBytes, kFewestLayers);
    largest_layers_ = static_cast<int>(std::min<std::size_t>(
        {tiles, static_cast<std::size_t>(device_limit(GL_MAX_ARRAY_TEXTURE_LAYERS)), kMostLayers}));
}

bool Renderer::allocated(int layers) {
    texels_ = gl::make_texture();
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, 0);
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA32UI, kStripSide, kStrips * kTileSide, layers, 0,
                 GL_RGBA_INTEGER, GL_UNSIGNED_INT, nullptr);
    const GLenum error = glGetError();
    TP_REQUIRE(error == GL_NO_ERROR || error == GL_OUT_OF_MEMORY,
               fmt::format("OpenGL error {:#x} for texels", error));
    return error == GL_NO_ERROR;
}

// As many as are wanted, or as there is memory for.
void Renderer::make_layers(int wanted) {
    const int all = TileCache(tiles_->width(), tiles_->height(), 1).all();
    int layers = std::min({wanted, largest_layers_, all});
    while (!allocated(layers)) {
        largest_layers_ = std::max(layers / 2, 1);
        if (layers <= static_cast<int>(kFewestLayers))
            fail("the graphics device has not enough memory for this painting: {} MB are needed at least",
                 tile_megabytes(layers));
        layers = largest_layers_;
    }
    cache_ = TileCache(tiles_->width(), tiles_->height(), layers);
}

void Renderer::set_painting(std::shared_ptr<const TexelTiles> tiles, double mm_per_pixel) {
    TP_REQUIRE(tiles, "there is a painting");
    tiles_ = std::move(tiles);
    mm_per_pixel_ = mm_per_pixel;
    horizon_ = {};
    make_layers(kFirstLayers);
    table_ = gl::make_texture();
    glBindTexture(GL_TEXTURE_2D, table_.id());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    fetch(std::span<const TileView>(), 1, false);  // what stands in for all others
    gl::require_no_error("for this painting");
}

Renderer::Fetched Renderer::fetch(std::span<const TileView> views, std::size_t most_tiles, bool guest) {
    TileCache::Wanted wanted = cache_.want(views, most_tiles, guest);
    // Memory for tiles is taken as it is needed: a software renderer's is the machine's.
    while (!wanted.roomy && cache_.layers() < std::min(largest_layers_, cache_.all())) {
        make_layers(2 * cache_.layers());
        wanted = cache_.want(views, SIZE_MAX, guest);  // what was there is to be fetched again
    }
    if (wanted.placed.empty()) return {wanted.complete, wanted.exact};
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
    for (const auto& [tile, layer] : wanted.placed) {
        const auto held = tiles_->lock();
        put(tiles_->tile(tile), {0, 0, kTileSide, kTileSide}, layer);
        uploaded_.tiles += kTileBytes;
    }
    std::vector<std::uint32_t> table = cache_.table();
    const std::size_t rows = (table.size() + kTableWidth - 1) / kTableWidth;
    table.resize(rows * kTableWidth);
    glBindTexture(GL_TEXTURE_2D, table_.id());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, kTableWidth, static_cast<GLsizei>(rows), 0, GL_RED_INTEGER,
                 GL_UNSIGNED_INT, table.data());
    return {wanted.complete, wanted.exact};
}

Renderer::Fetched Renderer::fetch(const Scene& scene, const Shot& shot, std::size_t most_bytes, bool guest) {
    TP_REQUIRE(tiles_, "there is a painting to draw");
    std::vector<TileView> views = {{shot.level, outline_of(shot)}};
    if (traits_of(scene.mode).coarser_levels > 0)
        views.push_back({shot.level + static_cast<int>(scene.sharpness), views.front().outline});
    if (scene.shadows == Shadows::marched) {
        const double right = tiles_->width(), bottom = tiles_->height();
        views.push_back({0, {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}}});
    }
    return fetch(views, std::max<std::size_t>(most_bytes / kTileBytes, 1), guest);
}

void Renderer::upload(const Region& changed) {
    if (!tiles_) return;
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
    for (int level = 0; level < tiles_->levels(); ++level) {
        const Region all = tiles_->region_at(level, changed);
        for (int row = all.y0 >> kTileBits; row << kTileBits < all.y1; ++row)
            for (int column = all.x0 >> kTileBits; column << kTileBits < all.x1; ++column) {
                const TileName tile{level, column, row};
                const auto layer = cache_.layer_of(tile);
                if (!layer) continue;
                const auto inside = [](int v, int at) {
                    return std::clamp(v - (at << kTileBits), 0, kTileSide);
                };
                const Region r = {inside(all.x0, column), inside(all.y0, row), inside(all.x1, column),
                                  inside(all.y1, row)};
                const auto held = tiles_->lock();
                put(tiles_->tile(tile), r, *layer);
                uploaded_.changes += static_cast<std::size_t>(r.width()) *
                                     static_cast<std::size_t>(r.height()) * sizeof(Texel);
            }
    }
}

void Renderer::set_horizon(const HorizonMap& map) {
    if (!horizon_) horizon_ = gl::make_texture();
    glBindTexture(GL_TEXTURE_3D, horizon_.id());
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_REPEAT);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R8, map.width, map.height, HorizonMap::kAzimuths, 0, GL_RED,
                 GL_UNSIGNED_BYTE, map.values.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    uploaded_.horizons += map.values.size();
    horizon_map_ = map;
    light_horizons_ = {};
    light_azimuths_deg_.clear();
    gl::require_no_error("for cast shadows");
}

// A layer of light_horizons_ for each light, whose direction is the same everywhere.
void Renderer::towards_lights(const std::vector<Light>& lights) {
    const int width = horizon_map_.width, height = horizon_map_.height;
    glActiveTexture(GL_TEXTURE4);
    if (!light_horizons_ || light_azimuths_deg_.size() != lights.size()) {
        light_horizons_ = gl::make_texture();
        light_azimuths_deg_.assign(lights.size(), std::numeric_limits<double>::quiet_NaN());
        glBindTexture(GL_TEXTURE_2D_ARRAY, light_horizons_.id());
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R16, width, height, static_cast<GLsizei>(lights.size()), 0,
                     GL_RED, GL_UNSIGNED_SHORT, nullptr);
    }
    glBindTexture(GL_TEXTURE_2D_ARRAY, light_horizons_.id());
    std::vector<std::uint16_t> roots;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double azimuth_deg = angles_of(lights[i].direction).azimuth_deg;
        if (light_azimuths_deg_[i] == azimuth_deg) continue;
        light_azimuths_deg_[i] = azimuth_deg;
        roots.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        horizon_towards(horizon_map_, azimuth_deg, roots);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
        glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(i), width, height, 1, GL_RED,
                        GL_UNSIGNED_SHORT, roots.data());
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    }
}

void Renderer::set_monitor(const MonitorTable& table) {
    monitor_ = {};
    if (table.side == 0) return;
    monitor_ = gl::make_texture();
    glBindTexture(GL_TEXTURE_3D, monitor_.id());
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGB16, table.side, table.side, table.side, 0, GL_RGB, GL_UNSIGNED_SHORT,
                 table.rgb.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl::require_no_error("for the monitor's colours");
}

}  // namespace tangi
