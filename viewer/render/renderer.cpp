#include "viewer/render/renderer.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>

#include "surface/base/error.h"
#include "viewer/render/painting_shader.h"
#include "viewer/render/vertex_shader.h"
#include "viewer/render/view.h"

namespace tangi {

namespace {

constexpr const char* kDesktop = "#version 330 core\n";

bool has_near(const Scene& scene) {
    return std::ranges::any_of(scene.lights,
                               [](const Light& light) { return light.position_mm.has_value(); });
}

// Light comes from the same direction everywhere.
bool all_far(const Scene& scene) {
    return !scene.lights.empty() && !has_near(scene) && scene.rig.bend_per_mm == 0;
}

// Of the framebuffer that is bound: it encodes what is drawn.
bool holds_srgb(GLuint target) {
    GLint encoding = GL_LINEAR;
    glGetFramebufferAttachmentParameteriv(GL_FRAMEBUFFER, target == 0 ? GL_BACK_LEFT : GL_COLOR_ATTACHMENT0,
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

// What the shader knows of each light, side by side; of one that is dark where there is none.
struct LightUniforms {
    std::vector<glm::vec4> lights;
    std::vector<glm::vec3> gains;
    std::vector<glm::vec2> places, beams;
    std::vector<glm::vec3> curved_beams;
};

LightUniforms uniforms_of(const std::vector<Light>& lights) {
    LightUniforms all;
    for (const Light& light : lights) {
        all.lights.push_back(light.position_mm ? glm::vec4(*light.position_mm, 1)
                                               : glm::vec4(light.direction, 0));
        all.gains.push_back(light.gain);
        const auto& beam = light.beam.terms;
        all.beams.emplace_back(beam[0], beam[1]);
        all.curved_beams.emplace_back(beam[2], beam[3], beam[4]);
        const Angles angles = angles_of(light.direction);
        all.places.emplace_back(angles.azimuth_deg / 360, angles.elevation_deg * std::numbers::pi / 180);
    }
    if (all.lights.empty()) {
        all.lights.emplace_back(0, 0, 1, 0);
        all.gains.emplace_back(0);
        all.places.emplace_back(0);
        all.beams.emplace_back(0);
        all.curved_beams.emplace_back(0);
    }
    return all;
}

// Which texture unit holds what; bind_textures() goes by it.
void set_textures(const Uniforms& u) {
    u.set("u_texels", 0);
    u.set("u_horizon", 1);
    u.set("u_pages", 2);
    u.set("u_monitor", 3);
    u.set("u_light_horizon", 4);
}

void set_tiles(const Uniforms& u, const TileCache& cache, const std::optional<TileCache::Homes>& homes) {
    u.set("u_first_page", cache.first_entries());
    if (homes)
        u.set("u_homes",
              glm::ivec4(homes->left, homes->top, homes->columns, homes->rows | homes->first << 16));
}

void set_surface(const Uniforms& u, const TexelTiles& tiles, double mm_per_pixel, int level) {
    u.set("u_size", tiles.width(), tiles.height());
    const int last = tiles.levels() - 1;
    u.set("u_last_level", last);
    u.set("u_level", std::clamp(level, 0, last));
    const TexelRange& range = tiles.range();
    u.set("u_range", glm::vec4(range.diffuse_max, range.specular_max, range.height_min_mm,
                               range.height_max_mm - range.height_min_mm));
    u.set("u_mm_per_pixel", static_cast<float>(mm_per_pixel));
    u.set("u_highest", range.height_max_mm);
}

void set_lights(const Uniforms& u, const Scene& scene) {
    const LightUniforms all = uniforms_of(scene.lights);
    u.set("u_light", all.lights);
    u.set("u_gain", all.gains);
    u.set("u_place", all.places);
    u.set("u_beam", all.beams);
    u.set("u_beam_curved", all.curved_beams);
    u.set("u_bend", scene.rig.bend_per_mm);
    u.set("u_light_radius", static_cast<float>(scene.light_radius_deg * std::numbers::pi / 180));
    u.set("u_ambient", static_cast<float>(scene.ambient));
    u.set("u_rig_ambient", scene.rig.ambient);
}

// From the target's pixels.
void set_viewport(const Uniforms& u, const Shot& shot, const glm::ivec2& corner) {
    u.set("u_viewport", glm::vec4(corner, shot.width, shot.height));
    u.set("u_to_painting", shot.to_painting * glm::mat3({1, 0, 0}, {0, 1, 0}, {-glm::vec2(corner), 1}));
    u.set("u_eye", shot.eye);
}

// How what is lit becomes a picture.
void set_look(const Uniforms& u, const Scene& scene) {
    u.set("u_reflectance_model",
          glm::vec2(scene.reflectance_model.diffuse_roughness, scene.reflectance_model.second_lobe_weight));
    u.set("u_exposure", scene.exposure);
    u.set("u_shoulder", scene.shoulder);
    u.set("u_background", scene.background);
    const ScaleEnds ends = scale_ends(scene);
    u.set("u_look", glm::vec4(scene.strength, scene.sharpness, ends.lowest, ends.highest));
}

}  // namespace

const gl::Program& Renderer::program_for(const Scene& scene, const Shot& shot, bool linear, bool by_table,
                                         bool bare) {
    Shadows shadows = scene.shadows;
    if (tiles_->width() < 2 || tiles_->height() < 2 || (shadows == Shadows::horizon && !horizon_))
        shadows = Shadows::none;
    const bool near = has_near(scene);
    std::string definitions;
    const auto define = [&](const char* name, int value) {
        definitions += fmt::format("#define {} {}\n", name, value);
    };
    define("WARD_MODEL", static_cast<int>(scene.model));
    define("REFLECTANCE_MODEL", scene.reflectance_model == ReflectanceModel{} ? 0 : 1);
    define("SPECULAR_COLOUR", tiles_->range().coloured_specular ? 1 : 0);
    define("ANISOTROPIC", tiles_->range().anisotropic_specular ? 1 : 0);
    define("FILTER", shot.smooth ? 1 : 0);
    define("AT_HOME", by_table ? 0 : 1);
    define("LIGHTS", static_cast<int>(std::max<std::size_t>(scene.lights.size(), 1)));
    define("NEAR", near ? 1 : 0);
    define("BENDS", scene.rig.bend_per_mm != 0 ? 1 : 0);
    define("BEAMS", std::ranges::all_of(scene.lights, [](const Light& l) { return l.beam.even(); }) ? 0 : 1);
    define("SHADOWS", shadows == Shadows::horizon && all_far(scene) ? 3 : static_cast<int>(shadows));
    define("EYE", shot.eye.w == 0 ? 0 : 1);
    define("MODE", static_cast<int>(scene.mode));
    define("OUTPUT", linear ? 0 : scene.on_monitor && monitor_ ? 2 : 1);
    define("GREY", scene.exposure == glm::mat3(scene.exposure[0][0]) ? 1 : 0);
    define("BARE", bare ? 1 : 0);
    auto& program = programs_[definitions];
    if (!program)
        program = gl::make_program(fmt::format("{}{}{}", kDesktop, definitions, kPaintingVertexShader),
                                   fmt::format("{}{}{}", kDesktop, definitions, painting_fragment_shader()));
    return program;
}

// All over the target, in the output's encoding.
void Renderer::draw_background(const Scene& scene, bool linear) {
    const Scene bare{.on_monitor = scene.on_monitor};  // one program, whatever else is shown
    const gl::Program& program = program_for(bare, Shot{}, linear, true, true);
    glUseProgram(program.id());
    const Uniforms u(program.id());
    u.set("u_monitor", 3);
    u.set("u_background", scene.background);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::draw(const Scene& scene, const Shot& shot, GLuint target, bool linear,
                    const glm::ivec2& corner) {
    draw(scene, shot, target, linear, corner, cache_.homes({shot.level, outline_of(shot)}));
}

void Renderer::draw_by_table(const Scene& scene, const Shot& shot, GLuint target) {
    draw(scene, shot, target, false, {0, 0}, {});
}

// Each to the unit that set_textures() says.
void Renderer::bind_textures() const {
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_2D, table_.id());
    glActiveTexture(GL_TEXTURE3);
    glBindTexture(GL_TEXTURE_3D, monitor_.id());
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_3D, horizon_.id());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, texels_.id());
}

void Renderer::draw(const Scene& scene, const Shot& shot, GLuint target, bool linear,
                    const glm::ivec2& corner, const Homes& homes) {
    TP_REQUIRE(tiles_, "there is a painting to draw");
    TP_REQUIRE(scene.lights.size() <= kMostLights, "no more lights than the shader takes");
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    const bool encodes = !linear && !(scene.on_monitor && monitor_) && holds_srgb(target);
    const gl::Program& program = program_for(scene, shot, linear || encodes, !homes);
    if (scene.shadows == Shadows::horizon && horizon_ && all_far(scene)) towards_lights(scene.lights);
    glViewport(corner.x, corner.y, shot.width, shot.height);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
    bind_textures();
    glBindVertexArray(nothing_.id());
    if (encodes) glEnable(GL_FRAMEBUFFER_SRGB);
    // Software renderers go through the whole shader where there is no painting, too: they need not look
    // there.
    const Region seen = seen_on(shot, {tiles_->width(), tiles_->height()});
    if (seen != Region{0, 0, shot.width, shot.height}) {
        draw_background(scene, linear || encodes);
        glEnable(GL_SCISSOR_TEST);
        glScissor(corner.x + seen.x0, corner.y + seen.y0, seen.width(), seen.height());
    }

    glUseProgram(program.id());
    const Uniforms u(program.id());
    set_textures(u);
    set_tiles(u, cache_, homes);
    set_surface(u, *tiles_, mm_per_pixel_, shot.level);
    set_lights(u, scene);
    set_viewport(u, shot, corner);
    set_look(u, scene);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    if (encodes) glDisable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_SCISSOR_TEST);
    glBindVertexArray(0);
    glUseProgram(0);
}

Image<Rgb> Renderer::read(const gl::Target& target) const {
    Image<Rgb> picture(target.width(), target.height());
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, target.width(), target.height(), GL_RGB, GL_FLOAT, picture.data());
    gl::require_no_error("to read the picture");
    for (int y = 0; y < picture.height() / 2; ++y)
        std::swap_ranges(picture.row(y).begin(), picture.row(y).end(),
                         picture.row(picture.height() - 1 - y).begin());
    return picture;
}

}  // namespace tangi
