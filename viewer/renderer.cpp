#include "viewer/renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>

#include "surface/error.h"
#include "viewer/shaders.h"
#include "viewer/view.h"

namespace tangi {

namespace {

constexpr const char* kDesktop = "#version 330 core\n";

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

class Uniforms {
public:
    explicit Uniforms(GLuint program) : program_(program) {}
    void set(const char* name, int v) const { glUniform1i(at(name), v); }
    void set(const char* name, float v) const { glUniform1f(at(name), v); }
    void set(const char* name, int x, int y) const { glUniform2i(at(name), x, y); }
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

Shot pixel_by_pixel(const Surface& s) {
    Shot shot{.width = s.width(), .height = s.height()};
    // Centres of the picture's pixels are halves, those of the painting's are whole.
    shot.to_painting =
        glm::mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(-0.5f, static_cast<float>(s.height()) - 0.5f, 1));
    return shot;
}

std::vector<TexelPatch> patches_of(const TexelTiles& tiles, const Region& region) {
    std::vector<TexelPatch> patches;
    for (int tile = 0; tile < tiles.count(); ++tile) {
        if (tiles.region_in(tile, 0, region).empty()) continue;
        for (int level = 0; level <= tiles.tile_bits(); ++level) {
            TexelPatch patch{tile, level, tiles.region_in(tile, level, region), {}};
            const auto texels = tiles.level(tile, level);
            const int bits = tiles.tile_bits() - level;
            for (int y = patch.region.y0; y < patch.region.y1; ++y) {
                const auto row = texels.subspan(
                    (static_cast<std::size_t>(y) << bits) + static_cast<std::size_t>(patch.region.x0),
                    static_cast<std::size_t>(patch.region.width()));
                patch.texels.insert(patch.texels.end(), row.begin(), row.end());
            }
            patches.push_back(std::move(patch));
        }
    }
    return patches;
}

Renderer::Renderer() : nothing_(gl::make_vertex_array()) {
    largest_layers_ = integer(GL_MAX_ARRAY_TEXTURE_LAYERS);
    largest_side_ = integer(GL_MAX_TEXTURE_SIZE);
}

int Renderer::tile_bits(int width, int height) const {
    int bits = 11;
    while ((1 << bits) > largest_side_) --bits;
    return tile_bits_for(width, height, largest_layers_, bits);
}

void Renderer::set_painting(const TexelTiles& tiles, double mm_per_pixel) {
    width_ = tiles.width();
    height_ = tiles.height();
    bits_ = tiles.tile_bits();
    columns_ = tiles.columns();
    range_ = tiles.range();
    mm_per_pixel_ = mm_per_pixel;
    texels_ = gl::make_texture();
    horizon_ = {};
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, bits_);
    for (int level = 0; level <= bits_; ++level) {
        const int side = 1 << (bits_ - level);
        glTexImage3D(GL_TEXTURE_2D_ARRAY, level, GL_RGBA32UI, side, side, tiles.count(), 0, GL_RGBA_INTEGER,
                     GL_UNSIGNED_INT, nullptr);
        check("for this painting");
        for (int tile = 0; tile < tiles.count(); ++tile) {
            const auto texels = tiles.level(tile, level);
            glTexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, tile, side, side, 1, GL_RGBA_INTEGER,
                            GL_UNSIGNED_INT, texels.data());
            uploaded_bytes_ += texels.size_bytes();
        }
    }
    check("for this painting");
}

void Renderer::upload(const TexelPatch& patch) {
    if (patch.region.empty() || !texels_) return;
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, patch.level, patch.region.x0, patch.region.y0, patch.tile,
                    patch.region.width(), patch.region.height(), 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                    patch.texels.data());
    uploaded_bytes_ += patch.texels.size() * sizeof(Texel);
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
    uploaded_bytes_ += map.values.size();
    check("for cast shadows");
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

