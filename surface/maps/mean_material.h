// mean_material.h: what pixels of a surface look like together, from afar.
//
// A mean keeps gloss (after Toksvig 2005 and Olano & Baker 2010, "LEAN mapping"): it has the mean normal, and
// the spread of the slopes goes into its lobe: alpha is the rms slope, so alpha^2 = mean of (alpha^2 +
// slope^2) - slope of the mean^2, pixels weighted by rho_s; where lobes are anisotropic, all of it are
// matrices of slopes' covariances. What a mean normal lacks in length goes into rho_d: uneven paint is a
// little darker from afar.
#pragma once

#include "surface/maps/surface.h"

namespace tangi {

// One pixel of all maps.
struct Material {
    Vec3 normal{0, 0, 1};
    Rgb diffuse{0};
    float specular = 0, roughness = 1, height_mm = 0, confidence = 0;
    Rgb specular_colour{1};
    Stretch stretch{0};
};

Material material_at(const Surface& surface, int x, int y);

class MeanMaterial {
public:
    explicit MeanMaterial(bool anisotropic) : anisotropic_(anisotropic) {}
    void add(const Material& material);
    bool empty() const { return count_ == 0; }
    Material material() const;  // of at least one

private:
    bool anisotropic_;
    Material sum_{.normal = Vec3(0)};
    Rgb specular_colour_{0};
    float count_ = 0, gloss_ = 0, spread_ = 0, slope_x_ = 0, slope_y_ = 0, differ_ = 0, cross_ = 0;
};

// The surface by means of `factor` x `factor` pixels: those that were measured, where any was. Its frame is
// that of the surface but for what the last row and column of blocks reach beyond it.
Surface reduced(const Surface& surface, int factor);

}  // namespace tangi
