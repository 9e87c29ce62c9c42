// view_mode.h: how a painting is looked at: its lights, and what of it is shown.
#pragma once

#include <algorithm>
#include <array>
#include <glm/mat3x3.hpp>
#include <string_view>
#include <vector>

#include "surface/render/relight.h"

namespace tangi {

// As MODE in shaders/painting.frag.glsl.
enum class ViewMode {
    painting,
    specular_enhancement,  // Malzbender et al. 2001: matt colour down, an even sharp gloss everywhere
    diffuse_gain,          // the same: shading falls off more steeply
    unsharp_normals,
    height,  // false colours from here on
    roughness,
    specular,
    confidence,
    normals,
    diffuse,
    curvature
};

struct ViewModeName {
    ViewMode mode;
    const char* name;
};
inline constexpr std::array<ViewModeName, 11> kViewModes = {
    {{ViewMode::painting, "Painting"},
     {ViewMode::specular_enhancement, "Specular enhancement"},
     {ViewMode::diffuse_gain, "Diffuse gain"},
     {ViewMode::unsharp_normals, "Unsharp normals"},
     {ViewMode::height, "Height"},
     {ViewMode::roughness, "Roughness α"},
     {ViewMode::specular, "Specular ρs"},
     {ViewMode::confidence, "Confidence"},
     {ViewMode::normals, "Normals"},
     {ViewMode::diffuse, "Diffuse colour ρd"},
     {ViewMode::curvature, "Curvature"}}};

// [linear] As the shader has it: dark blue over green to yellow, even in lightness.
inline Rgb false_colour(float t) {
    constexpr std::array<Rgb, 5> stops = {Rgb(0.058f, 0.0003f, 0.089f), Rgb(0.042f, 0.084f, 0.258f),
                                          Rgb(0.015f, 0.279f, 0.264f), Rgb(0.107f, 0.578f, 0.125f),
                                          Rgb(0.983f, 0.799f, 0.018f)};
    const float at = 4 * std::clamp(t, 0.0f, 1.0f);
    const auto below = std::min(static_cast<std::size_t>(at), std::size_t(3));
    return glm::mix(stops[below], stops[below + 1], at - static_cast<float>(below));
}

enum class Shadows {
    none,
    horizon,  // from a map made beforehand: fast
    marched   // exactly as surface/render/relight.h, a step a pixel: slow
};

struct Scene {
    std::vector<Light> lights{};           // in the surface's frame; at most 8
    ReflectanceModel reflectance_model{};  // of the painting
    Rig rig{};                             // its ambient light and bend; its camera is not used
    WardModel model = WardModel::bounded;
    Shadows shadows = Shadows::none;
    double light_radius_deg = 0.25;
    double ambient = 0;
    glm::mat3 exposure{1};  // of the linear picture
    float shoulder = 0;     // [1] part of the scale up to white that is bent; 0 = clips at white
    Rgb background{0.02f};  // [linear]
    ViewMode mode = ViewMode::painting;
    float strength = 1;    // of the modes that enhance
    float sharpness = 40;  // exponent of the enhanced gloss; coarseness [levels] of unsharp normals
    float lowest_mm = 0, highest_mm = 1;  // of the height's false colours
    float most_curvature = 1;             // [1/mm] of the curvature's
    bool on_monitor = false;  // in the colours of Renderer::set_monitor(), where it was called; else sRGB
};

inline constexpr std::size_t kMostLights = 8;

// Where a picture is taken from: `to_painting` gives the pixel of the painting (times the third component)
// for a place on the picture (x right, y up from its lower left corner, 1).
struct Shot {
    int width = 0, height = 0;
    glm::mat3 to_painting{1};
    glm::vec4 eye{0, 0, 1, 0};  // direction to the viewer, 0; or the viewer's place [mm], 1; surface frame
    int level = 0;              // of detail: texels of 2^level pixels
    bool smooth = false;        // between the four nearest texels; else the nearest
};

// Each pixel of the painting as one of the picture, from straight ahead.
Shot pixel_by_pixel(const Surface& surface);

}  // namespace tangi
