#include "viewer/render/cpu_render.h"

#include <algorithm>

#include "retouch/treatment/treatment_picture.h"
#include "surface/render/relight.h"

namespace tangi {

float toned(float value, float shoulder) {
    if (!(shoulder > 0)) return std::clamp(value, 0.0f, 1.0f);
    const float v = std::max(value, 0.0f), s = 1 - shoulder;
    return v <= s ? v : 1 - shoulder * shoulder / (1 - 2 * s + v);
}

Image<Rgb> scene_picture(const Surface& surface, const Scene& scene, int side_px, const Progress& progress) {
    const RelightOptions options{.model = scene.model,
                                 .cast_shadows = scene.shadows != Shadows::none,
                                 .light_radius_deg = scene.light_radius_deg,
                                 .ambient = scene.ambient};
    Image<Rgb> picture = reduced(relight(surface, scene.lights, options, progress), side_px, side_px);
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& c : picture.pixels()) {
        const Rgb exposed = scene.exposure * c;
        c = srgb.encode({toned(exposed.r, scene.shoulder), toned(exposed.g, scene.shoulder),
                         toned(exposed.b, scene.shoulder)});
    }
    return picture;
}

}  // namespace tangi
