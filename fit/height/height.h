// height.h: height from slopes, by weighted least squares with free boundaries.
#pragma once

#include "fit/pixel/fit_errors.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

struct HeightOptions {
    int max_cycles = 60;         // multigrid V-cycles
    double tolerance = 1e-5;     // [1] residual, relative to that of a flat surface, at which to stop; floats
                                 // may stop it earlier
    double weight_floor = 1e-3;  // [1] weight of pixels that were not measured: > 0, so that the height is
                                 // determined everywhere
    int robust_sweeps = 6;  // how often edges that disagree with the height lose weight, at most; 0: least
                            // squares, which smears cliffs

    static constexpr std::string_view name = "height";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"max_cycles", 1, 1000, "1", "multigrid cycles"}, self.max_cycles);
        visit(FieldInfo{"tolerance", 1e-9, 1, "1", "relative residual at which to stop"}, self.tolerance);
        visit(FieldInfo{"weight_floor", 1e-9, 1, "1", "weight where nothing was measured"},
              self.weight_floor);
        visit(FieldInfo{"robust_sweeps", 0, 100, "1",
                        "how often places that disagree with the height (cliffs) lose weight"},
              self.robust_sweeps);
    }
};

struct HeightReport {
    int cycles = 0;
    double residual = 0;  // [1] relative, at the end
    bool converged = false;
    int robust_sweeps = 0;  // taken
};

// What is integrated. All have one size.
struct MeasuredNormals {
    const Image<Vec3>& normal;
    const Image<float>& confidence;  // [1]
    double mm_per_pixel;
};

// What an integration is for, beside the slopes.
struct HeightTask {
    Image<HalfError>* error_mm = nullptr;  // where not null, becomes height_errors() (height_error.h)
    // What pixels mix was taken out of these normals (subpixel_slopes.h), which leaves less.
    bool steepened = false;
    // height_mm, where it has the size of the normals, is one of about these slopes: cycles begin with it,
    // and the weights of cliffs with what it leaves of the slopes (also without robust_sweeps).
    bool resumes = false;
};

// Fills height_mm with the z that minimises
//   sum over edges (i, j) of w_ij u_ij (z_j - z_i - g_ij)^2,   g_ij = mean slope of i and j times
//   mm_per_pixel, 1 / w_ij = v_i + v_j,   v_i = edge_variance() of slope_edges.h: of the slope's error, by
//   its confidence, and of how much slopes differ around the pixel; pixels of confidence 0 weigh weight_floor
//   of the best,
// over edges between horizontal and vertical neighbours inside the picture: no condition is set at its
// borders (natural boundary; Horn & Brooks 1986). u_ij, 1 at first, becomes cliff_factor() of what the height
// leaves of the edge, in robust_sweeps iterations (iteratively reweighted least squares, Holland & Welsch
// 1977): slopes of a cliff are no integral of its height, and what goes around it knows better. The constant
// is fixed by a mean of 0. Solved by multigrid (height_grid.h), down to the tolerance or to the rounding of
// floats; the result does not depend on the number of threads. Memory beyond the surface: 21 bytes a pixel.
HeightReport integrate_normals(const MeasuredNormals& measured, Image<float>& height_mm,
                               const HeightOptions& options = {}, const Progress& progress = {},
                               const HeightTask& task = {});

}  // namespace tangi
