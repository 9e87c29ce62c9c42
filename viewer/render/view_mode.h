// view_mode.h: what of a painting is shown, in one table: each mode's name, shader chunk and scale.
#pragma once

#include <span>
#include <string>

#include "surface/image/image.h"

namespace tangi {

enum class ViewMode {
    painting,
    specular_enhancement,
    diffuse_gain,
    unsharp_normals,
    height,
    roughness,
    specular,
    confidence,
    normals,
    diffuse,
    curvature
};

struct ScaleEnds {
    double lowest = 0, highest = 1;
};

// Which colour stands for which value of a map. The chunk's shader has it as scaled(value): 0 to 1 for
// false_colour(), -1 to 1 for diverging_colour().
struct MapScale {
    enum class Curve { none, linear, square_root, logarithmic, diverging };
    enum class Ends {
        fixed,     // as below
        heights,   // [mm] Scene::lowest_mm, highest_mm
        curvature  // [1/mm] -Scene::most_curvature, most_curvature
    };
    Curve curve = Curve::none;
    Ends ends = Ends::fixed;
    ScaleEnds fixed = {};           // in the unit of what is shown
    const char* lowest_means = "";  // words beside the numbers at the ends
    const char* highest_means = "";
};

struct ViewModeTraits {
    ViewMode mode;
    const char* name;   // in the window and the web page
    const char* chunk;  // GLSL: a file of shaders/modes/; painting.frag.glsl says what it may define
    MapScale scale = {};
    float strongest = 0;  // [1] Scene::strength of the full effect; 0 where there is nothing to turn up
    bool gloss_exponent = false;  // Scene::sharpness is the exponent of a gloss, which the window may change
    int coarser_levels = 0;       // of detail that are seen beside the shot's own: Scene::sharpness
};

// In the order of ViewMode. Its place there is the number that a mode has in the shader, as MODE.
std::span<const ViewModeTraits> view_modes();
const ViewModeTraits& traits_of(ViewMode mode);

// What is shown at a part t of the scale: 0 its lowest, 1 its highest end. The inverse of the shader's
// scaled().
double value_at(const MapScale& scale, const ScaleEnds& ends, double t);

// GLSL: float scaled(float value) of this scale. Ends that are not fixed are v_look.z and v_look.w. Empty
// without a curve.
std::string scale_chunk(const MapScale& scale);

// [linear] As the shader has it: dark blue over green to yellow, even in lightness.
Rgb false_colour(float t);

}  // namespace tangi
