// sphere_crops.h: the surroundings of one sphere in all photographs, full size, in one frame.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "capture/registration/camera_motion.h"
#include "capture/spheres/sphere_geometry.h"
#include "capture/stack/photo_set.h"
#include "surface/image/image.h"

namespace tangi {

// Grey values (as stored, 0..1) of one region of every photograph. Pixels are those of the whole photographs.
struct SphereCrops {
    Region region;
    std::vector<Image<float>> photos;
    std::vector<CameraMotion> drift;  // one a photograph
    glm::dvec2 picture_centre{0, 0};  // around which photographs roll
    float step = 1.0f / 255;          // what one code of the file is worth

    bool holds(const glm::dvec2& pixel, double margin = 1) const;
    // Bilinear, at a pixel of that photograph; the border's value outside.
    float value(std::size_t photo, const glm::dvec2& pixel) const;
    glm::dvec2 to_photo(std::size_t photo, const glm::dvec2& common) const {
        return drift[photo].to_photo(common, picture_centre);
    }
    glm::dvec2 to_common(std::size_t photo, const glm::dvec2& pixel) const {
        return drift[photo].to_common(pixel, picture_centre);
    }
};

// Reads 1.5 radii around each circle (y down). Throws Error as read_grey_region().
std::vector<SphereCrops> read_sphere_crops(const PhotoSet& set, const GreyPhotos& photos,
                                           const CameraMotions& drifts, std::span<const SphereImage> spheres,
                                           const Progress& progress = {});

}  // namespace tangi
