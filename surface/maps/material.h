// material.h: all maps of one pixel, and what stands for several.
#pragma once

#include "surface/maps/surface.h"
#include "surface/reflectance/anisotropy.h"

namespace tangi {

struct Material {
    Vec3 normal{0, 0, 1};
    Rgb diffuse{0};
    float specular = 0, roughness = 1, height_mm = 0, confidence = 0;
    Rgb specular_colour{1};
    Stretch stretch{0};
};

Material material_at(const Surface& surface, int x, int y);
// Into those of the maps that the surface has.
void set_material(Surface& surface, int x, int y, const Material& material);

// What a pixel of a coarser level of detail has of those that it stands for. Gloss is kept (after Toksvig
// 2005 and Olano & Baker 2010, "LEAN mapping"): it has their mean normal, and the spread of their slopes goes
// into its lobe: alpha is the rms slope, so alpha^2 = mean of (alpha^2 + slope^2) - slope of the mean^2,
// pixels weighted by rho_s; where lobes are anisotropic, all of it are matrices of slopes' covariances. What
// a mean normal lacks in length goes into rho_d: uneven paint is a little darker from afar.
class MeanMaterial {
public:
    explicit MeanMaterial(bool anisotropic) : anisotropic_(anisotropic) {}
    void add(const Material& material);
    Material material() const;  // of one at least

private:
    bool anisotropic_;
    Material sum_{.normal = Vec3(0)};
    Rgb specular_colour_{0};
    float count_ = 0, gloss_ = 0, spread_ = 0, slope_x_ = 0, slope_y_ = 0, differ_ = 0, cross_ = 0;
};

}  // namespace tangi
