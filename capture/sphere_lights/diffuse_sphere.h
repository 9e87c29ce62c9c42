// diffuse_sphere.h: the light's direction from the shading of a diffuse sphere.
#pragma once

#include <optional>
#include <vector>

#include "capture/spheres/mirror_sphere.h"
#include "surface/image/colour.h"

namespace tangi {

struct MattShading {
    glm::dvec3 direction{0, 0, 1};  // [unit vector] to the light
    double sigma_rad = 0;           // standard error, root mean square of both angles
    double brightness = 0;          // [1] linear value where the sphere faces the light
    double ambient = 0;             // [1] linear value that does not depend on the normal
    double residual = 0;            // [1] robust, relative to the brightness
    double lit = 0;                 // [1] part of the disc that was used
};

// Fits value = brightness * n.l + ambient to the sphere's lit side in one photograph by least squares with
// Tukey's weights (Lambert; Woodham 1980 with the roles of light and normal changed). What lies in shadow, is
// clipped, or deviates (a gloss, a scratch) is left out. Nothing where too little of the sphere is lit.
std::optional<MattShading> shading_of(const SphereCrops& crops, std::size_t photo, const SphereImage& sphere,
                                      const SphereCamera& camera, const Transfer& transfer);

struct DiffuseSphere {
    FoundSphere sphere;
    Transfer transfer;  // given, or the one of linear, sRGB and gamma 2.2 under which shadings fit best
    std::vector<std::optional<MattShading>> photos;
    std::vector<std::string> warnings;
    double residual = 0;  // [1] of the shadings, mean
    std::vector<std::string> poor{};
};

// Finds the sphere where it is given, or else the circle in the picture whose shading fits best. Throws Error
// where there is none.
DiffuseSphere find_diffuse_sphere(const SphereStack& scene, const std::optional<Transfer>& transfer,
                                  const Progress& progress = {});

// As find_diffuse_sphere(), where its shading and outline leave no doubt; nothing else.
std::optional<DiffuseSphere> clear_diffuse_sphere(const SphereStack& scene,
                                                  const std::optional<Transfer>& transfer);

}  // namespace tangi
