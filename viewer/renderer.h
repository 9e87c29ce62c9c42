// renderer.h: draws a painting with OpenGL 3.3: textures of its maps (texels.h), one shader (shaders/).
//
// Needs a current context, always the same. Memory on the device is that of the texels (21 bytes a pixel).
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>

#include "surface/surface.h"
#include "viewer/gl/objects.h"
#include "viewer/horizon.h"
#include "viewer/look.h"
#include "viewer/monitor.h"
#include "viewer/texels.h"

namespace tangi {

// Texels of a rectangle of one level of a tile, to be uploaded.
struct TexelPatch {
    int tile = 0, level = 0;
    Region region;  // of the level's texels, within the tile
    std::vector<Texel> texels;
};
std::vector<TexelPatch> patches_of(const TexelTiles& tiles, const Region& region);

class Renderer {
public:
    Renderer();

    // How large a picture this driver holds: tile_bits for TexelTiles. Throws Error for one that is too
    // large.
    int tile_bits(int width, int height) const;

    // Replaces the painting. Throws Error where the device has not the memory.
    void set_painting(const TexelTiles& tiles, double mm_per_pixel);
    void upload(const TexelPatch& patch);
    void set_horizon(const HorizonMap& horizon);
    bool has_horizon() const { return static_cast<bool>(horizon_); }
    void set_monitor(const MonitorTable& table);  // empty: none

    // Into `target` (0: the window). Encoded as sRGB, or linear.
    void draw(const Scene& scene, const Shot& shot, GLuint target, bool linear = false);
    Image<Rgb> read(const gl::Target& target) const;  // as drawn, row 0 at the top

    std::size_t uploaded_bytes() const { return uploaded_bytes_; }  // since it was made

private:
    const gl::Program& program_for(const Scene& scene, const Shot& shot, bool linear);

    int largest_layers_ = 0, largest_side_ = 0;
    gl::VertexArray nothing_;
    gl::Texture texels_, horizon_, monitor_;
    std::map<std::string, gl::Program> programs_;  // by their definitions
    int width_ = 0, height_ = 0, bits_ = 0, columns_ = 0;
    TexelRange range_;
    double mm_per_pixel_ = 1;
    std::size_t uploaded_bytes_ = 0;
};

// The picture that relight() gives, drawn by OpenGL; the same to 1/255 of white on 99.9 % of the pixels. At
// most 8 lights. Needs a current context.
Image<Rgb> relight_with(Renderer& renderer, const Surface& surface, const std::vector<Light>& lights,
                        const RelightOptions& options);

}  // namespace tangi
