#include "paint/optics/pigment.h"

#include <algorithm>
#include <cmath>

#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

// Reflectances, inside, of which K and S can be told apart from nothing: at 0 K/S has no bound, at 1 it is 0.
constexpr double kDarkest = 0.002, kBrightest = 0.9995;
// Scattering relative to the white that the tint was made with: beyond these, the measurement is at fault.
constexpr double kLeastScattering = 1e-3, kMostScattering = 3;

void require_reflectance(const std::string& name, const char* what, const Spectrum& reflectance) {
    for (std::size_t band = 0; band < kBands; ++band)
        if (!(reflectance[band] >= 0 && reflectance[band] <= 1))
            fail(
                "paint '{}': {} reflects {} at {} nm; reflectances are 0 to 1, without the specular "
                "reflection",
                name, what, reflectance[band], kBand_nm[band]);
}

void require_hiding(const std::string& name, float hiding_mm) {
    if (!(hiding_mm >= 0.001f && hiding_mm <= 10))
        fail("paint '{}': hiding thickness {} mm is outside of [0.001, 10]", name, hiding_mm);
}

double opaque_k_over_s(float outside) {
    return k_over_s(std::clamp(inside_of(static_cast<double>(outside)), kDarkest, kBrightest));
}

// Fills bands whose S is unknown (0) from the nearest known ones, linearly in log S; all unknown: a third of
// white's.
void fill_scattering(std::array<double, kBands>& s, const Pigment& white) {
    const std::array<double, kBands> found = s;
    const auto has = [&](int i) { return found[static_cast<std::size_t>(i)] > 0; };
    for (int i = 0; i < kBands; ++i) {
        if (has(i)) continue;
        int below = i, above = i;
        while (below >= 0 && !has(below)) --below;
        while (above < kBands && !has(above)) ++above;
        double& value = s[static_cast<std::size_t>(i)];
        if (below < 0 && above >= kBands) {
            value = static_cast<double>(white.s[static_cast<std::size_t>(i)]) / 3;
        } else if (below < 0 || above >= kBands) {
            value = found[static_cast<std::size_t>(below < 0 ? above : below)];
        } else {
            const auto nm = [](int j) { return static_cast<double>(kBand_nm[static_cast<std::size_t>(j)]); };
            const double t = (nm(i) - nm(below)) / (nm(above) - nm(below));
            value = portable::exp((1 - t) * portable::log(found[static_cast<std::size_t>(below)]) +
                                  t * portable::log(found[static_cast<std::size_t>(above)]));
        }
    }
}

double luminance_over(const Pigment& pigment, float thickness_mm, float card, Illuminant illuminant) {
    Spectrum below;
    below.fill(card);
    return xyz_of(film_look({pigment.k, pigment.s}, thickness_mm, below), illuminant).y;
}

// K/S of the pigment is given; S in all bands the one with which it hides at `hiding_mm`.
void set_scattering(Pigment& pigment, const std::array<double, kBands>& k_over_s, float hiding_mm) {
    const auto with = [&](double s) {
        for (std::size_t band = 0; band < kBands; ++band) {
            pigment.s[band] = static_cast<float>(s);
            pigment.k[band] = static_cast<float>(s * k_over_s[band]);
        }
    };
    // Thickness and S only occur as a product, so one solution serves for all thicknesses.
    with(1 / static_cast<double>(hiding_mm));
    double low = 1e-6, high = 1e4;
    for (int i = 0; i < 60; ++i) {
        const double middle = std::sqrt(low * high);
        const bool hides = contrast_ratio(pigment, static_cast<float>(middle) * hiding_mm) >= 0.98;
        (hides ? high : low) = middle;
    }
    with(high / static_cast<double>(hiding_mm));
}

// What a masstone and its tint with white tell of a paint.
struct TintSolution {
    std::array<double, kBands> q_masstone{}, s{};  // K/S of the masstone, and S; 0 where nothing tells it
    int told = 0;                                  // bands that tell S
    int contradictions = 0;                        // of these: no S explains them
    int same = 0;                                  // bands in which the tint is the masstone
};

TintSolution solved_tint(const Spectrum& masstone, const Spectrum& tint, double c, const Pigment& white) {
    TintSolution solution;
    for (std::size_t band = 0; band < kBands; ++band) {
        const double kw = white.k[band], sw = white.s[band];
        const double q = solution.q_masstone[band] = opaque_k_over_s(masstone[band]),
                     q_tint = opaque_k_over_s(tint[band]);
        // (c K + (1-c) Kw) / (c S + (1-c) Sw) = q_tint with K = q S.
        const double from_white = (1 - c) * (q_tint * sw - kw), against = c * (q - q_tint);
        const double q_white = kw / sw;
        if (std::abs(q - q_white) < 0.05 * (q + q_white)) continue;
        if (std::abs(q - q_tint) < 0.01 * q) {
            ++solution.same;
            continue;
        }
        ++solution.told;
        const double solved = from_white / against;
        if (!(solved > 0)) {
            ++solution.contradictions;
            continue;
        }
        solution.s[band] = std::clamp(solved, kLeastScattering * sw, kMostScattering * sw);
    }
    return solution;
}

