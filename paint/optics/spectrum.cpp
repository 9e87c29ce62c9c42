#include "paint/optics/spectrum.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "paint/optics/spectrum_tables.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr std::array<std::string_view, kIlluminants> kIlluminantNames = {"A", "D50", "D65", "F11", "LED"};

const std::array<Spectrum, 3>& weights_of(Illuminant illuminant) {
    return kXyzWeights[static_cast<std::size_t>(illuminant)];
}

double dot(const Spectrum& a, const Spectrum& b) {
    double sum = 0;
    for (std::size_t i = 0; i < kBands; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    return sum;
}

// From XYZ under the light to linear Rec. 709 under D65, white to white.
glm::dmat3 rgb_of_xyz(Illuminant illuminant) {
    // By columns, as glm has them; the same matrices as in surface/image/colour.cpp.
    const glm::dmat3 cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
    const glm::dmat3 xyz_of_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375,
                                0.0721750, 0.9503041);
    const glm::dvec3 from = cones * white_xyz(illuminant), to = cones * (xyz_of_rgb * glm::dvec3(1));
    glm::dmat3 scale(0);
    for (int i = 0; i < 3; ++i) scale[i][i] = to[i] / from[i];
    return glm::inverse(xyz_of_rgb) * glm::inverse(cones) * scale * cones;
}

std::array<std::array<Spectrum, 3>, kIlluminants> all_rgb_weights() {
    std::array<std::array<Spectrum, 3>, kIlluminants> all;
    for (std::size_t light = 0; light < kIlluminants; ++light) {
        const glm::dmat3 matrix = rgb_of_xyz(static_cast<Illuminant>(light));
        for (std::size_t band = 0; band < kBands; ++band) {
            const auto& xyz = kXyzWeights[light];
            const glm::dvec3 rgb = matrix * glm::dvec3(xyz[0][band], xyz[1][band], xyz[2][band]);
            for (int c = 0; c < 3; ++c)
                all[light][static_cast<std::size_t>(c)][band] = static_cast<float>(rgb[c]);
        }
    }
    return all;
}

const std::array<Spectrum, 3>& cached_rgb_weights(Illuminant illuminant) {
    static const auto all = all_rgb_weights();
    return all[static_cast<std::size_t>(illuminant)];
}

}  // namespace

std::string_view name_of(Illuminant illuminant) {
    return kIlluminantNames[static_cast<std::size_t>(illuminant)];
}

std::optional<Illuminant> illuminant_named(std::string_view name) {
    const auto upper = [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; };
    for (std::size_t i = 0; i < kIlluminants; ++i)
        if (std::equal(name.begin(), name.end(), kIlluminantNames[i].begin(), kIlluminantNames[i].end(),
                       [&](char a, char b) { return upper(a) == upper(b); }))
            return static_cast<Illuminant>(i);
    return std::nullopt;
}

glm::dvec3 xyz_of(const Spectrum& reflectance, Illuminant illuminant) {
    const auto& weights = weights_of(illuminant);
    return {dot(weights[0], reflectance), dot(weights[1], reflectance), dot(weights[2], reflectance)};
}

glm::dvec3 white_xyz(Illuminant illuminant) {
    Spectrum white;
    white.fill(1);
    return xyz_of(white, illuminant);
}

std::array<Spectrum, 3> rgb_weights(Illuminant illuminant) { return cached_rgb_weights(illuminant); }

Rgb to_linear_rgb(const Spectrum& reflectance, Illuminant illuminant) {
    const auto& weights = cached_rgb_weights(illuminant);
    Rgb rgb(0);
    for (int c = 0; c < 3; ++c)
        for (std::size_t band = 0; band < kBands; ++band)
            rgb[c] += weights[static_cast<std::size_t>(c)][band] * reflectance[band];
    return rgb;
}

Lab lab_under(const Spectrum& reflectance, Illuminant illuminant) {
    const glm::dvec3 t = xyz_of(reflectance, illuminant) / white_xyz(illuminant);
    const auto f = [](double x) {
        constexpr double epsilon = 216.0 / 24389, kappa = 24389.0 / 27;
        return x > epsilon ? portable::cbrt(x) : (kappa * x + 16) / 116;
    };
    return {116 * f(t.y) - 16, 500 * (f(t.x) - f(t.y)), 200 * (f(t.y) - f(t.z))};
}

const std::array<Spectrum, 3>& rgb_basis() { return kRgbBasis; }

Spectrum reflectance_of_rgb(const Rgb& linear) {
    Spectrum reflectance;
    for (std::size_t band = 0; band < kBands; ++band)
        reflectance[band] = std::clamp(
            linear.r * kRgbBasis[0][band] + linear.g * kRgbBasis[1][band] + linear.b * kRgbBasis[2][band],
            0.0f, 1.0f);
    return reflectance;
}

}  // namespace tangi
