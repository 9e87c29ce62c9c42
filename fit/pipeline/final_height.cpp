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

bool clearly_better(double misfit, double other) { return misfit < (1 - kShadowsClearlyBetter) * other; }

// The height by variants of slopes and weights; surface.height_mm is the last that was integrated, less its
// plane.
class HeightSearch {
public:
    HeightSearch(Surface& surface, const LitSurvey& samples, const HeightOptions& options,
                 Image<HalfError>* error_mm, const Progress& progress)
        : surface_(surface), samples_(samples), options_(options), error_mm_(error_mm), progress_(progress) {}

    // Which variant shadows agree with best.
    void find_variant();
    // The height of that variant, with its errors.
    void integrate_variant();
    // Whether the height that hid lights in the second pass is nearer to the shadows.
    void compare_with(Image<float> before_refining, bool shadows_tell);
    // Errors stay those of the height that the slopes lead to: this one is nearer to the truth (fit_tests
    // --gtest_filter='HeightCoverage.*').
    void carve(const LightVisibility& lights);
    const FinalHeight& found() const { return result_; }

private:
    const Image<Vec3>& normals() const { return steeper_.empty() ? surface_.normal : steeper_; }
    void take_mixing(double mixing);
    double find_mixing(double least);
    HeightOptions with_sweeps(int robust_sweeps) const;
    HeightOptions trial(int robust_sweeps) const;
    // Slopes that mix less have nearly the same cliffs, but not the same differences beside them.
    int sweeps_of_trial() const { return std::min(sweeps_, kSweepsOfTrial); }
    void integrate(const HeightOptions& height, bool resumes, Image<HalfError>* errors,
                   const Progress& shown);
    double misfit() const;
    double misfit_with(bool cliffs, int robust_sweeps);

    Surface& surface_;
    const LitSurvey& samples_;
    const HeightOptions& options_;
    Image<HalfError>* error_mm_;
    const Progress& progress_;
    FinalHeight result_;
    HeightChoice& choice_ = result_.choice;
    Image<Vec3> steeper_;  // empty: slopes are integrated as they are
    int sweeps_ = 0;       // HeightOptions::robust_sweeps of the variant
    // Shadows tell one mixing for all pixels, in steps of two: at a pixel it may as well be half of that.
    Image<float> less_steep_;
};

void HeightSearch::take_mixing(double mixing) {
    choice_.mixing = mixing;
    steeper_ = mixing > 0 ? steepened_normals(surface_.normal, surface_.confidence, mixing) : Image<Vec3>();
}

HeightOptions HeightSearch::with_sweeps(int robust_sweeps) const {
    HeightOptions height = options_;
    height.robust_sweeps = robust_sweeps;
    return height;
}

HeightOptions HeightSearch::trial(int robust_sweeps) const {
    HeightOptions height = with_sweeps(robust_sweeps);
    height.max_cycles = std::min(kTrialCycles, options_.max_cycles);
    height.tolerance = std::max(kTrialTolerance, options_.tolerance);
    return height;
}

// `resumes`: from what was integrated last. Past cliffs long waves come right slowly.
void HeightSearch::integrate(const HeightOptions& height, bool resumes, Image<HalfError>* errors,
                             const Progress& shown) {
    Plane& plane = result_.plane;
    if (resumes) subtract({-plane.a, -plane.b, -plane.c}, surface_.height_mm);
    result_.report =
        integrate_normals({normals(), surface_.confidence, surface_.mm_per_pixel}, surface_.height_mm, height,
                          shown, {.error_mm = errors, .steepened = !steeper_.empty(), .resumes = resumes});
    plane = best_plane(surface_.height_mm, surface_.confidence);
    subtract(plane, surface_.height_mm);
}

double HeightSearch::misfit() const {
    return shadow_misfit(surface_, samples_, light_radius_deg(surface_, {}));
}

