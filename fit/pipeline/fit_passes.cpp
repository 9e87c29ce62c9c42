#include "fit/pipeline/fit_passes.h"

#include <algorithm>
#include <cmath>

#include "fit/height/slope_edges.h"
#include "fit/material/occluded_pixels.h"
#include "fit/pipeline/fit_pass.h"
#include "fit/pipeline/reduced_result.h"
#include "fit/pipeline/refinement.h"

namespace tangi {

namespace {

// [sigma] Median residual beyond which the model does not explain the photographs (real/coin: 1.5; icon, with
// its gold, 1.05; the other stacks: 0.56 to 0.76).
constexpr double kTrusted = 1;
// [1] Part of all pixels' lights that relief may hide for reduced photographs to tell what a first pass tells
// (docs/validation/benchmarks.md, "A whole fit").
constexpr double kFewHidden = 1e-3;
// [1] HeightOptions::tolerance of the height that casts shadows: what is left are long waves.
constexpr double kShadowTolerance = 1e-3;

// Of those that are fitted, the ones that say how pixels look.
Image<unsigned char> mask_of_looks(const SampledPixels& asked, const Surface& surface,
                                   const Image<unsigned char>& mask) {
    Image<unsigned char> looks(surface.width(), surface.height(), 0);
    for (int j = 0; j < asked.look_y.count; ++j)
        for (int i = 0; i < asked.look_x.count; ++i) {
            const int x = asked.look_x.at(i), y = asked.look_y.at(j);
            looks(x, y) = mask.empty() || mask(x, y);
        }
    return looks;
}

// Whether hills and valleys are what they are, as far as the photographs tell: else the height casts shadows
// where there are none. How well the model explains them matters little: that the first pass knows neither
// shadows nor neighbours is most of what it lacks, on metal, too, and under lights that are somewhere else.
bool believes_height(const FitReport& report) {
    const ShadowCheck& shadows = report.shadow_signs;
    return explains_photographs(report) ||
           (!report.signs.wrong() && (!shadows.certain() || shadows.best == LightTurn{}));
}

// The passes over one stack, each with what those before it found.
class Passes {
public:
    // `mask` is of the size of the input's photographs, or of the reduced ones; empty: all pixels are fitted.
    Passes(const CalibratedStack& input, const Image<unsigned char>& mask, const FitOptions& options,
           FitResult& result, const Progress& progress)
        : input_(input),
          mask_(mask),
          options_(options_of_first(result.report, options)),
          result_(result),
          surface_(result.surface),
          report_(result.report),
          progress_(progress) {}

    // How lobes are anisotropic, by what some pixels with white and isotropic lobes show.
    void find_anisotropy();
    // All pixels; `coloured`: keeps what they show of the lobes' colours.
    void fit_all(bool coloured);
    // The colours of lobes, by what all pixels have shown.
    void find_colours();
    // Occluded pixels are no ground for a height.
    void distrust_occluded();
    // The height as the first pass left it, but for its cliffs.
    void find_first_height();
    // The first pass, up to its height; `look`: FirstLook of its result.
    void run_first(const LobeFreedom& lobes, const std::function<void(bool height_known)>& look);
    // All pixels once more, with the shadows of the first height and what neighbours say of lobes, and of
    // occluded pixels as a whole. Returns which lights were seen where.
    LightVisibility refine();
    // What is left to the pixels of pictures that are `reduction` times larger.
    FirstFit first_fit(int reduction);
    // Instead of it, where the height is not believed.
    void trust_first();

private:
    void fit(const FitPass& pass) { fit(pass, options_); }
    void fit(const FitPass& pass, const FitOptions& options) {
        judged_ = pass.judged;
        fit_pass(input_, options, pass, result_, progress_);
    }
    void take_stretches(const Image<StretchEvidence>& evidence);

