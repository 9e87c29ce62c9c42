#include "fit/pipeline/final_height.h"

#include <algorithm>
#include <array>
#include <utility>

#include "fit/height/height_error.h"
#include "fit/height/subpixel_slopes.h"
#include "fit/light_checks/axis_check_shadows.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

// Tried upwards as long as shadows agree better. Slopes that change evenly have 1/12; beyond about 1/4 it
// also makes up for flanks that photometric stereo takes for flatter than they are.
constexpr std::array kMixings = {0.2, 0.4, 0.8};
// [1] Of the misfit: what gains less is left as it is.
constexpr double kShadowsClearlyBetter = 0.01;
// [1] HeightOptions::max_cycles and tolerance of what is tried: enough for shadows.
constexpr int kTrialCycles = 30;
constexpr double kTrialTolerance = 1e-3;
constexpr int kSweepsOfTrial = 1;  // once cliffs are known

// The edges with the weights that the height came from.
SlopeEdges edges_of(const Surface& surface, const Image<Vec3>& normal, const HeightOptions& options,
                    const HeightChoice& choice, const Plane& plane) {
    SlopeEdges edges(normal, surface.confidence, surface.mm_per_pixel, options.weight_floor);
    edges.weigh(nullptr);
    if (!choice.cliffs) return edges;
    Image<float> untilted = surface.height_mm;
    const Slope tilt = edges.tilt();
    subtract({tilt.x * surface.mm_per_pixel - plane.a, tilt.y * surface.mm_per_pixel - plane.b, 0}, untilted);
    edges.weigh(&untilted);
    return edges;
}

// `steeper`: empty where slopes were integrated as they are. Errors stay those of the height that the slopes
// lead to: this one is nearer to the truth (fit_tests --gtest_filter='HeightCoverage.*').
void carve(Surface& surface, const Lighting& lighting, const HeightOptions& options,
           const Image<Vec3>& steeper, const LightVisibility& lights, const std::function<double()>& misfit,
           FinalHeight& result, const Progress& progress) {
    const SlopeEdges edges =
        edges_of(surface, steeper.empty() ? surface.normal : steeper, options, result.choice, result.plane);
    HeightChoice& choice = result.choice;
    const double then = misfit();
    Image<float> before = surface.height_mm;
    choice.carved = carve_shadows(lights, lighting, edges, surface, progress);
    if (choice.carved.contradicted == 0) return;
    const Plane plane = best_plane(surface.height_mm, surface.confidence);
    subtract(plane, surface.height_mm);
    choice.carving_kept = misfit() < (1 - kShadowsClearlyBetter) * then;
    if (!choice.carving_kept) {
        std::swap(surface.height_mm, before);
        choice.carved.left = choice.carved.contradicted;
        return;
    }
    result.plane = {result.plane.a + plane.a, result.plane.b + plane.b, result.plane.c + plane.c};
}

}  // namespace

