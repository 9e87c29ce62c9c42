#include "surface/maps/reduced_surface.h"

#include <algorithm>

#include "surface/base/parallel.h"
#include "surface/maps/material.h"

namespace tangi {

Surface halved(const Surface& s) {
    Surface half((s.width() + 1) / 2, (s.height() + 1) / 2);
    if (!s.specular_colour.empty()) half.specular_colour = Image<Rgb>(half.width(), half.height());
    if (!s.lobe_axes.empty()) half.lobe_axes = Image<LobeAxes>(half.width(), half.height());
    parallel_for(0, half.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < half.width(); ++x) {
                MeanMaterial mean(!s.lobe_axes.empty());
                for (int sy = 2 * y; sy < std::min(2 * y + 2, s.height()); ++sy)
                    for (int sx = 2 * x; sx < std::min(2 * x + 2, s.width()); ++sx)
                        mean.add(material_at(s, sx, sy));
                set_material(half, x, y, mean.material());
            }
    });
    half.reflectance_model = s.reflectance_model;
    half.mm_per_pixel = 2 * s.mm_per_pixel;
    half.scale_known = s.scale_known;
    half.photography = s.photography;
    half.provenance = s.provenance;
    return half;
}

}  // namespace tangi
