#include "fit/pipeline/fit_passes.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <mutex>

#include "fit/height/slope_edges.h"
#include "fit/material/anisotropy_estimate.h"
#include "fit/material/integrability_prior.h"
#include "fit/material/lobe_neighbour_prior.h"
#include "fit/material/low_confidence_fill.h"
#include "fit/material/occluded_pixels.h"
#include "fit/material/specular_colour.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

// [sigma] Median residual beyond which the model does not explain the photographs (real/coin: 1.5; icon, with
// its gold, 1.05; the other stacks: 0.56 to 0.76).
constexpr double kTrusted = 1;
// One band; two are in memory at a time. Small ones stay in the processor's caches, and their memory is used
// again instead of given back; but photographs that are resampled share rows between bands, and each thread
// needs rows of its own.
constexpr std::size_t kBandBytes = 24u << 20, kLargestBandBytes = 96u << 20;
constexpr int kRowsAThread = 4;

// [1] HeightOptions::tolerance of the height that casts shadows: what is left are long waves.
constexpr double kShadowTolerance = 1e-3;

// Confidence of a pixel: 1 where the slope is certain, 1/2 where its standard error is 0.1 (about 6 degrees).
float confidence_of(const WardEstimate& e) {
    const double t = e.slope_error / kHalfConfidence;
    return static_cast<float>(1 / (1 + t * t));
}

struct Counters {
    long fitted = 0, not_converged = 0;
    int rows = 0;
    std::vector<float> rms_residuals;  // [sigma] of every so many-th pixel; < 0 where it was not fitted
    SolverAgreement solvers;
    std::mutex mutex;
};

constexpr std::size_t kRmsResiduals = 1000000;
std::size_t rms_step(const Surface& s) {
    return std::max<std::size_t>(1, s.height_mm.size() / kRmsResiduals);
}

// [sigma] of the second pass. Cauchy's loss has 95 % of the efficiency of least squares where its scale is
// 2.385 times that of the residuals (Holland & Welsch 1977, "Robust regression using iteratively reweighted
// least-squares"), which the first pass shows; a wider one lets light from other relief and mixed pixels tilt
// normals. At least 2: with 1, impasto's normals gain another 0.03 degrees, but lobes that are a little off
// count as outliers, too, and held-out photographs of canvas are predicted 0.1 dB worse.
double robust_scale_after(double rms_residual, double first) {
    return std::min(std::max(2.385 * rms_residual, 2.0), first);
}

// What the first pass leaves to the second, where it is trusted.
struct FirstPass {
    LobePriors lobes;
    IntegrabilityPriors slopes;
    CastShadows shadows;
    const Image<unsigned char>& occluded;
    LightVisibility lights;

    FirstPass(const Surface& surface, const Plane& plane, const FitErrors& errors, const WardPrior& general,
              const Image<unsigned char>& few_lights, int photos)
        : lobes(surface, errors, general),
          slopes(surface, plane),
          shadows(surface.height_mm, surface.mm_per_pixel, light_radius_deg(surface, {})),
          occluded(few_lights),
          lights(surface.width(), surface.height(), photos) {}
};

void store(const WardEstimate& e, int x, int y, FitResult& result) {
    Surface& surface = result.surface;
    surface.normal(x, y) = normal_of({static_cast<float>(e.slope.x), static_cast<float>(e.slope.y)});
    surface.diffuse(x, y) = Rgb(e.diffuse);
    surface.specular(x, y) = static_cast<float>(e.specular);
    if (!surface.lobe_axes.empty())
        surface.lobe_axes(x, y).roughness_v *= static_cast<float>(e.roughness) / surface.roughness(x, y);
    surface.roughness(x, y) = static_cast<float>(e.roughness);
    surface.confidence(x, y) = confidence_of(e);
    result.errors.slope(x, y) = static_cast<float>(e.slope_error);
    result.errors.diffuse(x, y) = static_cast<float>(e.diffuse_error);
    result.errors.specular(x, y) = static_cast<float>(e.specular_error);
    result.errors.roughness(x, y) = static_cast<float>(e.roughness_error);
}

// What a pass is given of those before, and leaves to those after it.
struct Pass {
    std::string name;
    const Image<unsigned char>& mask;             // pixels that are fitted; empty: all
    bool judged = true;                           // RowFitter::fit(): if another pass follows, that one is
    FirstPass* first = nullptr;                   // of a second pass
    Image<LobeEvidence>* colours = nullptr;       // to be filled in
    Image<StretchEvidence>* stretches = nullptr;  // likewise, of those that are asked
};

