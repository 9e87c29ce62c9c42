// kubelka_munk.h: light in films of paint: mixing, films over what lies below, the boundary with air.
//
// K absorbs and S scatters back, both in 1/mm of dry film (Kubelka & Munk 1931). `inside` is reflectance in
// the paint, below its boundary with air; `outside` is what an observer sees of it, without the specular
// reflection at the boundary: that is the Ward lobe's. All functions are pure and finite for any K, S,
// thickness >= 0.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "paint/optics/pigment.h"
#include "paint/optics/spectrum.h"
#include "surface/math/portable_math.h"

namespace tangi {

// How much of the diffuse light that reaches the boundary from inside is thrown back: 0.6 for a binder of
// refractive index 1.5 (0.596: Judd 1942; Orchard 1969).
inline constexpr float kInternalReflection = 0.6f;

// K and S of a mixture [1/mm].
struct Medium {
    Spectrum k{}, s{};
};

// Two-constant mixing (Duncan 1940): K and S add in proportion to volume. `volumes` in any unit, >= 0, as
// many as pigments; nothing at all gives a clear medium. Throws ContractError where the numbers differ.
Medium mix(std::span<const Pigment> pigments, std::span<const float> volumes);

// Reflectance, inside, of a film so thick that more of it changes nothing: R = 1 + K/S - sqrt((K/S)^2 + 2
// K/S), written so that nothing cancels and S = 0 is black. Without K nothing is lost, whatever S: 1, also
// where both are 0, of which no film hides (is_clear()).
template <class T>
T opaque_reflectance(T k, T s) {
    const T whole = k + s + std::sqrt(k * (k + 2 * s));
    return whole > 0 ? s / whole : T(1);
}

// K/S of what has this reflectance, inside: (1 - R)^2 / 2R.
template <class T>
T k_over_s(T opaque_inside) {
    return (1 - opaque_inside) * (1 - opaque_inside) / (2 * opaque_inside);
}

// Reflectance, inside, of a film over a background: the hyperbolic solution (Kubelka 1948). `kx`, `sx`: K and
// S times thickness [1].
//
// With u = sqrt(kx (kx + 2 sx)), Rinf the opaque reflectance, Rg the background, it is the weighted mean of
// both,
//     R = (Rinf w + Rg q) / (w + q),   q = 2u / (exp(2u) - 1),   w = kx + sx + u - Rg sx,
// equal to Kubelka's form with coth: no weight is ever negative, so it needs no special cases, and lies
// between Rinf and Rg whatever the rounding.
template <class T>
T film_reflectance(T kx, T sx, T background_inside) {
    const T u = std::sqrt(kx * (kx + 2 * sx));
    const T whole = kx + sx + u;
    if (!(whole > 0)) return background_inside;
    const T x = 2 * u;
    const T q = x > T(1e-12) ? (x < T(80) ? x / portable::expm1(x) : T(0)) : T(1);
    const T w = std::fmax(whole - background_inside * sx, T(0));
    return (sx / whole * w + background_inside * q) / (w + q);
}

// Saunderson 1942 without the light that is reflected specularly outside (k1 = 0): R (1 - k2) / (1 - k2 R). A
// perfect white stays one.
template <class T>
T outside_of(T inside, T k2 = T(kInternalReflection)) {
    return (1 - k2) * inside / (1 - k2 * inside);
}

// Its inverse.
template <class T>
T inside_of(T outside, T k2 = T(kInternalReflection)) {
    return outside / (1 - k2 + k2 * outside);
}

// What is seen of a mixture that hides everything below.
Spectrum opaque_look(const Medium& paint, float k2 = kInternalReflection);

// What is seen of a film over a dry layer, which is given as it looks by itself (outside). They share one
// boundary with air: the dry layer's is gone where paint touches it. No thickness leaves the dry layer as it
// is.
Spectrum film_look(const Medium& paint, float thickness_mm, const Spectrum& dry_outside,
                   float k2 = kInternalReflection);

// The same for many pixels at once: mixtures of a few pigments in films of varying thickness. Immutable; any
// number of threads may use one.
class FilmBatch {
public:
    // Throws ContractError for k2 outside of [0, 1).
    FilmBatch(std::span<const Pigment> pigments, Illuminant illuminant = Illuminant::d65,
              float k2 = kInternalReflection);

    // For every pixel i, the linear Rec. 709 colour under the illuminant of a film with the volume
    // volumes_mm[pigment][i] [mm^3/mm^2] of every pigment, over dry[i], whose reflectance is that of
    // reflectance_of_rgb(). What dry[i] has outside of [0, 1], a band's reflectance can't: it is covered as
    // the rest is. So without paint (and under D65), dry[i] comes out. `colour` may be `dry`. Throws
    // ContractError where sizes differ.
    void look(std::span<const std::span<const float>> volumes_mm, std::span<const Rgb> dry,
              std::span<Rgb> colour) const;

    // Films on each other, from the bottom up, of as many pixels each: each lies over what those below it
    // look like, band by band. Illuminant and k2 are the last one's. Throws ContractError where there is
    // none.
    struct Film {
        const FilmBatch* paints;
        std::span<const std::span<const float>> volumes_mm;
    };
    static void look_through(std::span<const Film> films, std::span<const Rgb> dry, std::span<Rgb> colour);

    std::size_t pigments() const { return k_.size(); }

private:
    std::vector<Spectrum> k_, s_;
    std::array<Spectrum, 3> weights_;
    float k2_;
};

// The model of the thesis (eq. 3.18 to 3.26), for comparison: one constant, K/S, in each of three
// sRGB-encoded channels, opaque; mixed by `volumes`, divided by their sum, which the thesis doesn't. Channels
// are limited to [1/255, 1], where K/S is finite. No volume at all gives the first colour. Throws
// ContractError where sizes differ or are 0.
Rgb thesis_mixture_srgb(std::span<const Rgb> colours_srgb, std::span<const float> volumes);

}  // namespace tangi
