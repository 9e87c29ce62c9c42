#include "surface/image/colour.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>

#include "surface/math/portable_math.h"

namespace tangi {

namespace {

// ln of the linear value over ln e, of a curve.
double exponent(const Transfer& t, double e) { return t.gamma + e * (t.bend + e * t.bow); }

double decode_curve(const Transfer& t, double e) {
    return e <= 0 ? 0 : std::pow(e, exponent(t, std::min(e, 1.0)));
}

// Newton in ln e, kept between bounds that bisection would give.
double encode_curve(const Transfer& t, double linear) {
    if (linear <= 0) return 0;
    if (linear >= 1) return std::pow(linear, 1 / exponent(t, 1));
    const double target = std::log(linear);
    double low = -std::numeric_limits<double>::infinity(), high = 0, u = target / t.gamma;
    for (int step = 0; step < 60; ++step) {
        const double e = std::exp(u), miss = exponent(t, e) * u - target;
        if (std::abs(miss) < 1e-9) break;
        (miss > 0 ? high : low) = u;
        const double next = u - miss / t.log_slope(e);
        u = next > low && next < high ? next : (std::max(low, 2 * u - 1) + high) / 2;
    }
    return std::exp(u);
}

}  // namespace

double Transfer::log_slope(double encoded) const {
    if (!(encoded > 0)) return gamma;
    return exponent(*this, encoded) + encoded * std::log(encoded) * (bend + 2 * encoded * bow);
}

bool Transfer::is_increasing() const {
    if (kind != Kind::curve) return true;
    constexpr int steps = 512;
    for (int i = 0; i <= steps; ++i)
        if (!(log_slope(i / static_cast<double>(steps)) > 0.02)) return false;
    return true;
}

float Transfer::encode(float linear) const {
    const float x = linear > 0 ? linear : 0;
    switch (kind) {
        case Kind::linear:
            break;
        case Kind::srgb:
            return x <= 0.0031308f ? 12.92f * x : 1.055f * portable::pow(x, 1 / 2.4f) - 0.055f;
        case Kind::gamma:
            return std::pow(x, static_cast<float>(1 / gamma));
        case Kind::curve:
            return static_cast<float>(encode_curve(*this, x));
    }
    return x;
}

float Transfer::decode(float encoded) const {
    const float x = encoded > 0 ? encoded : 0;
    switch (kind) {
        case Kind::linear:
            break;
        case Kind::srgb:
            return x <= 0.04045f ? x / 12.92f : portable::pow((x + 0.055f) / 1.055f, 2.4f);
        case Kind::gamma:
            return std::pow(x, static_cast<float>(gamma));
        case Kind::curve:
            return static_cast<float>(decode_curve(*this, x));
    }
    return x;
}

Rgb Transfer::encode(const Rgb& linear) const {
    return {encode(linear.r), encode(linear.g), encode(linear.b)};
}

Rgb Transfer::decode(const Rgb& encoded) const {
    return {decode(encoded.r), decode(encoded.g), decode(encoded.b)};
}

std::string Transfer::name() const {
    switch (kind) {
        case Kind::linear:
            break;
        case Kind::srgb:
            return "srgb";
        case Kind::gamma:
            return fmt::format("gamma {}", gamma);
        case Kind::curve:
            return fmt::format("curve {} {} {}", gamma, bend, bow);
    }
    return "linear";
}

std::optional<Transfer> transfer_named(std::string_view name) {
    if (name == "linear") return Transfer{Transfer::Kind::linear};
    if (name == "srgb") return Transfer{Transfer::Kind::srgb};
    const bool is_curve = name.starts_with("curve");
    if (is_curve || name.starts_with("gamma")) name.remove_prefix(5);
    std::array<double, 3> number{};
    const std::size_t wanted = is_curve ? 3 : 1;
    for (std::size_t i = 0; i < wanted; ++i) {
        while (name.starts_with(' ')) name.remove_prefix(1);
        const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), number[i]);
        if (status != std::errc()) return std::nullopt;
        name.remove_prefix(static_cast<std::size_t>(end - name.data()));
    }
    if (!name.empty() || !(number[0] >= 0.2 && number[0] <= 5)) return std::nullopt;
    if (!is_curve) return Transfer{Transfer::Kind::gamma, number[0]};
    const Transfer curve{Transfer::Kind::curve, number[0], number[1], number[2]};
    return curve.is_increasing() ? std::optional(curve) : std::nullopt;
}