double HeightSearch::misfit_with(bool cliffs, int robust_sweeps) {
    constexpr double trials = 2 + kMixings.size();
    const auto tried = static_cast<double>(choice_.trials.size());
    integrate(trial(robust_sweeps), cliffs, nullptr, Progress([&](std::string_view, double done) {
                  return !progress_ || progress_("cliffs", (tried + done) / trials);
              }));
    choice_.trials.push_back({cliffs, choice_.mixing, false, misfit()});
    return choice_.trials.back().shadow_misfit;
}

// `least`: the misfit of slopes as they are.
double HeightSearch::find_mixing(double least) {
    double chosen = 0;
    for (const double mixing : kMixings) {
        take_mixing(mixing);
        const double now = misfit_with(sweeps_ > 0, sweeps_of_trial());
        if (!clearly_better(now, least)) break;
        least = now;
        chosen = mixing;
    }
    return chosen;
}

void HeightSearch::find_variant() {
    double least = misfit_with(false, 0);
    // Cliffs are where photographs show their shadows. Slopes that err by more than they say disagree
    // everywhere.
    if (options_.robust_sweeps > 0)
        if (const double now = misfit_with(true, options_.robust_sweeps); clearly_better(now, least)) {
            least = now;
            sweeps_ = options_.robust_sweeps;
        }
    const double mixing = find_mixing(least);
    if (mixing > 0 && error_mm_) {
        take_mixing(mixing / 2);
        integrate(trial(sweeps_of_trial()), sweeps_ > 0, nullptr, {});
        less_steep_ = surface_.height_mm;
    }
    take_mixing(mixing);
    report(progress_, "cliffs", 1);  // the steepest are only tried where less steep ones are better
}

void HeightSearch::integrate_variant() {
    choice_.cliffs = sweeps_ > 0;
    integrate(with_sweeps(sweeps_), sweeps_ > 0, error_mm_, progress_);
    if (!less_steep_.empty()) add_disagreement(surface_.height_mm, less_steep_, *error_mm_);
}

void HeightSearch::compare_with(Image<float> before_refining, bool shadows_tell) {
    const double now = misfit();
    std::swap(surface_.height_mm, before_refining);
    const double then = misfit();
    if (!shadows_tell) choice_.trials.push_back({choice_.cliffs, choice_.mixing, false, now});
    choice_.trials.push_back({false, 0, true, then});
    choice_.before_refining = clearly_better(then, now);
    if (choice_.before_refining) {
        choice_.cliffs = false, choice_.mixing = 0, steeper_ = {};
        // The errors are of the height that the slopes lead to; this one differs from it by more.
        if (error_mm_) add_disagreement(surface_.height_mm, before_refining, *error_mm_);
    } else
        std::swap(surface_.height_mm, before_refining);
}

void HeightSearch::carve(const LightVisibility& lights) {
    const SlopeEdges edges = edges_of(surface_, normals(), options_, choice_, result_.plane);
    const double then = misfit();
    Image<float> before = surface_.height_mm;
    choice_.carved = carve_shadows(lights, samples_.lighting, edges, surface_, progress_);
    if (choice_.carved.contradicted == 0) return;
    const Plane plane = best_plane(surface_.height_mm, surface_.confidence);
    subtract(plane, surface_.height_mm);
    choice_.carving_kept = clearly_better(misfit(), then);
    if (!choice_.carving_kept) {
        std::swap(surface_.height_mm, before);
        choice_.carved.left = choice_.carved.contradicted;
        return;
    }
    Plane& all = result_.plane;
    all = {all.a + plane.a, all.b + plane.b, all.c + plane.c};
}

}  // namespace

FinalHeight final_height(Surface& surface, const LitSurvey& samples, const HeightOptions& options,
                         const HeightEvidence& evidence, Image<HalfError>* error_mm,
                         const Progress& progress) {
    Image<float> before;
    if (evidence.refined) before = std::exchange(surface.height_mm, {});
    HeightSearch search(surface, samples, options, error_mm, progress);
    if (evidence.shadows_tell) search.find_variant();
    search.integrate_variant();
    if (!before.empty()) search.compare_with(std::move(before), evidence.shadows_tell);
    if (evidence.lights && !evidence.lights->empty()) search.carve(*evidence.lights);
    return search.found();
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
