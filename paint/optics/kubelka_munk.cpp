#include "paint/optics/kubelka_munk.h"

#include <algorithm>

#include "surface/base/error.h"

namespace tangi {

Medium mix(std::span<const Pigment> pigments, std::span<const float> volumes) {
    TP_REQUIRE(pigments.size() == volumes.size(), "one volume a pigment");
    double total = 0;
    std::array<double, kBands> k{}, s{};
    for (std::size_t i = 0; i < pigments.size(); ++i) {
        TP_REQUIRE(volumes[i] >= 0, "volumes are not negative");
        const double volume = volumes[i];
        total += volume;
        for (std::size_t band = 0; band < kBands; ++band) {
            k[band] += volume * static_cast<double>(pigments[i].k[band]);
            s[band] += volume * static_cast<double>(pigments[i].s[band]);
        }
    }
    Medium mixture;
    if (!(total > 0)) return mixture;
    for (std::size_t band = 0; band < kBands; ++band) {
        mixture.k[band] = static_cast<float>(k[band] / total);
        mixture.s[band] = static_cast<float>(s[band] / total);
    }
    return mixture;
}

Spectrum opaque_look(const Medium& paint, float k2) {
    Spectrum look;
    for (std::size_t band = 0; band < kBands; ++band)
        look[band] = outside_of(opaque_reflectance(paint.k[band], paint.s[band]), k2);
    return look;
}

Spectrum film_look(const Medium& paint, float thickness_mm, const Spectrum& dry_outside, float k2) {
    Spectrum look;
    for (std::size_t band = 0; band < kBands; ++band)
        look[band] = outside_of(film_reflectance(paint.k[band] * thickness_mm, paint.s[band] * thickness_mm,
                                                 inside_of(dry_outside[band], k2)),
                                k2);
    return look;
}

Rgb thesis_mixture_srgb(std::span<const Rgb> colours_srgb, std::span<const float> volumes) {
    TP_REQUIRE(!colours_srgb.empty() && colours_srgb.size() == volumes.size(), "one volume a colour");
    Rgb absorbance(0);
    float total = 0;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        total += volumes[i];
        for (int c = 0; c < 3; ++c)
            absorbance[c] += volumes[i] * k_over_s(std::clamp(colours_srgb[i][c], 1 / 255.0f, 1.0f));
    }
    if (!(total > 0)) return colours_srgb[0];
    Rgb mixture;
    for (int c = 0; c < 3; ++c) mixture[c] = opaque_reflectance(absorbance[c] / total, 1.0f);
    return mixture;
}

}  // namespace tangi