// What is known of pixels beside their photographs. Lobes have the colours that the surface says.
PixelKnowledge knowledge_of(const Pass& pass, const Surface& surface, const WardPrior& general) {
    PixelKnowledge known;
    const bool coloured = !surface.specular_colour.empty();
    if (coloured) known.specular_colour = [&](int x, int y) { return surface.specular_colour(x, y); };
    const bool anisotropic = !surface.lobe_axes.empty();
    const auto stretched = [&surface, anisotropic](int x, int y, WardPrior prior) {
        if (anisotropic)
            prior.stretch = glm::dvec2(stretch_of(surface.lobe_axes(x, y), surface.roughness(x, y)));
        return prior;
    };
    if (!pass.first) {
        if (anisotropic)
            known.prior = [stretched, general](int x, int y) { return stretched(x, y, general); };
        return known;
    }
    known.prior = [&surface, coloured, stretched, first = pass.first](int x, int y) {
        WardPrior prior = stretched(x, y, first->lobes.at(x, y));
        first->slopes.add_to(x, y, prior);
        if (!coloured) return prior;
        // rho_s of a white lobe is that of the mean channel, of a coloured one that of the largest.
        const Rgb& colour = surface.specular_colour(x, y);
        const double scale = 3 / static_cast<double>(colour.r + colour.g + colour.b);
        prior.specular *= scale;
        prior.specular_sigma *= scale;
        return prior;
    };
    known.shadows = &pass.first->shadows;
    known.occluded = &pass.first->occluded;
    known.lights = &pass.first->lights;
    return known;
}

void fit_band(const Band& band, const Lighting& lighting, const NoiseModel& noise, const FitOptions& options,
              const Pass& pass, FitResult& result, Counters& counters, const Progress& progress) {
    const Surface& surface = result.surface;
    WardFitOptions ward = options.ward;
    ward.reflectance_model = surface.reflectance_model;
    const PixelKnowledge known = knowledge_of(pass, surface, ward.prior);
    oneapi::tbb::enumerable_thread_specific<RowFitter> fitters(
        [&] { return RowFitter(ward, options.solver, lighting, noise, band.channels()); });
    // Enough pixels at once to keep registers full; with Ceres alone a row takes long enough.
    const int rows = options.solver == Solver::batch ? std::max(1, 4096 / band.width()) : 1;
    const SampledPixels asked = sampled_pixels(surface.width(), surface.height());
    parallel_for(band.y0(), band.y1(), rows, [&](int begin, int end) {
        long fitted = 0, not_converged = 0;
        const auto done = [&](int x, int y, const WardEstimate& e) {
            ++fitted;
            not_converged += !e.converged;
            store(e, x, y, result);
            const auto samples = [&]() -> const PixelSamples& {
                return fitters.local().samples_at(band, x, y, surface, {});
            };
            if (pass.colours) (*pass.colours)(x, y) = lobe_evidence(samples(), e, ward);
            if (pass.stretches && asked.x.has(x) && asked.y.has(y))
                (*pass.stretches)(asked.x.nearest(x), asked.y.nearest(y)) =
                    stretch_evidence(samples(), e, ward);
            const std::size_t index =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(surface.width()) +
                static_cast<std::size_t>(x);
            if (index % rms_step(surface) == 0)
                counters.rms_residuals[index / rms_step(surface)] = static_cast<float>(e.rms_residual);
        };
        fitters.local().fit(band, begin, end, pass.mask, surface, known, pass.judged, done);
        const std::lock_guard lock(counters.mutex);
        counters.fitted += fitted;
        counters.not_converged += not_converged;
        counters.rows += end - begin;
        report(progress, pass.name, counters.rows / static_cast<double>(surface.height()));
    });
    for (const RowFitter& fitter : fitters) counters.solvers += fitter.agreement();
}

void summarise(const Surface& surface, Counters& counters, double diffuse_max, FitReport& report) {
    report.pixels = static_cast<long>(surface.height_mm.size());
    report.fitted = counters.fitted;
    report.not_converged = counters.not_converged;
    report.solvers = counters.solvers;
    report.too_bright = 0;
    for (const Rgb& diffuse : surface.diffuse.pixels())
        report.too_bright += std::max({diffuse.r, diffuse.g, diffuse.b}) > 0.99 * diffuse_max;
    std::erase_if(counters.rms_residuals, [](float rms) { return rms < 0; });
    std::vector<float> confidences;
    for (std::size_t i = 0; i < surface.height_mm.size(); i += rms_step(surface))
        if (surface.confidence.pixels()[i] > 0) confidences.push_back(surface.confidence.pixels()[i]);
    report.median_rms_residual = median(std::move(counters.rms_residuals));
    const auto unsure =
        std::count_if(confidences.begin(), confidences.end(), [](float c) { return c < 0.5f; });
    report.unsure =
        static_cast<double>(unsure) / static_cast<double>(std::max<std::size_t>(confidences.size(), 1));
    report.median_confidence = median(std::move(confidences));
}