const gl::Program& Renderer::program_for(const Scene& scene, const Shot& shot, bool linear) {
    Shadows shadows = scene.shadows;
    if (width_ < 2 || height_ < 2 || (shadows == Shadows::horizon && !horizon_)) shadows = Shadows::none;
    const bool near = std::any_of(scene.lights.begin(), scene.lights.end(),
                                  [](const Light& light) { return light.position_mm.has_value(); });
    std::string definitions;
    const auto define = [&](const char* name, int value) {
        definitions += fmt::format("#define {} {}\n", name, value);
    };
    define("PAGED", 0);
    define("WARD_MODEL", static_cast<int>(scene.model));
    define("LAW", scene.law == ReflectanceLaw{} ? 0 : 1);
    define("FILTER", shot.smooth ? 1 : 0);
    define("LIGHTS", static_cast<int>(std::max<std::size_t>(scene.lights.size(), 1)));
    define("NEAR", near ? 1 : 0);
    define("BENDS", scene.rig.bend_per_mm != 0 ? 1 : 0);
    define("SHADOWS", static_cast<int>(shadows));
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
    TP_REQUIRE(texels_, "there is a painting to draw");
    TP_REQUIRE(scene.lights.size() <= kMostLights, "no more lights than the shader takes");
    const gl::Program& program = program_for(scene, shot, linear);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, shot.width, shot.height);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
    glUseProgram(program.id());
    glActiveTexture(GL_TEXTURE2);
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
    u.set("u_monitor", 2);
    u.set("u_size", width_, height_);
    u.set("u_tile_bits", bits_);
    u.set("u_tile_columns", columns_);
    u.set("u_last_level", bits_);
    u.set("u_level", std::clamp(shot.level, 0, bits_));
    u.set("u_range", glm::vec4(range_.diffuse_max, range_.specular_max, range_.height_min_mm,
                               range_.height_max_mm - range_.height_min_mm));
    u.set("u_mm_per_pixel", static_cast<float>(mm_per_pixel_));
    u.set("u_light", lights);
    u.set("u_gain", gains);
    u.set("u_place", places);
    u.set("u_law", glm::vec2(scene.law.diffuse_roughness, scene.law.haze));
    u.set("u_bend", scene.rig.bend_per_mm);
    u.set("u_light_radius", static_cast<float>(scene.light_radius_deg * std::numbers::pi / 180));
    u.set("u_highest", range_.height_max_mm);
    u.set("u_to_painting", shot.to_painting);
    u.set("u_eye", shot.eye);
    u.set("u_ambient", static_cast<float>(scene.ambient));
    u.set("u_rig_ambient", scene.rig.ambient);
    u.set("u_exposure", scene.exposure);
    u.set("u_shoulder", scene.shoulder);
    u.set("u_background", scene.background);
    u.set("u_look", glm::vec4(scene.strength, scene.sharpness, scene.lowest_mm, scene.highest_mm));
    glBindVertexArray(nothing_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
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

Image<Rgb> relight_with(Renderer& renderer, const Surface& surface, const std::vector<Light>& lights,
                        const RelightOptions& options) {
    require_consistent(surface);
    validate(options);
    if (lights.size() > kMostLights)
        fail("{} lights at once are more than the {} that the graphics shader takes", lights.size(),
             kMostLights);
    Scene scene{.lights = lights, .law = surface.law, .rig = surface.photography.rig, .model = options.model};
    scene.shadows = options.cast_shadows ? Shadows::marched : Shadows::none;
    scene.light_radius_deg = options.light_radius_deg;
    scene.ambient = options.ambient;
    Shot shot = pixel_by_pixel(surface);
    if (scene.rig.camera_distance_mm) shot.eye = {scene.rig.camera_axis_mm, *scene.rig.camera_distance_mm, 1};
    const gl::Target target(shot.width, shot.height, true);
    renderer.draw(scene, shot, target.framebuffer(), true);
    return renderer.read(target);
}

}  // namespace tangi
