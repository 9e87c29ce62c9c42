// axis_check_slopes.h: whether the axes of a lights file point the way they should: slopes that are fitted to
// lights of which x or y is mirrored, or which are turned about the picture's normal, are those of no
// surface.
//
// Matt reflection is n·l: lights S l, S orthogonal and of z alone in z, give normals S n. Of a surface h the
// curl dp/dy − dq/dx of the slopes p = dh/dx, q = dh/dy is 0; with one axis mirrored it is ±2 d²h/dxdy,
// turned by φ it is sin φ times the divergence dp/dx + dq/dy. Turned by 180 degrees (both axes mirrored) it
// is 0 again: that is the surface with hills for valleys.
#pragma once

#include <glm/vec2.hpp>
#include <nlohmann/json.hpp>

#include "surface/image/image.h"

namespace tangi {

// What is to be done to x and y of all lights.
struct LightTurn {
    bool mirrored = false;  // first, y to −y
    double turn_deg = 0;    // then, counter-clockwise as the camera sees it, [0, 360)

    glm::dvec2 applied(const glm::dvec2& v) const;
    LightTurn opposite() const;                     // then by half a turn more
    LightTurn after(const LightTurn& first) const;  // both in one
    friend bool operator==(const LightTurn&, const LightTurn&) = default;
};

struct SignCheck {
    double curl = 0;           // [1/pixel] rms, of the lights as listed
    double curl_mirrored = 0;  // [1/pixel] rms, were x or y of all lights mirrored
    double curl_turned = 0;  // [1/pixel] rms, were all lights turned around the picture's normal as fits best
    double log_ratio = 0;    // ln((curl_mirrored / curl)²), mean over parts of the picture
    double certainty = 0;    // [standard errors] by which that is below 0

    // The turn that makes the curl least, with y mirrored or not, whichever is less; in [0, 180), as half a
    // turn more changes nothing. Within 4 degrees of a right angle it is that one.
    struct Turned {
        LightTurn turn;
        double curl = 0;       // [1/pixel] rms
        double log_ratio = 0;  // as above, of that to the lights as listed
        double certainty = 0;
        // By both of which that is less than the best of the other kind (mirrored, or not); where not, as for
        // brush strokes that all run one way, the slopes leave it open.
        double log_ratio_other = 0, certainty_other = 0;
        bool kind_is_sure() const;
    } turned{};

    // Whether the slopes say that one axis is mirrored. A flat painting, or one whose relief runs along the
    // axes, says nothing.
    bool mirrored() const;
    // Whether they say that all lights are turned, x and y exchanged among them.
    bool is_turned() const;
    bool wrong() const { return mirrored() || is_turned(); }
    // What makes the lights right, up to half a turn: nothing where nothing is wrong.
    LightTurn remedy() const;
};

// Normals as fitted, each pixel by itself; those of confidence 0 are not looked at.
SignCheck check_signs(const Image<Vec3>& normal, const Image<float>& confidence);

nlohmann::json to_json(const SignCheck& signs);

}  // namespace tangi