// Throws Error where a tint says nothing of its paint, or contradicts the masstone.
void require_told(const TintSolution& solution, const std::string& name, const std::string& white) {
    if (solution.same > solution.told)
        fail(
            "paint '{}': its tint is its masstone in {} of {} bands: where there is no '{}' in it, nothing "
            "tells how "
            "the paint scatters. Give the reflectance of a mixture, or leave the tint out",
            name, solution.same, solution.told + solution.same, white);
    if (solution.contradictions > solution.told / 2)
        fail(
            "paint '{}': its tint is no mixture of its masstone with '{}' in {} of {} bands: masstone and "
            "tint may be "
            "exchanged, or measured with the specular reflection",
            name, white, solution.contradictions, solution.told);
}

}  // namespace

std::string_view name_of(PigmentOrigin origin) {
    switch (origin) {
        case PigmentOrigin::measured:
            break;
        case PigmentOrigin::masstone_and_tint:
            return "masstone and tint";
        case PigmentOrigin::masstone:
            return "masstone";
        case PigmentOrigin::colour:
            return "colour";
    }
    return "measured";
}

Pigment pigment_of_tint(std::string name, const Spectrum& masstone, const Spectrum& tint, float concentration,
                        const Pigment& white) {
    require_reflectance(name, "the masstone", masstone);
    require_reflectance(name, "the tint", tint);
    if (!(concentration > 0 && concentration < 1))
        fail("paint '{}': concentration {} of the tint is outside of (0, 1)", name, concentration);
    TintSolution solution = solved_tint(masstone, tint, concentration, white);
    require_told(solution, name, white.name);
    fill_scattering(solution.s, white);

    Pigment pigment;
    pigment.name = std::move(name);
    pigment.origin = PigmentOrigin::masstone_and_tint;
    for (std::size_t band = 0; band < kBands; ++band) {
        pigment.s[band] = static_cast<float>(solution.s[band]);
        pigment.k[band] = static_cast<float>(solution.s[band] * solution.q_masstone[band]);
    }
    return pigment;
}

Pigment pigment_of_masstone(std::string name, const Spectrum& masstone, float hiding_mm) {
    require_reflectance(name, "the masstone", masstone);
    require_hiding(name, hiding_mm);
    std::array<double, kBands> q{};
    for (std::size_t band = 0; band < kBands; ++band) q[band] = opaque_k_over_s(masstone[band]);
    Pigment pigment;
    pigment.name = std::move(name);
    pigment.origin = PigmentOrigin::masstone;
    set_scattering(pigment, q, hiding_mm);
    return pigment;
}

Pigment pigment_of_rgb(std::string name, const Rgb& linear, float hiding_mm) {
    for (int c = 0; c < 3; ++c)
        if (!(linear[c] >= 0 && linear[c] <= 1))
            fail("paint '{}': {} is {}; linear Rec. 709 of a paint is 0 to 1", name,
                 c == 0   ? "red"
                 : c == 1 ? "green"
                          : "blue",
                 linear[c]);
    Pigment pigment = pigment_of_masstone(std::move(name), reflectance_of_rgb(linear), hiding_mm);
    pigment.origin = PigmentOrigin::colour;
    return pigment;
}

bool is_clear(const Pigment& paint) {
    constexpr float most_per_mm = 0.02f;
    for (std::size_t band = 0; band < kBands; ++band)
        if (paint.k[band] + paint.s[band] >= most_per_mm) return false;
    return true;
}

Pigment finished(Pigment paint, const PaintFinish& finish) {
    validate(finish);
    if (finish.specular) paint.specular = static_cast<float>(*finish.specular);
    if (finish.roughness) paint.roughness = static_cast<float>(*finish.roughness);
    if (finish.medium > 0) {
        const auto left = static_cast<float>(1 - finish.medium);
        for (float& k : paint.k) k *= left;
        for (float& s : paint.s) s *= left;
        paint.medium = 1 - (1 - paint.medium) * left;
    }
    return paint;
}

double contrast_ratio(const Pigment& pigment, float thickness_mm, Illuminant illuminant) {
    return luminance_over(pigment, thickness_mm, 0.01f, illuminant) /
           luminance_over(pigment, thickness_mm, 0.80f, illuminant);
}

double hiding_thickness_mm(const Pigment& pigment, double ratio, Illuminant illuminant) {
    double low = 1e-6, high = 10;
    if (contrast_ratio(pigment, static_cast<float>(high), illuminant) < ratio) return high;
    for (int i = 0; i < 50; ++i) {
        const double middle = std::sqrt(low * high);
        (contrast_ratio(pigment, static_cast<float>(middle), illuminant) >= ratio ? high : low) = middle;
    }
    return high;
}

}  // namespace tangi
