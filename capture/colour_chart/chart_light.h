// chart_light.h: how the light falls on a colour chart in each of several photographs, solved together with
// the camera's colours.
//
// A patch of linear Rec. 709 reflectance r at x (chart coordinates, colour_chart.h) reads in photograph p
//     m = exp(f_p(x)) M r
// with one 3x3 matrix M for the camera and all lights (which are taken to have one colour), and a smooth
// field f_p of each photograph: a polynomial in x of first or second degree, which is how a light that is not
// very near lights a small plane.
#pragma once

#include <glm/mat3x3.hpp>
#include <span>

#include "capture/colour_chart/colour_chart.h"

namespace tangi {

// The smooth field of one photograph.
struct ChartLight {
    std::array<double, 6>
        terms{};         // of 1, x, y, x^2, xy, y^2, x and y from the chart's middle in half widths
    bool known = false;  // false: too few good patches, or
    bool dark = false;   // hardly any light beside that of other photographs

    double log_at(int patch) const;
};

struct ChartLights {
    std::vector<ChartLight> lights;                // one a photograph
    glm::dmat3 camera_of_reflectance{1};           // M
    std::array<glm::dvec3, kChartPatches> even{};  // patches as the camera reads them in even light, exp(0)
    std::array<glm::dvec3, kChartPatches> even_sigma{};  // standard errors, from the scatter over photographs
    std::array<int, kChartPatches> photos{};             // that each patch's colour comes from; 0: not known
    std::vector<std::array<bool, kChartPatches>> outliers;  // readings that do not fit: shadows, highlights
    double residual = 0;  // [1] rms relative difference of the readings that fit
};

// Least squares (Levenberg-Marquardt) with Cauchy's function, so that patches in shadow or with a highlight
// do not matter; readings that are off by more than about 8 % are named in `outliers`. `degree` is 1 or 2.
// Patches for which `use` is false take no part, but their colours in even light are told nevertheless.
// Photographs with fewer than 9 good patches are not used. `start`: a fit of the same photographs, near the
// solution.
ChartLights fit_chart_lights(std::span<const ChartReading> photos, const ChartReference& reference,
                             int degree, const std::array<bool, kChartPatches>& use,
                             const ChartLights* start = nullptr);

}  // namespace tangi
