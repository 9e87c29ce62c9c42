// renderer.h: draws a painting with OpenGL 3.3: its texels (texels.h) in tiles, one shader (shaders/).
//
// The device holds the tiles that are seen and as many of those seen before as its share of memory allows;
// where one is missing, the next coarser one stands in. So no painting is too large for a texture.
//
// Needs a current context, always the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "surface/maps/surface.h"
#include "viewer/render/display_profile.h"
#include "viewer/render/horizon.h"
#include "viewer/render/objects.h"
#include "viewer/render/scene.h"
#include "viewer/render/texels.h"
#include "viewer/render/tile_cache.h"

namespace tangi {

struct UploadedBytes {
    std::size_t tiles = 0;     // that came into sight
    std::size_t changes = 0;   // of tiles that were there
    std::size_t horizons = 0;  // for cast shadows
};

constexpr std::size_t kTexelBytes = std::size_t(512) << 20;  // of memory on the device for texels

class Renderer {
public:
    // Keeps to so much memory, and to less where the device has less.
    explicit Renderer(std::size_t texel_bytes = kTexelBytes);

    // Replaces the painting. Its tiles are fetched as they are needed, under their lock. Throws Error where
    // the device has not the memory for a few.
    void set_painting(std::shared_ptr<const TexelTiles> tiles, double mm_per_pixel);
    void upload(const Region& changed);  // these pixels, as far as the device holds them
    void set_horizon(const HorizonMap& horizon);
    bool has_horizon() const { return static_cast<bool>(horizon_); }
    void set_monitor(const MonitorTable& table);  // empty: none

    struct Fetched {
        bool complete = false;  // nothing is missing any more for which there is room
        bool exact = false;     // every pixel has texels of the shot's own level
    };
    // What is seen, `most_bytes` of it and one tile at least. `guest`: beside the picture that is seen
    // (tile_cache.h).
    Fetched fetch(const Scene& scene, const Shot& shot, std::size_t most_bytes = SIZE_MAX,
                  bool guest = false);

    // Into `target` (0: the window), with the tiles that are there; the shot's lower left corner is at
    // `corner` of it. Encoded as sRGB, or linear. A target that holds sRGB (gl::Target of 8 bits, most
    // windows) has the device encode it.
    void draw(const Scene& scene, const Shot& shot, GLuint target, bool linear = false,
              const glm::ivec2& corner = {0, 0});
    // Draws with the shader that looks tiles up in a table, as draw() does while some are missing: drivers
    // compile it then.
    void draw_by_table(const Scene& scene, const Shot& shot, GLuint target);
    Image<Rgb> read(const gl::Target& target) const;  // as drawn, row 0 at the top

    const UploadedBytes& uploaded() const { return uploaded_; }  // since it was made
    const TileCache& cache() const { return cache_; }

private:
    using Homes = std::optional<TileCache::Homes>;
    const gl::Program& program_for(const Scene& scene, const Shot& shot, bool linear, bool by_table,
                                   bool bare = false);
    void draw_background(const Scene& scene, bool linear);
    Fetched fetch(std::span<const TileView> views, std::size_t most_tiles, bool guest);
    void draw(const Scene& scene, const Shot& shot, GLuint target, bool linear, const glm::ivec2& corner,
              const Homes& homes);
    void bind_textures() const;
    void make_layers(int wanted);
    void towards_lights(const std::vector<Light>& lights);
    bool allocated(int layers);

    int largest_layers_ = 0;
    gl::VertexArray nothing_;
    gl::Texture texels_, table_, horizon_, light_horizons_, monitor_;
    HorizonMap horizon_map_;
    std::vector<double> light_azimuths_deg_;       // of the layers of light_horizons_
    std::map<std::string, gl::Program> programs_;  // by their definitions
    std::shared_ptr<const TexelTiles> tiles_;
    TileCache cache_;
    double mm_per_pixel_ = 1;
    UploadedBytes uploaded_;
};

// The picture that relight() gives, drawn by OpenGL; the same to 1/255 of white on 99.9 % of the pixels. At
// most 8 lights. Drawn piece by piece, so that it may be of any size; with cast shadows the whole painting
// must fit on the device (Error where it does not).
Image<Rgb> relight_with(Renderer& renderer, const Surface& surface, const std::vector<Light>& lights,
                        const RelightOptions& options);

}  // namespace tangi
