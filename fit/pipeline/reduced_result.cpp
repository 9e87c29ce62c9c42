#include "fit/pipeline/reduced_result.h"

#include <algorithm>

#include "surface/image/enlarged.h"
#include "surface/maps/surface_part.h"

namespace tangi {

namespace {

// Of the painting, where a surface is.
Region place_of(const Surface& surface) {
    const glm::ivec2 corner = in_painting(surface, 0, 0);
    return {corner.x, corner.y, corner.x + surface.width(), corner.y + surface.height()};
}

Image<Rgb> enlarged_colours(const Image<Rgb>& colours, int reduction, const Region& part) {
    Image<Rgb> result = enlarged_linearly(colours, reduction, part);
    for (Rgb& colour : result.pixels()) colour /= std::max({colour.r, colour.g, colour.b});
    return result;
}

// By stretches, which can be averaged.
void enlarge_lobes(const Surface& first, int reduction, Surface& surface) {
    Image<Vec3> lobes(first.width(), first.height());
    for (std::size_t i = 0; i < lobes.size(); ++i) {
        const float alpha = first.roughness.pixels()[i];
        const Stretch stretch =
            first.lobe_axes.empty() ? Stretch(0) : stretch_of(first.lobe_axes.pixels()[i], alpha);
        lobes.pixels()[i] = {stretch, alpha};
    }
    lobes = enlarged_linearly(lobes, reduction, place_of(surface));
    if (!first.lobe_axes.empty()) surface.lobe_axes = Image<LobeAxes>(surface.width(), surface.height());
    for (std::size_t i = 0; i < lobes.size(); ++i) {
        const Vec3& lobe = lobes.pixels()[i];
        surface.roughness.pixels()[i] = lobe.z;
        if (!first.lobe_axes.empty()) surface.lobe_axes.pixels()[i] = axes_of(Stretch(lobe), lobe.z);
    }
}

}  // namespace

FitResult reduced_result(const FitResult& result, const ReducedPhotos& photos) {
    const int width = photos.width(), height = photos.height();
    FitResult first{Surface(width, height), FitErrors(width, height), result.report};
    first.surface.reflectance_model = result.surface.reflectance_model;
    first.surface.mm_per_pixel = result.surface.mm_per_pixel * photos.reduction();
    first.surface.scale_known = result.surface.scale_known;
    first.surface.photography = result.surface.photography;
    return first;
}

void start_with(const Surface& first, int reduction, Surface& surface) {
    const Region part = place_of(surface);
    surface.diffuse = enlarged_linearly(first.diffuse, reduction, part);
    if (!first.specular_colour.empty())
        surface.specular_colour = enlarged_colours(first.specular_colour, reduction, part);
    enlarge_lobes(first, reduction, surface);
}

void forget_unfitted(Surface& surface) {
    const Surface none(1, 1);
    for (std::size_t i = 0; i < surface.confidence.size(); ++i) {
        if (surface.confidence.pixels()[i] > 0) continue;
        surface.diffuse.pixels()[i] = none.diffuse(0, 0);
        surface.roughness.pixels()[i] = none.roughness(0, 0);
        if (!surface.specular_colour.empty()) surface.specular_colour.pixels()[i] = Rgb(1);
        if (!surface.lobe_axes.empty())
            surface.lobe_axes.pixels()[i] = axes_of(Stretch(0), none.roughness(0, 0));
    }
}

}  // namespace tangi
