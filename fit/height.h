// height.h: height from slopes, by weighted least squares with free boundaries.
#pragma once

#include "surface/options.h"
#include "surface/progress.h"
#include "surface/surface.h"

namespace tangi {

struct HeightOptions {
    int max_cycles = 60;         // multigrid V-cycles
    double tolerance = 1e-5;     // [1] residual, relative to that of a flat surface, at which to stop; floats
                                 // may stop it earlier
    double weight_floor = 1e-3;  // [1] weight of pixels that were not measured: > 0, so that the height is
                                 // determined everywhere

    static constexpr std::string_view name = "height";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"max_cycles", 1, 1000, "1", "multigrid cycles"}, self.max_cycles);
        visit(FieldInfo{"tolerance", 1e-9, 1, "1", "relative residual at which to stop"}, self.tolerance);
        visit(FieldInfo{"weight_floor", 1e-9, 1, "1", "weight where nothing was measured"},
              self.weight_floor);
    }
};

struct HeightReport {
    int cycles = 0;
    double residual = 0;  // [1] relative, at the end
    bool converged = false;
};

// Fills height_mm with the z that minimises
//   sum over edges (i, j) of w_ij (z_j - z_i - g_ij)^2,   g_ij = mean slope of i and j times mm_per_pixel,
//   w_ij = min(w_i, w_j),   w_i = confidence_i + 0.01, or weight_floor where confidence_i = 0,
// over edges between horizontal and vertical neighbours inside the picture: no condition is set at its
// borders (natural boundary; Horn & Brooks 1986). The constant is fixed by a mean of 0. Solved by full
// multigrid with red-black Gauss-Seidel smoothing (Briggs, Henson, McCormick 2000, ch. 3 and 6) and
// energy-minimising coarse steps, down to the tolerance or to the rounding of floats; the result does not
// depend on the number of threads. Memory beyond the surface: 15 bytes a pixel.
HeightReport integrate_normals(const Image<Vec3>& normal, const Image<float>& confidence, double mm_per_pixel,
                               Image<float>& height_mm, const HeightOptions& options = {},
                               const Progress& progress = {});

}  // namespace tangi
