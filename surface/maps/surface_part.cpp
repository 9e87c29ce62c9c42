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

void paste(const Surface& part, Surface& into, int x, int y) {
    paste(part, part.height_mm.region(), into, x, y);
}

void paste(const Surface& from, const Region& region, Surface& into, int x, int y) {
    paste(from.height_mm, region, into.height_mm, x, y);
    paste(from.normal, region, into.normal, x, y);
    paste(from.diffuse, region, into.diffuse, x, y);
    paste(from.specular, region, into.specular, x, y);
    paste(from.roughness, region, into.roughness, x, y);
    paste(from.confidence, region, into.confidence, x, y);
    paste(from.specular_colour, region, into.specular_colour, x, y);
    paste(from.lobe_axes, region, into.lobe_axes, x, y);
}

}  // namespace tangi
