// camera_motion.h: how far the camera moved from photograph to photograph, from edges that stay while the
// light moves.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "capture/stack/grey_photos.h"

namespace tangi {

// Takes a pixel of the common frame (that of the first photograph) to that of one photograph: turned by
// roll_rad around the picture's centre (from x towards y, y down) and enlarged from there, then shifted.
struct CameraMotion {
    glm::dvec2 shift_px{0, 0};
    double roll_rad = 0;
    double zoom = 1;      // [1]
    double sigma_px = 0;  // standard error of each coordinate of the shift
    // [1] Correlation of this photograph's edges with those that the others agree on, and whether it must
    // show something else: it has edges of its own, and none of theirs (capture/stack/duplicate_photos.h), or
    // no more than it has by chance where it is laid elsewhere, while the others have far more. It has no
    // drift then, and no part in how far the others moved.
    double agreement = 1;
    bool strange = false;

    glm::dvec2 to_photo(const glm::dvec2& pixel, const glm::dvec2& centre) const;
    glm::dvec2 to_common(const glm::dvec2& pixel, const glm::dvec2& centre) const;
    // [pixels] by which it moves a picture around this centre, root mean square over the picture.
    double displacement_px(const glm::dvec2& centre) const;
};

struct CameraMotions {
    std::vector<CameraMotion> photos;
    double rms_px = 0;   // of the displacements from their median, over the picture, all photographs
    bool moved = false;  // false: within the noise, or nothing to hold on to; all drifts are zero then
};

// Least squares between the direction of edges (doubled, so that their sign does not matter) in each
// photograph and its mean over all (Lucas, Kanade 1981; inverse compositional, Baker, Matthews 2004). Good
// for drifts of a few pixels of the reduced photographs. A tilt of the camera is not sought: between
// photographs of one sitting it shows as a shift.
CameraMotions find_camera_motions(const GreyPhotos& photos, const Progress& progress = {});

}  // namespace tangi
