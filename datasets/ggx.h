// ggx.h: the GGX microfacet lobe of a dielectric, the model of path tracers: another one than the fit
// assumes.
//
// All directions are unit vectors in the surface frame that point away from the surface.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "surface/image/image.h"

namespace tangi {

// Distribution of the microfacets' normals [1/sr] (Walter, Marschner, Li, Torrance 2007, eq. 33; Trowbridge
// and Reitz 1975). Integrates with n.h over the hemisphere to 1.
inline float ggx_distribution(float n_h, float alpha) {
    const float alpha2 = alpha * alpha;
    const float base = n_h * n_h * (alpha2 - 1) + 1;
    return alpha2 / (std::numbers::pi_v<float> * base * base);
}

// Height-correlated Smith masking and shadowing divided by 4 n.l n.v (Heitz 2014, eq. 72 and 99).
inline float smith_visibility(float n_l, float n_v, float alpha) {
    const float alpha2 = alpha * alpha;
    const float light = n_v * std::sqrt(n_l * n_l * (1 - alpha2) + alpha2);
    const float view = n_l * std::sqrt(n_v * n_v * (1 - alpha2) + alpha2);
    return 0.5f / (light + view);
}

// Fresnel reflectance for F0 at normal incidence (Schlick 1994, eq. 15).
inline float schlick_fresnel(float f0, float l_h) {
    const float away = 1 - std::fmin(std::fmax(l_h, 0.0f), 1.0f);
    return f0 + (1 - f0) * away * away * away * away * away;
}

// The same where the distribution is anisotropic (Heitz 2014, eq. 85 and 86): D G / (4 n.l n.v) [1/sr],
// vectors in a frame of tangent, bitangent and normal, all above the surface; h the normalised half vector.
inline float anisotropic_ggx(float alpha_x, float alpha_y, const Vec3& l, const Vec3& v, const Vec3& h) {
    const float x = h.x / alpha_x, y = h.y / alpha_y, base = x * x + y * y + h.z * h.z;
    const float distribution = 1 / (std::numbers::pi_v<float> * alpha_x * alpha_y * base * base);
    const auto stretched = [&](const Vec3& w) {
        return std::sqrt(alpha_x * w.x * alpha_x * w.x + alpha_y * w.y * alpha_y * w.y + w.z * w.z);
    };
    return distribution * 0.5f / (v.z * stretched(l) + l.z * stretched(v));
}

// D F G / (4 n.l n.v) [1/sr]; 0 where light or viewer is below the surface. alpha > 0.
inline float ggx_lobe(float f0, float alpha, const Vec3& n, const Vec3& l, const Vec3& v) {
    const float n_l = glm::dot(n, l), n_v = glm::dot(n, v);
    if (!(n_l > 0) || !(n_v > 0)) return 0;
    const Vec3 h = glm::normalize(l + v);
    return ggx_distribution(std::fmin(glm::dot(n, h), 1.0f), alpha) * smith_visibility(n_l, n_v, alpha) *
           schlick_fresnel(f0, glm::dot(l, h));
}

}  // namespace tangi
