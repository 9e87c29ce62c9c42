#include "surface/maps/surface_part.h"

namespace tangi {

Surface cut(const Surface& surface, const Region& part) {
    Surface result;
    result.height_mm = cut(surface.height_mm, part);
    result.normal = cut(surface.normal, part);
    result.diffuse = cut(surface.diffuse, part);
    result.specular = cut(surface.specular, part);
    result.roughness = cut(surface.roughness, part);
    result.confidence = cut(surface.confidence, part);
    result.specular_colour = cut(surface.specular_colour, part);
    result.lobe_axes = cut(surface.lobe_axes, part);
    result.reflectance_model = surface.reflectance_model;
    result.mm_per_pixel = surface.mm_per_pixel;
    result.scale_known = surface.scale_known;
    return result;
}

}  // namespace tangi
