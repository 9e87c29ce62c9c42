// light_signs.h: whether the axes of a lights file point the way they should: slopes that are fitted to
// lights of which x or y is mirrored are those of no surface.
//
// Matt reflection is n·l: lights S l, S = diag(±1, ±1, 1), give normals S n. Of a surface h the curl
// dp/dy − dq/dx of the slopes p = dh/dx, q = dh/dy is 0; with one axis mirrored it is ±2 d²h/dxdy. With both
// mirrored it is 0 again: that is the surface with hills for valleys, turned by 180 degrees.
#pragma once

#include <nlohmann/json.hpp>

#include "surface/image.h"

namespace tangi {

struct SignCheck {
    double curl = 0;           // [1/pixel] rms, of the lights as listed
    double curl_mirrored = 0;  // [1/pixel] rms, were x or y of all lights mirrored
    double curl_turned = 0;  // [1/pixel] rms, were all lights turned around the picture's normal as fits best
    double log_ratio = 0;    // ln((curl_mirrored / curl)²), mean over parts of the picture
    double certainty = 0;    // [standard errors] by which that is below 0

    // Whether the slopes say that one axis is mirrored. A flat painting, or one whose relief runs along the
    // axes, says nothing.
    bool mirrored() const;
};

// Normals as fitted, each pixel by itself; those of confidence 0 are not looked at.
SignCheck check_signs(const Image<Vec3>& normal, const Image<float>& confidence);

nlohmann::json to_json(const SignCheck& signs);

}  // namespace tangi