int rows_of_band(const Stack& stack, const StackReader& reader) {
    const int most = reader.rows_for(kLargestBandBytes);
    const bool resampled = stack.geometry || std::any_of(stack.photos.begin(), stack.photos.end(),
                                                         [](const StackPhoto& p) { return p.homography; });
    if (resampled) return most;
    return std::min(std::max(reader.rows_for(kBandBytes), kRowsAThread * thread_count()), most);
}

// One pass over the photographs; the next band is decoded while something is done with this one.
template <class Do>
void each_band(const Stack& stack, const Transfer& transfer, const Do& act) {
    StackReader reader(stack);
    const int rows = rows_of_band(stack, reader);
    Band next = reader.read(0, std::min(rows, stack.height()), transfer);
    for (int y0 = 0; y0 < stack.height(); y0 += rows) {
        const Band band = std::move(next);
        const int y1 = std::min(y0 + rows, stack.height()), y2 = std::min(y1 + rows, stack.height());
        auto decoded = std::async(std::launch::async,
                                  [&, y1, y2] { return y1 < y2 ? reader.read(y1, y2, transfer) : Band(); });
        act(band);
        next = decoded.get();
    }
}

void fit_bands(const Stack& stack, const Transfer& transfer, const Lighting& lighting,
               const NoiseModel& noise, const FitOptions& options, const Pass& pass, FitResult& result,
               const Progress& progress) {
    Counters counters;
    counters.rms_residuals.assign((result.surface.height_mm.size() - 1) / rms_step(result.surface) + 1, -1);
    each_band(stack, transfer, [&](const Band& band) {
        if (pass.first) {
            pass.first->lobes.advance(band.y0(), band.y1());
            pass.first->slopes.advance(band.y0(), band.y1());
        }
        fit_band(band, lighting, noise, options, pass, result, counters, progress);
    });
    summarise(result.surface, counters, options.ward.bounds.diffuse_max, result.report);
}

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

// How lobes are anisotropic, by what some pixels have shown; leaves the surface without axes where none is.
void find_stretches(const Image<StretchEvidence>& evidence, const Image<unsigned char>& mask,
                    FitResult& result, const Progress& progress) {
    Surface& surface = result.surface;
    Image<Stretch> stretches = lobe_stretches(surface, evidence);
    long all = 0, shown = 0;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const bool fitted = mask.empty() || mask.pixels()[i];
        if (!fitted) stretches.pixels()[i] = Stretch(0);
        all += fitted;
        shown += stretches.pixels()[i] != Stretch(0);
    }
    report(progress, "directions of lobes", 1);
    result.report.anisotropic = static_cast<double>(shown) / static_cast<double>(std::max(all, 1L));
    if (shown == 0) return;
    surface.lobe_axes = Image<LobeAxes>(surface.width(), surface.height());
    for (std::size_t i = 0; i < stretches.size(); ++i)
        surface.lobe_axes.pixels()[i] = axes_of(stretches.pixels()[i], surface.roughness.pixels()[i]);
}

// The height as the first pass left it, but for its cliffs. Returns the plane that was taken off it.
Plane first_height(const FitOptions& options, Surface& surface, const Progress& progress) {
    HeightOptions rough = options.height;
    rough.robust_sweeps = 0;  // it is not known yet where there are cliffs
    rough.tolerance = std::max(rough.tolerance, kShadowTolerance);
    integrate_normals(
        surface.normal, surface.confidence, surface.mm_per_pixel, surface.height_mm, rough,
        Progress([&](std::string_view, double done) { return !progress || progress("first height", done); }));
    const Plane plane = best_plane(surface.height_mm, surface.confidence);
    subtract(plane, surface.height_mm);
    return plane;
}