    const CalibratedStack& input_;
    const Image<unsigned char>& mask_;
    const FitOptions options_;
    FitResult& result_;
    Surface& surface_;
    FitReport& report_;
    const Progress& progress_;
    bool judged_ = false;          // FitPass::judged of the last pass
    Image<LobeEvidence> colours_;  // empty where nobody asks
    Image<unsigned char> occluded_;
    std::vector<float> confidences_;  // of occluded pixels, as fitted
    Plane plane_{};                   // that was taken off the first height
};

void Passes::find_anisotropy() {
    const SampledPixels asked = sampled_pixels(surface_.width(), surface_.height());
    Image<StretchEvidence> stretches(asked.x.count, asked.y.count);
    fit({.name = "directions of lobes",
         .mask = mask_of_looks(asked, surface_, mask_),
         .judged = false,
         .stretches = &stretches});
    take_stretches(stretches);
}

// Leaves the surface without axes where no lobe is anisotropic.
void Passes::take_stretches(const Image<StretchEvidence>& evidence) {
    Image<Stretch> stretches = lobe_stretches(surface_, evidence);
    long all = 0, shown = 0;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const bool fitted = mask_.empty() || mask_.pixels()[i];
        if (!fitted) stretches.pixels()[i] = Stretch(0);
        all += fitted;
        shown += stretches.pixels()[i] != Stretch(0);
    }
    report(progress_, "directions of lobes", 1);
    report_.anisotropic = static_cast<double>(shown) / static_cast<double>(std::max(all, 1L));
    if (shown == 0) return;
    surface_.lobe_axes = Image<LobeAxes>(surface_.width(), surface_.height());
    for (std::size_t i = 0; i < stretches.size(); ++i)
        surface_.lobe_axes.pixels()[i] = axes_of(stretches.pixels()[i], surface_.roughness.pixels()[i]);
}

void Passes::fit_all(bool coloured) {
    if (coloured) colours_ = Image<LobeEvidence>(surface_.width(), surface_.height());
    fit({.name = "fit",
         .mask = mask_,
         .judged = !options_.refine || options_.solver == Solver::ceres,
         .colours = coloured ? &colours_ : nullptr});
}

void Passes::find_colours() {
    surface_.specular_colour = specular_colours(surface_, colours_);
    colours_ = {};
    const auto shown =
        std::count_if(surface_.specular_colour.pixels().begin(), surface_.specular_colour.pixels().end(),
                      [](const Rgb& colour) { return colour != Rgb(1); });
    report_.coloured = static_cast<double>(shown) / static_cast<double>(std::max(report_.fitted, 1L));
    if (shown == 0) surface_.specular_colour = {};
    if (shown > 0 && !options_.refine) fit({.name = "coloured lobes", .mask = mask_});
}

void Passes::distrust_occluded() {
    occluded_ = options_.refine ? find_occluded_pixels(surface_)
                                : Image<unsigned char>(surface_.width(), surface_.height());
    confidences_ = distrust(occluded_, surface_);
}

void Passes::find_first_height() {
    HeightOptions rough = options_.height;
    rough.robust_sweeps = 0;  // it is not known yet where there are cliffs
    rough.tolerance = std::max(rough.tolerance, kShadowTolerance);
    const Progress shown(
        [&](std::string_view, double done) { return !progress_ || progress_("first height", done); });
    integrate_normals({surface_.normal, surface_.confidence, surface_.mm_per_pixel}, surface_.height_mm,
                      rough, shown);
    plane_ = best_plane(surface_.height_mm, surface_.confidence);
    subtract(plane_, surface_.height_mm);
}

LightVisibility Passes::refine() {
    fill_from_neighbours(occluded_, surface_, result_.errors);
    FirstPass first(surface_, plane_, result_.errors, options_.ward.prior, occluded_, surface_.height_mm, 1,
                    static_cast<int>(input_.stack.photos.size()));
    const FitOptions second = options_after(report_, options_);
    fit_pass(input_, second, {.name = "refine", .mask = mask_, .first = &first}, result_, progress_);
    settle_refined(false, input_.lighting, first.lights, surface_);
    return std::move(first.lights);
}

FirstFit Passes::first_fit(int reduction) {
    fill_from_neighbours(occluded_, surface_, result_.errors);
    return {std::move(result_), std::move(occluded_), plane_, reduction};
}

void Passes::trust_first() {
    trust_again(occluded_, confidences_, surface_);
    if (!judged_ || !surface_.specular_colour.empty()) fit({.name = "fit, once more", .mask = mask_});
}

// Where lobes may be anisotropic, some pixels come first: from lobes that are not anisotropic though they
// should be, slopes and neighbours' lobes are no ground for anything. Then all pixels; where lobes may have
// colours, what that shows of them.
void Passes::run_first(const LobeFreedom& lobes, const std::function<void(bool height_known)>& look) {
    if (lobes.anisotropic) find_anisotropy();
    fit_all(lobes.coloured);
    look(false);
    if (lobes.coloured) find_colours();
    distrust_occluded();
    // Where it is not refined, too: the lights may be what is wrong.
    find_first_height();
    look(true);
}

}  // namespace

