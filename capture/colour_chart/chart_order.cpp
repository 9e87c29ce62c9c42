#include "capture/colour_chart/chart_order.h"

#include <glm/matrix.hpp>
#include <limits>

#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kDarkReflectance = 0.02;  // [1] reflectance below which errors count absolutely
constexpr double kOutlierMisfit = 0.06;    // [1] misfit, in cube roots, at which a patch weighs half
constexpr int kReweightings = 8;

dvec3 roots(const dvec3& linear) {
    return {std::cbrt(std::max(0.0, linear.r)), std::cbrt(std::max(0.0, linear.g)),
            std::cbrt(std::max(0.0, linear.b))};
}

double luminance_of(const dvec3& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

dvec2 centre_of(std::size_t patch) {
    const std::size_t column = patch % kChartColumns, row = patch / kChartColumns;
    return {static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
}

// Weighted least squares of target = matrix * colour.
dmat3 matrix_between(const ChartColours& colours, const ChartColours& target,
                     const std::array<double, 24>& weight) {
    dmat3 square(0), product(0);
    double trace = 0;
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        if (!(weight[i] > 0)) continue;
        square += weight[i] * glm::outerProduct(colours[i], colours[i]);
        product += weight[i] * glm::outerProduct(target[i], colours[i]);
        trace += weight[i] * glm::dot(colours[i], colours[i]);
    }
    // What is grey all over has no matrix; a little of the identity gives it one.
    return product * glm::inverse(square + dmat3(1e-9 * trace + 1e-30));
}

// The plane c0 + c1 x + c2 y through values at the patches, by weighted least squares.
dvec3 plane_through(const std::array<double, 24>& values, const std::array<double, 24>& weight) {
    dmat3 square(1e-9);
    dvec3 right(0);
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        const dvec3 terms(1, centre_of(i) - dvec2(3, 2));
        square += weight[i] * glm::outerProduct(terms, terms);
        right += weight[i] * values[i] * terms;
    }
    return glm::inverse(square) * right;
}

const ChartColours& classic_colours() {
    static const ChartColours colours = [] {
        ChartColours c;
        const ChartReference reference = classic_chart();
        for (std::size_t i = 0; i < kChartPatches; ++i) c[i] = dvec3(reference.patches[i].linear);
        return c;
    }();
    return colours;
}

}  // namespace

ChartColours sampled_patches(const Image<Rgb>& linear, const Homography& chart_to_picture) {
    constexpr int kSide = 7;  // samples along a patch
    ChartColours colours;
    for (std::size_t patch = 0; patch < kChartPatches; ++patch) {
        std::array<std::vector<float>, 3> values;
        bool inside = true;
        for (int j = 0; j < kSide && inside; ++j)
            for (int i = 0; i < kSide && inside; ++i) {
                const dvec2 place = centre_of(patch) + 0.4 * (dvec2(i, j) / (kSide - 1.0) - 0.5);
                const dvec2 p = mapped(chart_to_picture, place);
                inside = p.x >= 0 && p.y >= 0 && p.x <= linear.width() - 1 && p.y <= linear.height() - 1;
                if (!inside) break;
                const Rgb& c = linear(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)));
                for (std::size_t k = 0; k < 3; ++k) values[k].push_back(c[static_cast<int>(k)]);
            }
        colours[patch] = inside ? dvec3(median(values[0]), median(values[1]), median(values[2])) : dvec3(-1);
    }
    return colours;
}

double order_misfit(const ChartColours& colours) {
    const ChartColours& target = classic_colours();
    std::array<double, 24> weight{}, base{}, light{};
    int seen = 0;
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        const double size = luminance_of(target[i]) + kDarkReflectance;
        base[i] = colours[i].r < 0 ? 0 : 1 / (size * size);
        seen += base[i] > 0;
    }
    if (seen < 12) return std::numeric_limits<double>::infinity();
    weight = base;
    ChartColours evened = colours;
    std::vector<double> misfits;
    for (int step = 0; step < kReweightings; ++step) {
        const dmat3 matrix = matrix_between(evened, target, weight);
        std::array<double, 24> ratio{}, trust{};
        misfits.clear();
        for (std::size_t i = 0; i < kChartPatches; ++i) {
            if (!(base[i] > 0)) continue;
            const dvec3 fitted = matrix * evened[i];
            const double misfit = glm::length(roots(fitted) - roots(target[i]));
            misfits.push_back(misfit);
            const double robust = 1 / (1 + misfit * misfit / (kOutlierMisfit * kOutlierMisfit));
            weight[i] = base[i] * robust;
            trust[i] = robust;
            ratio[i] =
                std::log(std::max(1e-3, luminance_of(fitted)) / std::max(1e-3, luminance_of(target[i])));
        }
        const dvec3 plane = plane_through(ratio, trust);
        for (std::size_t i = 0; i < kChartPatches; ++i) {
            light[i] += glm::dot(plane, dvec3(0, centre_of(i) - dvec2(3, 2)));
            if (base[i] > 0) evened[i] = colours[i] * std::exp(-std::clamp(light[i], -3.0, 3.0));
        }
    }
    return median(misfits);
}

}  // namespace tangi