// All pixels once more, with the shadows of the first height and what neighbours say of lobes, and of
// occluded pixels as a whole.
LightVisibility refine(const Stack& stack, const Transfer& transfer, const Lighting& lighting,
                       const NoiseModel& noise, const FitOptions& options, const Plane& plane,
                       const Image<unsigned char>& occluded, FitResult& result, const Progress& progress) {
    fill_from_neighbours(occluded, result.surface, result.errors);
    FirstPass first(result.surface, plane, result.errors, options.ward.prior, occluded,
                    static_cast<int>(stack.photos.size()));
    FitOptions second = options;
    second.ward.robust_scale =
        robust_scale_after(result.report.median_rms_residual, options.ward.robust_scale);
    fit_bands(stack, transfer, lighting, noise, second,
              {.name = "refine", .mask = stack.mask, .first = &first}, result, progress);
    first.lights.find_runs(result.surface, lighting);
    fill_low_confidence(result.surface);
    return std::move(first.lights);
}

}  // namespace

std::string beyond_expected(double median_sigma) {
    if (median_sigma < 1.95)
        return fmt::format("{:.0f} % more than is expected (in the median)",
                           std::max(100 * (median_sigma - 1), 1.0));
    return fmt::format("{:.1f} times what is expected (in the median)", median_sigma);
}

bool explains_photographs(const FitReport& report) { return report.median_rms_residual <= kTrusted; }

// Whether hills and valleys are what they are, as far as the photographs tell: else the height casts shadows
// where there are none. How well the model explains them matters little: that the first pass knows neither
// shadows nor neighbours is most of what it lacks, on metal, too, and under lights that are somewhere else.
static bool believes_height(const FitReport& report) {
    const ShadowCheck& shadows = report.shadow_signs;
    return explains_photographs(report) ||
           (!report.signs.wrong() && (!shadows.certain() || shadows.best == LightTurn{}));
}

// Where lobes may be anisotropic, some pixels with white and isotropic lobes, and what these show of that:
// from lobes that are not anisotropic though they should be, slopes and neighbours' lobes are no ground for
// anything. Then all pixels; where lobes may have colours, what that shows of them; then the second pass.
LightVisibility fit_passes(const Stack& stack, const Transfer& transfer, const Lighting& lighting,
                           const NoiseModel& noise, const FitOptions& options, const LobeFreedom& lobes,
                           const FirstLook& look, FitResult& result, const Progress& progress) {
    Surface& surface = result.surface;
    FitReport& report_ = result.report;
    Image<LobeEvidence> colours;
    if (lobes.coloured) colours = Image<LobeEvidence>(surface.width(), surface.height());
    Image<LobeEvidence>* const shown_colours = lobes.coloured ? &colours : nullptr;
    bool judged = false;
    const auto fit = [&](const Pass& pass) {
        judged = pass.judged;
        fit_bands(stack, transfer, lighting, noise, options, pass, result, progress);
    };
    if (lobes.anisotropic) {
        const SampledPixels asked = sampled_pixels(surface.width(), surface.height());
        Image<StretchEvidence> stretches(asked.x.count, asked.y.count);
        fit({.name = "directions of lobes",
             .mask = mask_of_looks(asked, surface, stack.mask),
             .judged = false,
             .stretches = &stretches});
        find_stretches(stretches, stack.mask, result, progress);
    }
    fit({.name = "fit",
         .mask = stack.mask,
         .judged = !options.refine || options.solver == Solver::ceres,
         .colours = shown_colours});
    look(false);
    if (lobes.coloured) {
        surface.specular_colour = specular_colours(surface, colours);
        colours = {};
        const auto shown =
            std::count_if(surface.specular_colour.pixels().begin(), surface.specular_colour.pixels().end(),
                          [](const Rgb& colour) { return colour != Rgb(1); });
        report_.coloured = static_cast<double>(shown) / static_cast<double>(std::max(report_.fitted, 1L));
        if (shown == 0) surface.specular_colour = {};
        if (shown > 0 && !options.refine) fit({.name = "coloured lobes", .mask = stack.mask});
    }
    const Image<unsigned char> occluded = options.refine
                                              ? find_occluded_pixels(surface)
                                              : Image<unsigned char>(surface.width(), surface.height());
    const std::vector<float> confidences = distrust(occluded, surface);
    // Where it is not refined, too: the lights may be what is wrong.
    const Plane plane = first_height(options, surface, progress);
    look(true);
    LightVisibility seen(surface.width(), surface.height(), static_cast<int>(stack.photos.size()));
    if (!options.refine) return seen;
    if (believes_height(report_)) {
        seen = refine(stack, transfer, lighting, noise, options, plane, occluded, result, progress);
        report_.refined = true;
    } else {
        trust_again(occluded, confidences, surface);
        if (!judged || !surface.specular_colour.empty()) fit({.name = "fit, once more", .mask = stack.mask});
    }
    return seen;
}

}  // namespace tangi