std::string beyond_expected(double median_sigma) {
    if (median_sigma < 1.95)
        return fmt::format("{:.0f} % more than is expected (in the median)",
                           std::max(100 * (median_sigma - 1), 1.0));
    return fmt::format("{:.1f} times what is expected (in the median)", median_sigma);
}

bool explains_photographs(const FitReport& report) { return report.median_rms_residual <= kTrusted; }

namespace {

// Refines all pixels by one pass over the photographs, for which reduced ones have told what a first pass
// tells.
LightVisibility refine_by(const FirstFit& first, const CalibratedStack& whole, const FitOptions& options,
                          FitResult& result, const Progress& progress) {
    Surface& surface = result.surface;
    surface.height_mm = enlarged_height(first, surface.width(), surface.height());
    LightVisibility lights(0, 0, 0);
    Refinement refinement(first, surface.height_mm, options);
    summarise(refinement.fit(whole, whole.stack.mask, 0, result, lights, progress).front(), options, result);
    settle_refined(true, whole.lighting, lights, surface);
    return lights;
}

// Two passes over the photographs, or over the reduced ones where `input` has them.
LightVisibility fit_twice(const CalibratedStack& input, const FitOptions& options, const LobeFreedom& lobes,
                          const FirstLook& look, FitResult& result, const Progress& progress) {
    const Image<unsigned char> reduced =
        input.reduced ? reduced_mask(input.stack.mask, input.reduced->reduction()) : Image<unsigned char>();
    Passes passes(input, input.reduced ? reduced : input.stack.mask, options, result, progress);
    passes.run_first(lobes, [&](bool height_known) { look(result, 1, height_known); });
    result.report.refined = options.refine && believes_height(result.report);
    if (result.report.refined) return passes.refine();
    if (options.refine) passes.trust_first();
    return {result.surface.width(), result.surface.height(), static_cast<int>(input.stack.photos.size())};
}

}  // namespace

ReducedLook look_at_reduced(const CalibratedStack& whole, const ReducedPhotos& reduced,
                            const FitOptions& options, const LobeFreedom& lobes, const FirstLook& look,
                            const FitResult& described, const Progress& progress) {
    const int reduction = reduced.reduction();
    const Image<unsigned char> mask = reduced_mask(whole.stack.mask, reduction);
    const Progress shown([&](std::string_view stage, double done) {
        return !progress || progress(fmt::format("reduced photographs: {}", stage), done);
    });
    CalibratedStack input = whole;
    input.reduced = &reduced;
    FitResult first = reduced_result(described, reduced);
    Passes passes(input, mask, options, first, shown);
    passes.run_first(lobes, [&](bool height_known) { look(first, reduction, height_known); });
    ReducedLook seen;
    seen.believed = believes_height(first.report);
    seen.hidden = passes.refine().hidden_part();
    passes.distrust_occluded();
    passes.find_first_height();
    seen.first = passes.first_fit(reduction);
    seen.first.result.report.refined = true;
    return seen;
}

bool ReducedLook::suffices() const { return believed && hidden <= kFewHidden; }

LightVisibility fit_passes(const CalibratedStack& input, ReducedPhotos reduced, const FitOptions& options,
                           const LobeFreedom& lobes, const FirstLook& look, FitResult& result,
                           const Progress& progress) {
    if (options.preview && !reduced.empty()) {
        CalibratedStack small = input;
        small.reduced = &reduced;
        return fit_twice(small, options, lobes, look, result, progress);
    }
    if (!reduced.empty() && options.refine) {
        const ReducedLook seen = look_at_reduced(input, reduced, options, lobes, look, result, progress);
        reduced = {};
        if (seen.suffices()) {
            result.report = seen.first.result.report;
            return refine_by(seen.first, input, options, result, progress);
        }
    }
    return fit_twice(input, options, lobes, look, result, progress);
}

}  // namespace tangi
