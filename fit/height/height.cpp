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

// The cycles of one integration, over all of its sweeps. The grid and its memory are gone with it.
class HeightCycles {
public:
    HeightCycles(SlopeEdges& edges, Image<float>& height_mm, const HeightOptions& options,
                 const Progress& progress)
        : edges_(edges),
          height_mm_(height_mm),
          options_(options),
          progress_(progress),
          grid_(edges.right, edges.down, height_mm) {
        take_edges();
        flat_ = grid_.flat();
    }
    // `resumes`: from the height as it is.
    HeightReport solve_robustly(bool resumes);

private:
    // The equations of the edges as they are weighted now.
    void take_edges() {
        edges_.divergence(grid_.b());
        grid_.coarsen();
    }
    void solve(double tolerance, int most);

    SlopeEdges& edges_;
    Image<float>& height_mm_;
    const HeightOptions& options_;
    const Progress& progress_;
    HeightMultigrid grid_;
    double flat_ = 0;  // residual of a flat surface
    HeightReport result_;
};

// Cycles until the residual is `tolerance` of that of a flat surface, or that of rounding; or there were
// `most` of all.
void HeightCycles::solve(double tolerance, int most) {
    result_.converged = !(flat_ > 0);
    result_.residual = result_.converged ? 0 : 1;
    double before = std::numeric_limits<double>::infinity();
    while (!result_.converged && result_.cycles < most) {
        report(progress_, "height", result_.cycles / static_cast<double>(options_.max_cycles));
        grid_.cycle();
        ++result_.cycles;
        const auto [left, rounding] = grid_.norms();
        result_.residual = left / flat_;
        // A residual like that of rounding is not rounding yet while it falls: long waves are the last to
        // come right and show least in it.
        result_.converged = result_.residual <= tolerance || left <= 0.3 * rounding ||
                            (left <= rounding && left > 0.5 * before);
        before = left;
    }
}

HeightReport HeightCycles::solve_robustly(bool resumes) {
    if (!resumes) grid_.start();
    for (int sweep = 0; flat_ > 0 && sweep < options_.robust_sweeps; ++sweep) {
        // Not before the height is nearly that of these weights: else long waves that are still on their way
        // pass for cliffs.
        solve(std::max(options_.tolerance, kSweepTolerance),
              result_.cycles + (options_.max_cycles - result_.cycles) / kSweepPart);
        const SlopeEdges::Moved moved = edges_.weigh(&height_mm_);
        take_edges();
        ++result_.robust_sweeps;
        if (moved.cliffs == 0) break;
    }
    solve(options_.tolerance, options_.max_cycles);
    return result_;
}

}  // namespace

HeightReport integrate_normals(const MeasuredNormals& measured, Image<float>& height_mm,
                               const HeightOptions& options, const Progress& progress,
                               const HeightTask& task) {
    const auto& [normal, confidence, mm_per_pixel] = measured;
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
    HeightReport result = HeightCycles(edges, height_mm, options, progress).solve_robustly(resumes);
    if (task.steepened) edges.offset_part = kSteepenedOffset;
    if (task.error_mm) *task.error_mm = height_errors(edges, height_mm, progress);
    subtract({-tilt.x * mm_per_pixel, -tilt.y * mm_per_pixel, 0}, height_mm);
    remove_mean(height_mm);
    report(progress, "height", 1);
    return result;
}

}  // namespace tangi