FinalHeight final_height(Surface& surface, const Survey& survey, const Transfer& transfer,
                         const Lighting& lighting, const HeightOptions& options,
                         const HeightEvidence& evidence, Image<HalfError>* error_mm,
                         const Progress& progress) {
    FinalHeight result;
    HeightChoice& choice = result.choice;
    Image<float> before;  // as `refined`
    if (evidence.refined) before = std::exchange(surface.height_mm, {});
    Image<Vec3> steeper;  // empty: slopes as they are
    const auto take = [&](double mixing) {
        choice.mixing = mixing;
        steeper = mixing > 0 ? steepened_normals(surface.normal, surface.confidence, mixing) : Image<Vec3>();
    };
    const auto with_sweeps = [&](int robust_sweeps) {
        HeightOptions height = options;
        height.robust_sweeps = robust_sweeps;
        return height;
    };
    const auto trial = [&](int robust_sweeps) {
        HeightOptions height = with_sweeps(robust_sweeps);
        height.max_cycles = std::min(kTrialCycles, options.max_cycles);
        height.tolerance = std::max(kTrialTolerance, options.tolerance);
        return height;
    };
    // `resumes`: from what was integrated last. Past cliffs long waves come right slowly.
    const auto integrate = [&](const HeightOptions& height, bool resumes, Image<HalfError>* errors,
                               const Progress& shown) {
        if (resumes) subtract({-result.plane.a, -result.plane.b, -result.plane.c}, surface.height_mm);
        result.report =
            integrate_normals(steeper.empty() ? surface.normal : steeper, surface.confidence,
                              surface.mm_per_pixel, surface.height_mm, height, shown,
                              {.error_mm = errors, .steepened = !steeper.empty(), .resumes = resumes});
        result.plane = best_plane(surface.height_mm, surface.confidence);
        subtract(result.plane, surface.height_mm);
    };
    const auto misfit = [&] {
        return shadow_misfit(surface, survey, transfer, lighting.lights, lighting.white_level,
                             light_radius_deg(surface, {}));
    };
    constexpr double trials = 2 + kMixings.size();
    double tried = 0;
    const auto misfit_with = [&](bool cliffs, int robust_sweeps) {
        integrate(trial(robust_sweeps), cliffs, nullptr, Progress([&](std::string_view, double done) {
                      return !progress || progress("cliffs", (tried + done) / trials);
                  }));
        ++tried;
        choice.trials.push_back({cliffs, choice.mixing, false, misfit()});
        return choice.trials.back().shadow_misfit;
    };
    int sweeps = 0;
    // Slopes that mix less have nearly the same cliffs, but not the same differences beside them.
    const auto sweeps_of_trial = [&] { return std::min(sweeps, kSweepsOfTrial); };
    // Shadows tell one mixing for all pixels, in steps of two: at a pixel it may as well be half of that.
    Image<float> less_steep;
    if (evidence.shadows_tell) {
        double least = misfit_with(false, 0);
        // Cliffs are where photographs show their shadows. Slopes that err by more than they say disagree
        // everywhere.
        if (options.robust_sweeps > 0)
            if (const double now = misfit_with(true, options.robust_sweeps);
                now < (1 - kShadowsClearlyBetter) * least) {
                least = now;
                sweeps = options.robust_sweeps;
            }
        double chosen = 0;
        for (const double mixing : kMixings) {
            take(mixing);
            const double now = misfit_with(sweeps > 0, sweeps_of_trial());
            if (!(now < (1 - kShadowsClearlyBetter) * least)) break;
            least = now;
            chosen = mixing;
        }
        if (chosen > 0 && error_mm) {
            take(chosen / 2);
            integrate(trial(sweeps_of_trial()), sweeps > 0, nullptr, {});
            less_steep = surface.height_mm;
        }
        take(chosen);
        report(progress, "cliffs", 1);  // the steepest are only tried where less steep ones are better
    }
    choice.cliffs = sweeps > 0;
    integrate(with_sweeps(sweeps), sweeps > 0, error_mm, progress);
    if (!less_steep.empty()) add_disagreement(surface.height_mm, less_steep, *error_mm);
    if (!before.empty()) {
        const double now = misfit();
        std::swap(surface.height_mm, before);
        const double then = misfit();
        if (!evidence.shadows_tell) choice.trials.push_back({choice.cliffs, choice.mixing, false, now});
        choice.trials.push_back({false, 0, true, then});
        choice.before_refining = then < (1 - kShadowsClearlyBetter) * now;
        if (choice.before_refining) {
            choice.cliffs = false, choice.mixing = 0, steeper = {};
            // The errors are of the height that the slopes lead to; this one differs from it by more.
            if (error_mm) add_disagreement(surface.height_mm, before, *error_mm);
        } else
            std::swap(surface.height_mm, before);
    }
    before = {};
    if (evidence.lights && !evidence.lights->empty())
        carve(surface, lighting, options, steeper, *evidence.lights, misfit, result, progress);
    return result;
}

nlohmann::json to_json(const HeightChoice& choice) {
    nlohmann::json trials = nlohmann::json::array();
    for (const HeightChoice::Trial& trial : choice.trials)
        trials.push_back({{"cliffs", trial.cliffs},
                          {"subpixel_slope_bias", trial.mixing},
                          {"before_refining", trial.before_refining},
                          {"shadow_misfit", trial.shadow_misfit}});
    return {{"cliffs", choice.cliffs},
            {"subpixel_slope_bias", choice.mixing},
            {"before_refining", choice.before_refining},
            {"carved", choice.carving_kept},
            {"light_visibility",
             {{"all", choice.carved.lights},
              {"contradicted_before", choice.carved.contradicted},
              {"contradicted", choice.carved.left}}},
            {"tried", trials}};
}

}  // namespace tangi
