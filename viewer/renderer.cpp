#include "viewer/renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <numbers>

#include "surface/error.h"
#include "viewer/shaders.h"
#include "viewer/view.h"

namespace tangi {

namespace {

constexpr const char* kDesktop = "#version 330 core\n";
constexpr std::size_t kTileBytes = kTileTexels * sizeof(Texel);
constexpr std::size_t kFewestLayers = 16;  // a piece of 256 x 256 pixels needs 14 at most
constexpr int kFirstLayers = 128;          // a screen of 1920 x 1080 and what is around it
constexpr std::size_t kMostLayers = 2047;  // that the table's 11 bits tell apart
constexpr std::size_t kTableWidth = 1024;  // as in surface.glsl

void check(const char* what) {
    GLenum error = GL_NO_ERROR;
    for (GLenum next = glGetError(); next != GL_NO_ERROR; next = glGetError()) error = next;
    if (error == GL_OUT_OF_MEMORY) fail("the graphics device has not enough memory {}", what);
    TP_REQUIRE(error == GL_NO_ERROR, fmt::format("OpenGL error {:#x} {}", error, what));
}

int integer(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

std::size_t megabytes(int tiles) { return static_cast<std::size_t>(tiles) * kTileBytes >> 20; }

bool has_near(const Scene& scene) {
    return std::ranges::any_of(scene.lights,
                               [](const Light& light) { return light.position_mm.has_value(); });
}

// Light comes from the same direction everywhere.
bool all_far(const Scene& scene) {
    return !scene.lights.empty() && !has_near(scene) && scene.rig.bend_per_mm == 0;
}

// Of the framebuffer that is bound, an object: it encodes what is drawn.
bool holds_srgb() {
    GLint encoding = GL_LINEAR;
    glGetFramebufferAttachmentParameteriv(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                                          GL_FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING, &encoding);
    return encoding == GL_SRGB;
}

class Uniforms {
public:
    explicit Uniforms(GLuint program) : program_(program) {}
    void set(const char* name, int v) const { glUniform1i(at(name), v); }
    void set(const char* name, const std::vector<int>& v) const {
        glUniform1iv(at(name), static_cast<GLsizei>(v.size()), v.data());
    }
    void set(const char* name, float v) const { glUniform1f(at(name), v); }
    void set(const char* name, int x, int y) const { glUniform2i(at(name), x, y); }
    void set(const char* name, const glm::ivec4& v) const { glUniform4iv(at(name), 1, glm::value_ptr(v)); }
    void set(const char* name, const glm::vec2& v) const { glUniform2fv(at(name), 1, glm::value_ptr(v)); }
    void set(const char* name, const glm::vec3& v) const { glUniform3fv(at(name), 1, glm::value_ptr(v)); }
    void set(const char* name, const glm::vec4& v) const { glUniform4fv(at(name), 1, glm::value_ptr(v)); }
    void set(const char* name, const glm::mat3& m) const {
        glUniformMatrix3fv(at(name), 1, GL_FALSE, glm::value_ptr(m));
    }
    void set(const char* name, const std::vector<glm::vec2>& v) const {
        glUniform2fv(at(name), static_cast<GLsizei>(v.size()), glm::value_ptr(v.front()));
    }
    void set(const char* name, const std::vector<glm::vec4>& v) const {
        glUniform4fv(at(name), static_cast<GLsizei>(v.size()), glm::value_ptr(v.front()));
    }
    void set(const char* name, const std::vector<glm::vec3>& v) const {
        glUniform3fv(at(name), static_cast<GLsizei>(v.size()), glm::value_ptr(v.front()));
    }

private:
    GLint at(const char* name) const { return glGetUniformLocation(program_, name); }
    GLuint program_;
};

}  // namespace

Renderer::Renderer(std::size_t texel_bytes) : nothing_(gl::make_vertex_array()) {
    const std::size_t tiles = std::max<std::size_t>(texel_bytes / kTileBytes, kFewestLayers);
    largest_layers_ = static_cast<int>(std::min<std::size_t>(
        {tiles, static_cast<std::size_t>(integer(GL_MAX_ARRAY_TEXTURE_LAYERS)), kMostLayers}));
}

bool Renderer::allocated(int layers) {
    texels_ = gl::make_texture();
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, 0);
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA32UI, kTileSide, kTileSide, layers, 0, GL_RGBA_INTEGER,
                 GL_UNSIGNED_INT, nullptr);
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
                 megabytes(layers));
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
    check("for this painting");
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
        glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, layer, kTileSide, kTileSide, 1, GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, tiles_->tile(tile).data());
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
    if (scene.mode == LookMode::unsharp_normals)
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
    glPixelStorei(GL_UNPACK_ROW_LENGTH, kTileSide);
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
                glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, r.x0, r.y0, *layer, r.width(), r.height(), 1,
                                GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                                &tiles_->tile(tile)[static_cast<std::size_t>((r.y0 << kTileBits) + r.x0)]);
                uploaded_.changes += static_cast<std::size_t>(r.width()) *
                                     static_cast<std::size_t>(r.height()) * sizeof(Texel);
            }
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
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
    lamp_horizons_ = {};
    lamp_azimuths_deg_.clear();
    check("for cast shadows");
}

