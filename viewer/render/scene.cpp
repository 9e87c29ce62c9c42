#include "viewer/render/scene.h"

namespace tangi {

ScaleEnds scale_ends(const Scene& scene) {
    const MapScale& scale = traits_of(scene.mode).scale;
    switch (scale.ends) {
        case MapScale::Ends::heights:
            return {scene.lowest_mm, scene.highest_mm};
        case MapScale::Ends::curvature:
            return {-scene.most_curvature, scene.most_curvature};
        case MapScale::Ends::fixed:
            break;
    }
    return scale.fixed;
}

Shot pixel_by_pixel(const Surface& s) {
    Shot shot{.width = s.width(), .height = s.height()};
    // Centres of the picture's pixels are halves, those of the painting's are whole.
    shot.to_painting =
        glm::mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(-0.5f, static_cast<float>(s.height()) - 0.5f, 1));
    return shot;
}

}  // namespace tangi
