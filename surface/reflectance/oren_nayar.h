// oren_nayar.h: diffuse reflection of rough surfaces: matt facets that shade and light each other.
//
// Oren & Nayar 1994, "Generalization of Lambert's reflectance model", in the form of Fujii 2012, "A tiny
// improvement of Oren-Nayar reflectance model", which has no dark rings and never reflects more than it gets:
//   f = rho_d (A + B s / t),   A = 1 / (pi + (pi/2 - 2/3) sigma),   B = sigma A
//   s = l.v - (n.l)(n.v),      t = max(n.l, n.v) where s > 0, else 1
// sigma [1] in 0 (Lambert) .. 1. It is reciprocal. Seen along the normal it is Lambert's with less of rho_d;
// what it changes is slopes: brighter than Lambert's where light and camera are on the same side of the
// normal, darker where they are not.
#pragma once

#include <numbers>

namespace tangi {

// pi f cos(theta_i) / rho_d of a surface that is lit and seen, n.l > 0 and n.v > 0, with its derivatives;
// n.l of Lambert's law where sigma = 0.
template <class T>
struct DiffuseTerms {
    T value, by_n_l, by_n_v, by_l_v, by_sigma;
};

template <class T>
DiffuseTerms<T> rough_diffuse(T n_l, T n_v, T l_v, T sigma) {
    constexpr T pi = std::numbers::pi_v<T>;
    constexpr T loss = T(0.5) - 2 / (3 * pi);
    const T scale = 1 / (1 + loss * sigma);
    const T s = l_v - n_l * n_v;
    T ratio, ratio_n_l, ratio_n_v, ratio_l_v;  // s / t and its derivatives
    if (s <= 0) {
        ratio = s;
        ratio_n_l = -n_v;
        ratio_n_v = -n_l;
        ratio_l_v = 1;
    } else if (n_l > n_v) {
        ratio = s / n_l;
        ratio_n_l = -l_v / (n_l * n_l);
        ratio_n_v = -1;
        ratio_l_v = 1 / n_l;
    } else {
        ratio = s / n_v;
        ratio_n_l = -1;
        ratio_n_v = -l_v / (n_v * n_v);
        ratio_l_v = 1 / n_v;
    }
    return {n_l * scale * (1 + sigma * ratio), scale * (1 + sigma * (ratio + n_l * ratio_n_l)),
            scale * sigma * n_l * ratio_n_v, scale * sigma * n_l * ratio_l_v,
            n_l * scale * scale * (ratio - loss)};
}

}  // namespace tangi
