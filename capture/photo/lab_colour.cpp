#include "capture/photo/lab_colour.h"

#include <cmath>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <limits>

namespace tangi {

namespace {

// XYZ under D50 -> linear Rec. 709 under D65: the inverse of sRGB's colorants as ICC profiles have them
// (IEC 61966-2-1, Bradford), columns for X, Y and Z.
const glm::dmat3 kToRec709(3.1338561, -0.9787684, 0.0719453, -1.6168667, 1.9161415, -0.2289914, -0.4906146,
                           0.0334540, 1.4052427);
const glm::dvec3 kD50(0.96422, 1.0, 0.82521);

// CIE 15:2018, equation 8.13 ff.
double part_of_white(double f) {
    constexpr double edge = 6.0 / 29;
    return f > edge ? f * f * f : 3 * edge * edge * (f - 4.0 / 29);
}

}  // namespace

void linear_of_lab(LabKind kind, int bits, std::span<float> values) {
    const double top = bits == 8 ? 255 : 65535, unit = bits == 8 ? 1 : 256;
    const double half = (top + 1) / 2;
    // 16-bit ICC Lab has L* 100 at 0xFF00, as 8 bits shifted.
    const double white = kind == LabKind::icc_lab && bits == 16 ? 65280 : top;
    const auto axis = [&](float stored) {
        const double code = std::round(static_cast<double>(stored) * top);
        if (kind == LabKind::icc_lab) return (code - half) / unit;
        return (code >= half ? code - top - 1 : code) / unit;
    };
    for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
        const double lightness = 100 * std::round(static_cast<double>(values[i]) * top) / white;
        const double fy = (lightness + 16) / 116;
        const double fx = fy + axis(values[i + 1]) / 500, fz = fy - axis(values[i + 2]) / 200;
        const glm::dvec3 xyz(part_of_white(fx), part_of_white(fy), part_of_white(fz));
        const glm::dvec3 rgb = kToRec709 * (kD50 * xyz);
        const bool saturated = lightness >= 100;
        for (int c = 0; c < 3; ++c)
            values[i + static_cast<std::size_t>(c)] = saturated ? std::numeric_limits<float>::quiet_NaN()
                                                                : static_cast<float>(std::max(rgb[c], 0.0));
    }
}

}  // namespace tangi
