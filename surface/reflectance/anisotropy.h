// anisotropy.h: anisotropic lobes: brushed or burnished metal, varnish in the
// direction of a canvas' threads (Ward 1992, eq. 5, in any normalisation of ward.h).
//
// The tangent plane has the axes e1, e2 that x and y become when z is turned into the normal the shortest
// way: for h = l + v
//   h.e1 = h.x - n.x u,   h.e2 = h.y - n.y u,   u = (h.n + h.z) / (1 + n.z)
// so that no direction in the plane is special. The logarithms of alpha in all directions of the plane are a
// symmetric matrix: ln alpha + [a b; b -a], the stretch (a, b) = s (cos 2 phi, sin 2 phi): alpha e^s along
// phi, alpha e^-s across it. Stretch 0 is the isotropic lobe, no stretch is told in two ways, and means of
// stretches are such again. The Gaussian's exponent is then
//   tan2' / alpha^2,  tan2' = cosh(2 s) tan2 - sinh(2 s) / s (a (t1^2 - t2^2) + 2 b t1 t2),   ti = h.ei / h.n
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <utility>

#include "surface/image/image.h"
#include "surface/reflectance/ward.h"

namespace tangi {

using Stretch = glm::vec2;  // [1] (a, b)

// [1] Largest s of a fit: seven times as wide along as across.
constexpr double kMostStretch = 1;

// exp of the matrix -2 [a b; b -a] = c 1 - [a b; b -a], what exponents take.
template <class T>
struct StretchShape {
    T c = 1;         // [1] cosh 2 s
    T a = 0, b = 0;  // [1] sinh(2 s) / s times the stretch
};
template <class T>
StretchShape<T> shape_of(T a, T b) {
    using std::cosh;
    using std::sinh;
    using std::sqrt;
    const T s = sqrt(a * a + b * b);
    const T k = s > T(1e-4) ? sinh(2 * s) / s : T(2) + T(4.0 / 3) * s * s;
    return {cosh(2 * s), k * a, k * b};
}

// Where a lobe is anisotropic (anisotropic Ward; the frame is above): alpha is `roughness`
// times a factor along the tangent, and that much less across it, so that `roughness` stays their geometric
// mean and an isotropic lobe of it has the same peak and energy.
struct LobeAxes {
    float roughness_v =
        0.3f;           // [1] alpha across the tangent; that of the surface where the lobe is isotropic
    float tangent = 0;  // [rad] of the tangent from x towards y; 0 where the lobe is isotropic

    friend bool operator==(const LobeAxes&, const LobeAxes&) = default;
};

inline Stretch stretch_of(const LobeAxes& axes, float roughness) {
    const float s = std::log(roughness / axes.roughness_v);
    return s * Stretch(std::cos(2 * axes.tangent), std::sin(2 * axes.tangent));
}

// The tangent is where the lobe is wide, within -pi/2 .. pi/2.
inline LobeAxes axes_of(const Stretch& stretch, float roughness) {
    const float s = std::sqrt(stretch.x * stretch.x + stretch.y * stretch.y);
    if (!(s > 0)) return {roughness, 0};
    return {roughness * std::exp(-s), 0.5f * std::atan2(stretch.y, stretch.x)};
}

// Both numbers of all pixels as maps of their own: alpha across the tangent, and the tangent [rad].
inline std::pair<Image<float>, Image<float>> axes_maps(const Image<LobeAxes>& axes) {
    Image<float> across(axes.width(), axes.height()), tangent(axes.width(), axes.height());
    for (std::size_t i = 0; i < axes.size(); ++i) {
        across.pixels()[i] = axes.pixels()[i].roughness_v;
        tangent.pixels()[i] = axes.pixels()[i].tangent;
    }
    return {std::move(across), std::move(tangent)};
}

// h.e1 and h.e2 in a frame that is turned by the axes' tangent, for the anisotropic lobe of ward.h.
inline void add_axes(const Vec3& n, const Vec3& h, float tangent, WardAngles<float>& angles) {
    const float u = (angles.h_n + h.z) / (1 + n.z);
    const float h_1 = h.x - n.x * u, h_2 = h.y - n.y * u;
    const float cosine = std::cos(tangent), sine = std::sin(tangent);
    angles.h_t = cosine * h_1 + sine * h_2;
    angles.h_b = cosine * h_2 - sine * h_1;
}

// A pixel's lobe.
struct AnisotropicLobe {
    float roughness;  // alpha
    LobeAxes axes;
    float second_lobe_weight = 0;
};

// Lobe and second lobe, in directions of the surface frame.
inline float anisotropic_lobe(WardModel model, WardAngles<float> angles, const Vec3& n, const Vec3& h,
                              const AnisotropicLobe& lobe) {
    const auto& [roughness, axes, second_lobe_weight] = lobe;
    add_axes(n, h, axes.tangent, angles);
    const float across = axes.roughness_v, along = roughness * roughness / across;
    const float core = ward_lobe(model, angles, along, across);
    constexpr auto wide = static_cast<float>(kSecondLobeWidth);
    return second_lobe_weight > 0
               ? (1 - second_lobe_weight) * core +
                     second_lobe_weight * ward_lobe(model, angles, wide * along, wide * across)
               : core;
}

}  // namespace tangi
