#include "fit/height/height.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/height/height_error.h"
#include "fit/height/height_grid.h"
#include "fit/height/slope_edges.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// [1] Residual at which weights are taken anew; they are no better known.
constexpr double kSweepTolerance = 1e-3;
// [1] Part of the cycles that are left after which they are taken anew all the same. Where cliffs are many (a
// third of the edges of an imported relief of 12.7 megapixels) cycles gain little, and none were left for the
// height that goes with the last weights. Fewer would take long waves that are still on their way for cliffs.
constexpr int kSweepPart = 3;

// Cycles until the residual is `tolerance` of `flat`, or that of rounding; or there were `most` of `all`.
void solve(HeightMultigrid& grid, double flat, double tolerance, int most, int all, HeightReport& result,
           const Progress& progress) {
    result.converged = !(flat > 0);
    result.residual = result.converged ? 0 : 1;
    double before = std::numeric_limits<double>::infinity();
    while (!result.converged && result.cycles < most) {
        report(progress, "height", result.cycles / static_cast<double>(all));
        grid.cycle();
        ++result.cycles;
        const auto [left, rounding] = grid.norms();
        result.residual = left / flat;
        // A residual like that of rounding is not rounding yet while it falls: long waves are the last to
        // come right and show least in it.
        result.converged = result.residual <= tolerance || left <= 0.3 * rounding ||
                           (left <= rounding && left > 0.5 * before);
        before = left;
    }
}

// The grid and its memory are gone when this returns.
HeightReport solve_robustly(SlopeEdges& edges, Image<float>& height_mm, const HeightOptions& options,
                            bool resumes, const Progress& progress) {
    HeightMultigrid grid(edges.right, edges.down, height_mm);
    edges.divergence(grid.b());
    grid.coarsen();
    const double flat = grid.flat();
    if (!resumes) grid.start();
    HeightReport result;
    for (int sweep = 0; flat > 0 && sweep < options.robust_sweeps; ++sweep) {
        // Not before the height is nearly that of these weights: else long waves that are still on their way
        // pass for cliffs.
        const int most = result.cycles + (options.max_cycles - result.cycles) / kSweepPart;
        solve(grid, flat, std::max(options.tolerance, kSweepTolerance), most, options.max_cycles, result,
              progress);
        const SlopeEdges::Moved moved = edges.weigh(&height_mm);
        edges.divergence(grid.b());
        grid.coarsen();
        ++result.robust_sweeps;
        if (moved.cliffs == 0) break;
    }
    solve(grid, flat, options.tolerance, options.max_cycles, options.max_cycles, result, progress);
    return result;
}

}  // namespace

HeightReport integrate_normals(const Image<Vec3>& normal, const Image<float>& confidence, double mm_per_pixel,
                               Image<float>& height_mm, const HeightOptions& options,
                               const Progress& progress, const HeightTask& task) {
    TP_REQUIRE(normal.region() == confidence.region(), "normals and confidence have one size");
    TP_REQUIRE(normal.size() > 0 && mm_per_pixel > 0, "there are pixels, of a positive size");
    validate(options);
    const bool resumes = task.resumes && height_mm.region() == normal.region();
    if (height_mm.region() != normal.region()) height_mm = Image<float>(normal.width(), normal.height());

    SlopeEdges edges(normal, confidence, mm_per_pixel, options.weight_floor);
    const Slope tilt = edges.tilt();
    if (resumes)
        subtract({tilt.x * mm_per_pixel, tilt.y * mm_per_pixel, 0}, height_mm);
    else
        std::fill(height_mm.pixels().begin(), height_mm.pixels().end(), 0.0f);
    edges.weigh(resumes ? &height_mm : nullptr);
    HeightReport result = solve_robustly(edges, height_mm, options, resumes, progress);
    if (task.steepened) edges.offset_part = kSteepenedOffset;
    if (task.error_mm) *task.error_mm = height_errors(edges, height_mm, progress);
    subtract({-tilt.x * mm_per_pixel, -tilt.y * mm_per_pixel, 0}, height_mm);
    remove_mean(height_mm);
    report(progress, "height", 1);
    return result;
}

}  // namespace tangi