// A layer of lamp_horizons_ for each light, whose direction is the same everywhere.
void Renderer::towards_lamps(const std::vector<Light>& lights) {
    const int width = horizon_map_.width, height = horizon_map_.height;
    glActiveTexture(GL_TEXTURE4);
    if (!lamp_horizons_ || lamp_azimuths_deg_.size() != lights.size()) {
        lamp_horizons_ = gl::make_texture();
        lamp_azimuths_deg_.assign(lights.size(), std::numeric_limits<double>::quiet_NaN());
        glBindTexture(GL_TEXTURE_2D_ARRAY, lamp_horizons_.id());
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R16, width, height, static_cast<GLsizei>(lights.size()), 0,
                     GL_RED, GL_UNSIGNED_SHORT, nullptr);
    }
    glBindTexture(GL_TEXTURE_2D_ARRAY, lamp_horizons_.id());
    std::vector<std::uint16_t> roots;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double azimuth_deg = angles_of(lights[i].direction).azimuth_deg;
        if (lamp_azimuths_deg_[i] == azimuth_deg) continue;
        lamp_azimuths_deg_[i] = azimuth_deg;
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
    check("for the monitor's colours");
}

const gl::Program& Renderer::program_for(const Scene& scene, const Shot& shot, bool linear, bool by_table) {
    Shadows shadows = scene.shadows;
    if (tiles_->width() < 2 || tiles_->height() < 2 || (shadows == Shadows::horizon && !horizon_))
        shadows = Shadows::none;
    const bool near = has_near(scene);
    std::string definitions;
    const auto define = [&](const char* name, int value) {
        definitions += fmt::format("#define {} {}\n", name, value);
    };
    define("WARD_MODEL", static_cast<int>(scene.model));
    define("LAW", scene.law == ReflectanceLaw{} ? 0 : 1);
    define("COLOURED", tiles_->range().coloured_lobes ? 1 : 0);
    define("DRAWN_OUT", tiles_->range().drawn_out_lobes ? 1 : 0);
    define("FILTER", shot.smooth ? 1 : 0);
    define("AT_HOME", by_table ? 0 : 1);
    define("LIGHTS", static_cast<int>(std::max<std::size_t>(scene.lights.size(), 1)));
    define("NEAR", near ? 1 : 0);
    define("BENDS", scene.rig.bend_per_mm != 0 ? 1 : 0);
    define("SHADOWS", shadows == Shadows::horizon && all_far(scene) ? 3 : static_cast<int>(shadows));
    define("EYE", shot.eye.w == 0 ? 0 : 1);
    define("MODE", static_cast<int>(scene.mode));
    define("OUTPUT", linear ? 0 : scene.on_monitor && monitor_ ? 2 : 1);
    auto& program = programs_[definitions];
    if (!program)
        program = gl::make_program(fmt::format("{}{}{}", kDesktop, definitions, kPaintingVertexShader),
                                   fmt::format("{}{}{}", kDesktop, definitions, kPaintingFragmentShader));
    return program;
}

void Renderer::draw(const Scene& scene, const Shot& shot, GLuint target, bool linear) {
    draw(scene, shot, target, linear, cache_.homes({shot.level, outline_of(shot)}));
}

