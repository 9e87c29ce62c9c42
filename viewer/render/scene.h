// scene.h: how a painting is looked at: its lights, what of it is shown, and from where.
#pragma once

#include <glm/mat3x3.hpp>
#include <vector>

#include "surface/render/relight.h"
#include "viewer/render/view_mode.h"

namespace tangi {

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
    float strength = 1;                   // of the modes that enhance: up to ViewModeTraits::strongest
    float sharpness = 40;                 // exponent of an even gloss, or ViewModeTraits::coarser_levels
    float lowest_mm = 0, highest_mm = 1;  // of the height's false colours
    float most_curvature = 1;             // [1/mm] of the curvature's
    bool on_monitor = false;  // in the colours of Renderer::set_monitor(), where it was called; else sRGB
};

inline constexpr std::size_t kMostLights = 8;

// [1/mm] What the false colours of curvature end with at first: a tenth a pixel.
inline float first_most_curvature(double mm_per_pixel) { return static_cast<float>(0.1 / mm_per_pixel); }

// Of the scene's view mode: what its scale begins and ends with.
ScaleEnds scale_ends(const Scene& scene);

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
