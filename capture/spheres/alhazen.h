// alhazen.h: the point of a mirror sphere that shows a near light to the camera (Alhazen's problem).
//
// A template, so that the same lines serve doubles and the automatic derivatives of a least-squares solver.
#pragma once

#include <cmath>

namespace tangi {

// The normal [unit vector] of a sphere where it mirrors the light at `light` to the camera, which stands on
// the z axis at z = 1 / inverse_distance; with 0 infinitely far in +z. The normal halves the angle between
// the directions to both (Alhazen); these depend on the point, hence on the normal, but little as long as the
// sphere is small: each step of the fixed-point iteration shrinks the error by radius / distance. False where
// a step meets the sphere's back or centre.
template <class T>
bool mirror_normal(const T centre[3], const T& radius, const T light[3], const T& inverse_distance,
                   T normal[3]) {
    using std::sqrt;
    const auto normalise = [](T v[3]) {
        const T squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        if (!(squared > T(1e-18))) return false;
        const T length = sqrt(squared);
        for (int i = 0; i < 3; ++i) v[i] /= length;
        return true;
    };
    T point[3] = {centre[0], centre[1], centre[2]};
    for (int step = 0; step < 12; ++step) {
        T to_light[3], to_camera[3];
        for (int i = 0; i < 3; ++i) {
            to_light[i] = light[i] - point[i];
            to_camera[i] = T(i == 2 ? 1 : 0) - inverse_distance * point[i];
        }
        if (!normalise(to_light) || !normalise(to_camera)) return false;
        for (int i = 0; i < 3; ++i) normal[i] = to_light[i] + to_camera[i];
        if (!normalise(normal)) return false;
        for (int i = 0; i < 3; ++i) point[i] = centre[i] + radius * normal[i];
    }
    return true;
}

}  // namespace tangi