void Renderer::draw_by_table(const Scene& scene, const Shot& shot, GLuint target) {
    draw(scene, shot, target, false, {});
}

void Renderer::draw(const Scene& scene, const Shot& shot, GLuint target, bool linear, const Homes& homes) {
    TP_REQUIRE(tiles_, "there is a painting to draw");
    TP_REQUIRE(scene.lights.size() <= kMostLights, "no more lights than the shader takes");
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    const bool encodes = !linear && target != 0 && !(scene.on_monitor && monitor_) && holds_srgb();
    const gl::Program& program = program_for(scene, shot, linear || encodes, !homes);
    if (scene.shadows == Shadows::horizon && horizon_ && all_far(scene)) towards_lamps(scene.lights);
    glViewport(0, 0, shot.width, shot.height);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
    glUseProgram(program.id());
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_2D, table_.id());
    glActiveTexture(GL_TEXTURE3);
    glBindTexture(GL_TEXTURE_3D, monitor_.id());
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_3D, horizon_.id());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());

    std::vector<glm::vec4> lights;
    std::vector<glm::vec3> gains;
    std::vector<glm::vec2> places;
    for (const Light& light : scene.lights) {
        lights.push_back(light.position_mm ? glm::vec4(*light.position_mm, 1)
                                           : glm::vec4(light.direction, 0));
        gains.push_back(light.gain);
        const Angles angles = angles_of(light.direction);
        places.emplace_back(angles.azimuth_deg / 360, angles.elevation_deg * std::numbers::pi / 180);
    }
    if (lights.empty()) {
        lights.emplace_back(0, 0, 1, 0);
        gains.emplace_back(0);
        places.emplace_back(0);
    }
    const Uniforms u(program.id());
    u.set("u_texels", 0);
    u.set("u_horizon", 1);
    u.set("u_pages", 2);
    u.set("u_monitor", 3);
    u.set("u_lamp_horizon", 4);
    u.set("u_first_page", cache_.first_entries());
    if (homes)
        u.set("u_homes",
              glm::ivec4(homes->left, homes->top, homes->columns, homes->rows | homes->first << 16));
    u.set("u_size", tiles_->width(), tiles_->height());
    const int last = tiles_->levels() - 1;
    u.set("u_last_level", last);
    u.set("u_level", std::clamp(shot.level, 0, last));
    const TexelRange& range = tiles_->range();
    u.set("u_range", glm::vec4(range.diffuse_max, range.specular_max, range.height_min_mm,
                               range.height_max_mm - range.height_min_mm));
    u.set("u_mm_per_pixel", static_cast<float>(mm_per_pixel_));
    u.set("u_light", lights);
    u.set("u_gain", gains);
    u.set("u_place", places);
    u.set("u_law", glm::vec2(scene.law.diffuse_roughness, scene.law.haze));
    u.set("u_bend", scene.rig.bend_per_mm);
    u.set("u_light_radius", static_cast<float>(scene.light_radius_deg * std::numbers::pi / 180));
    u.set("u_highest", range.height_max_mm);
    u.set("u_to_painting", shot.to_painting);
    u.set("u_eye", shot.eye);
    u.set("u_ambient", static_cast<float>(scene.ambient));
    u.set("u_rig_ambient", scene.rig.ambient);
    u.set("u_exposure", scene.exposure);
    u.set("u_shoulder", scene.shoulder);
    u.set("u_background", scene.background);
    u.set("u_look", glm::vec4(scene.strength, scene.sharpness, scene.lowest_mm, scene.highest_mm));
    glBindVertexArray(nothing_.id());
    if (encodes) glEnable(GL_FRAMEBUFFER_SRGB);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    if (encodes) glDisable(GL_FRAMEBUFFER_SRGB);
    glBindVertexArray(0);
    glUseProgram(0);
}

Image<Rgb> Renderer::read(const gl::Target& target) const {
    Image<Rgb> picture(target.width(), target.height());
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, target.width(), target.height(), GL_RGB, GL_FLOAT, picture.data());
    check("to read the picture");
    for (int y = 0; y < picture.height() / 2; ++y)
        std::swap_ranges(picture.row(y).begin(), picture.row(y).end(),
                         picture.row(picture.height() - 1 - y).begin());
    return picture;
}

}  // namespace tangi