Lab lab_from_linear(const glm::dvec3& c) {
    // IEC 61966-2-1, divided by the D65 white (0.95047, 1, 1.08883) that its rows add up to.
    const double x = (0.4124564 * c.r + 0.3575761 * c.g + 0.1804375 * c.b) / 0.95047;
    const double y = 0.2126729 * c.r + 0.7151522 * c.g + 0.0721750 * c.b;
    const double z = (0.0193339 * c.r + 0.1191920 * c.g + 0.9503041 * c.b) / 1.08883;
    const auto f = [](double t) {
        constexpr double epsilon = 216.0 / 24389, kappa = 24389.0 / 27;
        return t > epsilon ? std::cbrt(t) : (kappa * t + 16) / 116;
    };
    return {116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))};
}

Rgb linear_from_lab_d50(const Lab& lab) {
    constexpr double epsilon = 216.0 / 24389, kappa = 24389.0 / 27;
    const auto inverse = [](double f) { return f * f * f > epsilon ? f * f * f : (116 * f - 16) / kappa; };
    const double fy = (lab.l + 16) / 116;
    // The white of ICC.1:2010, 7.2.16.
    const glm::dvec3 xyz_d50(0.9642 * inverse(fy + lab.a / 500), inverse(fy),
                             0.8249 * inverse(fy - lab.b / 200));
    // By columns, as glm has them. Cones of Bradford's transform, and both whites in them.
    const glm::dmat3 cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
    const glm::dvec3 from = cones * glm::dvec3(0.9642, 1, 0.8249),
                     to = cones * glm::dvec3(0.95047, 1, 1.08883);
    const glm::dvec3 xyz = glm::inverse(cones) * (to / from * (cones * xyz_d50));
    // The inverse of what lab_from_linear() has, so that both agree to the last digit.
    const glm::dmat3 xyz_of_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375,
                                0.0721750, 0.9503041);
    return Rgb(glm::inverse(xyz_of_rgb) * xyz);
}

double delta_e_2000(const Lab& first, const Lab& second) {
    return glm::length(delta_e_2000_parts(first, second));
}

glm::dvec3 delta_e_2000_parts(const Lab& first, const Lab& second) {
    constexpr double degree = std::numbers::pi / 180;
    const auto seventh = [](double c) {
        return std::sqrt(std::pow(c, 7) / (std::pow(c, 7) + std::pow(25.0, 7)));
    };

    const double chroma_ab = (std::hypot(first.a, first.b) + std::hypot(second.a, second.b)) / 2;
    const double g = 0.5 * (1 - seventh(chroma_ab));
    const double a1 = (1 + g) * first.a, a2 = (1 + g) * second.a;
    const double c1 = std::hypot(a1, first.b), c2 = std::hypot(a2, second.b);
    const auto hue_deg = [&](double a, double b) {
        if (a == 0 && b == 0) return 0.0;
        const double h = std::atan2(b, a) / degree;
        return h < 0 ? h + 360 : h;
    };
    const double h1 = hue_deg(a1, first.b), h2 = hue_deg(a2, second.b);

    // A 180 degree difference is ambiguous: the tolerance keeps rounding from choosing the other branch.
    constexpr double tie = 180 + 1e-9;
    const bool achromatic = c1 * c2 == 0;
    double hue_difference = h2 - h1;
    if (hue_difference > tie) hue_difference -= 360;
    if (hue_difference < -tie) hue_difference += 360;
    if (achromatic) hue_difference = 0;
    double hue_mean = h1 + h2;
    if (!achromatic) {
        if (std::abs(h1 - h2) > tie) hue_mean += h1 + h2 < 360 ? 360 : -360;
        hue_mean /= 2;
    }

    const double delta_l = second.l - first.l, delta_c = c2 - c1;
    const double delta_h = 2 * std::sqrt(c1 * c2) * std::sin(hue_difference / 2 * degree);
    const double l_mean = (first.l + second.l) / 2, c_mean = (c1 + c2) / 2;
    const double t = 1 - 0.17 * std::cos((hue_mean - 30) * degree) + 0.24 * std::cos(2 * hue_mean * degree) +
                     0.32 * std::cos((3 * hue_mean + 6) * degree) -
                     0.20 * std::cos((4 * hue_mean - 63) * degree);
    const double rotation = 30 * std::exp(-std::pow((hue_mean - 275) / 25, 2));
    const double l50 = (l_mean - 50) * (l_mean - 50);
    const double s_l = 1 + 0.015 * l50 / std::sqrt(20 + l50);
    const double s_c = 1 + 0.045 * c_mean;
    const double s_h = 1 + 0.015 * c_mean * t;
    const double r_t = -std::sin(2 * rotation * degree) * 2 * seventh(c_mean);
    const double l = delta_l / s_l, c = delta_c / s_c, h = delta_h / s_h;
    // The same sum of squares as l^2 + c^2 + h^2 + r_t c h; |r_t| < 2.
    return {l, c + r_t / 2 * h, std::sqrt(1 - r_t * r_t / 4) * h};
}

}  // namespace tangi
