#include "fit/fit_painting.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <mutex>

#include "capture/survey.h"
#include "capture/transfer_metadata.h"
#include "fit/lobe_prior.h"
#include "fit/shot_order.h"
#include "fit/slope_edges.h"
#include "fit/slope_prior.h"
#include "surface/error.h"
#include "surface/median.h"
#include "surface/parallel.h"
#include "surface/relight.h"

namespace tangi {

namespace {

// [sigma] Median residual beyond which the model does not explain the pixels, so that its height and errors
// are no ground for a second pass (real/coin: 1.5, which it costs 0.3 dB; icon, with its gold, 1.05; the
// other stacks: 0.56 to 0.76).
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

// What the first pass leaves to the second.
struct FirstPass {
    LobePriors lobes;
    SlopePriors slopes;
    CastShadows shadows;

    FirstPass(const Surface& surface, const Plane& plane, const FitErrors& errors, const WardPrior& general)
        : lobes(surface, errors, general),
          slopes(surface, plane),
          shadows(surface.height_mm, surface.mm_per_pixel, RelightOptions{}.light_radius_deg) {}
};

void store(const WardEstimate& e, int x, int y, FitResult& result) {
    Surface& surface = result.surface;
    surface.normal(x, y) = normal_of({static_cast<float>(e.slope.x), static_cast<float>(e.slope.y)});
    surface.diffuse(x, y) = Rgb(e.diffuse);
    surface.specular(x, y) = static_cast<float>(e.specular);
    surface.roughness(x, y) = static_cast<float>(e.roughness);
    surface.confidence(x, y) = confidence_of(e);
    result.errors.slope(x, y) = static_cast<float>(e.slope_error);
    result.errors.diffuse(x, y) = static_cast<float>(e.diffuse_error);
    result.errors.specular(x, y) = static_cast<float>(e.specular_error);
    result.errors.roughness(x, y) = static_cast<float>(e.roughness_error);
}

// `first`: null in the first pass.
void fit_band(const Stack& stack, const Band& band, const Lighting& lighting, const NoiseModel& noise,
              const FitOptions& options, const FirstPass* first, FitResult& result, Counters& counters,
              const Progress& progress) {
    const Surface& surface = result.surface;
    WardFitOptions ward = options.ward;
    ward.law = surface.law;
    PixelKnowledge known;
    if (first) {
        known.prior = [&](int x, int y) {
            WardPrior prior = first->lobes.at(x, y);
            first->slopes.add_to(x, y, prior);
            return prior;
        };
        known.shadows = &first->shadows;
    }
    oneapi::tbb::enumerable_thread_specific<RowFitter> fitters(
        [&] { return RowFitter(ward, options.solver, lighting, noise, band.channels()); });
    // Enough pixels at once to keep registers full; with Ceres alone a row takes long enough.
    const int rows = options.solver == Solver::batch ? std::max(1, 4096 / band.width()) : 1;
    parallel_for(band.y0(), band.y1(), rows, [&](int begin, int end) {
        long fitted = 0, not_converged = 0;
        fitters.local().fit(
            band, begin, end, stack.mask, surface, known, [&](int x, int y, const WardEstimate& e) {
                ++fitted;
                not_converged += !e.converged;
                store(e, x, y, result);
                const std::size_t index =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(surface.width()) +
                    static_cast<std::size_t>(x);
                if (index % rms_step(surface) == 0)
                    counters.rms_residuals[index / rms_step(surface)] = static_cast<float>(e.rms_residual);
            });
        const std::lock_guard lock(counters.mutex);
        counters.fitted += fitted;
        counters.not_converged += not_converged;
        counters.rows += end - begin;
        report(progress, first ? "refine" : "fit", counters.rows / static_cast<double>(surface.height()));
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
    report.median_confidence = median(std::move(confidences));
}

int rows_of_band(const Stack& stack, const StackReader& reader) {
    const int most = reader.rows_for(kLargestBandBytes);
    const bool resampled = stack.geometry || std::any_of(stack.photos.begin(), stack.photos.end(),
                                                         [](const StackPhoto& p) { return p.homography; });
    if (resampled) return most;
    return std::min(std::max(reader.rows_for(kBandBytes), kRowsAThread * thread_count()), most);
}

// One pass over the photographs; the next band is decoded while this one is fitted.
void fit_bands(const Stack& stack, const Transfer& transfer, const Lighting& lighting,
               const NoiseModel& noise, const FitOptions& options, FirstPass* first, FitResult& result,
               const Progress& progress) {
    Counters counters;
    counters.rms_residuals.assign((result.surface.height_mm.size() - 1) / rms_step(result.surface) + 1, -1);
    StackReader reader(stack);
    const int rows = rows_of_band(stack, reader);
    Band next = reader.read(0, std::min(rows, stack.height()), transfer);
    for (int y0 = 0; y0 < stack.height(); y0 += rows) {
        const Band band = std::move(next);
        const int y1 = std::min(y0 + rows, stack.height()), y2 = std::min(y1 + rows, stack.height());
        auto decoded = std::async(std::launch::async,
                                  [&, y1, y2] { return y1 < y2 ? reader.read(y1, y2, transfer) : Band(); });
        if (first) {
            first->lobes.advance(y0, y1);
            first->slopes.advance(y0, y1);
        }
        fit_band(stack, band, lighting, noise, options, first, result, counters, progress);
        next = decoded.get();
    }
    summarise(result.surface, counters, options.ward.bounds.diffuse_max, result.report);
}

// Files of floats have no full scale: their noise is relative to the white level.
NoiseModel noise_model(const Stack& stack, const Transfer& transfer, const FitOptions& options) {
    if (const Development* d = stack.development.get(); d && d->bits != 32)
        return NoiseModel(d->encoding, options.noise.value_or(d->bits == 8 ? 0.012 : 0.006), true,
                          d->clipped);
    if (stack.bits == 32)
        return NoiseModel(
            transfer, options.noise.value_or(0.006 * std::min(options.white_level.value_or(1), 1.0)), false);
    return NoiseModel(transfer, options.noise.value_or(stack.bits == 8 ? 0.012 : 0.006), true);
}

Rig rig_of(const Stack& stack) {
    Rig rig;
    if (stack.camera_mm) {
        rig.camera_distance_mm = stack.camera_mm->z;
        rig.camera_axis_mm = glm::vec2(*stack.camera_mm);
    }
    return rig;
}

// Held-out photographs get the light that the others make likely.
void describe_lights(const Stack& stack, const LightCalibration& calibration, Photography& photography) {
    photography.rig = calibration.lighting.rig;
    photography.lamps = calibration.lamps;
    const auto add = [&](const Light& light, bool fitted, const StackPhoto& photo) {
        photography.photos.push_back({light, fitted, photo.homography});
        if (light.direction != photo.light.direction)
            photography.photos.back().listed_direction = photo.light.direction;
    };
    for (std::size_t i = 0; i < stack.photos.size(); ++i)
        add(calibration.lighting.lights[i], true, stack.photos[i]);
    const Photography fitted = photography;
    const std::vector<Light>& lights = calibration.lighting.lights;  // in the order of their paths
    const ShotOrder order = photography.lamps ? fit_shot_order(*photography.lamps, lights) : ShotOrder{};
    for (const StackPhoto& photo : stack.held_out) {
        Light light = photo.light;
        light.direction = corrected_direction(calibration, light.direction);
        if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
        Light photographed = as_photographed(light, fitted);
        if (photography.lamps) {
            const auto before = std::count_if(stack.photos.begin(), stack.photos.end(),
                                              [&](const StackPhoto& p) { return p.path < photo.path; });
            photographed.gain = Rgb(static_cast<float>(predicted_gain(
                order, *photography.lamps, lights, light.direction, static_cast<int>(before))));
        }
        add(photographed, false, photo);
    }
}

// Surveys the stack and leaves out black photographs; where asked for, also registers it, and where that
// moved something, surveys it once more as registered.
Survey look_over(Stack& stack, bool register_photos, FitReport& report, const Progress& progress) {
    if (!register_photos) {
        Survey surveyed = survey(stack, {}, progress);
        leave_out_black_photos(stack, surveyed);
        report.transfer = decide_transfer(stack, surveyed);
        return surveyed;
    }
    const std::vector<StackPhoto> all = stack.photos;
    PictureCollector collected(stack);
    Survey surveyed = survey(stack, {}, progress, [&](const Band& band) { collected.add(band); });
    leave_out_black_photos(stack, surveyed);
    std::vector<bool> kept;
    for (const StackPhoto& photo : all)
        kept.push_back(std::any_of(stack.photos.begin(), stack.photos.end(),
                                   [&](const StackPhoto& k) { return k.path == photo.path; }));
    collected.keep(kept);
    report.transfer = decide_transfer(stack, surveyed);
    const std::size_t before = stack.photos.size();
    report.registration = register_stack(stack, collected, report.transfer.transfer, progress);
    if (!report.registration.moved && stack.photos.size() == before) return surveyed;
    require_enough_lights(stack.lights(), stack.folder.string());
    surveyed = survey(stack, {}, Progress([&](std::string_view, double done) {
                          return !progress || progress("survey as registered", done);
                      }));
    report.transfer = decide_transfer(stack, surveyed);
    return surveyed;
}

}  // namespace

FitResult fit_painting(Stack stack, const FitOptions& options, const Progress& progress) {
    validate(options);
    require_enough_lights(stack.lights(), stack.folder.string());
    // Sums are taken in this order, so the order of the lines in a lights file changes no bit of the result.
    std::sort(stack.photos.begin(), stack.photos.end(),
              [](const StackPhoto& a, const StackPhoto& b) { return a.path < b.path; });
    FitResult result;
    FitReport& report_ = result.report;
    const Survey surveyed = look_over(stack, options.register_photos, report_, progress);
    if (stack.transfer_of_chart && report_.transfer.source == "given")
        report_.transfer.source = "colour chart";
    if (!report_.transfer.warning.empty()) stack.warnings.push_back(report_.transfer.warning);
    const Transfer transfer = report_.transfer.transfer;

    result.surface = Surface(stack.width(), stack.height());
    Surface& surface = result.surface;
    const std::optional<double> mm_per_pixel =
        options.mm_per_pixel ? options.mm_per_pixel : stack.mm_per_pixel;
    surface.mm_per_pixel = mm_per_pixel.value_or(1.0);
    surface.scale_known = mm_per_pixel.has_value();
    surface.photography = {.transfer = transfer,
                           .white_level = options.white_level.value_or(1),
                           .photos = {},
                           .rig = {},
                           .lamps = {},
                           .to_camera = {}};
    const NoiseModel noise = noise_model(stack, transfer, options);
    const Lighting given{stack.lights(), rig_of(stack), surface.photography.white_level};
    report_.lights = options.lights_as_given
                         ? LightCalibration{.lighting = given}
                         : calibrate_lights(stack, surveyed, transfer, noise, given, surface.mm_per_pixel,
                                            options.ward, options.calibration, progress);
    std::optional<double> white;
    if (!options.white_level)
        white = white_level_by_chart(stack, transfer, report_.lights.lighting, surface.mm_per_pixel);
    if (white) surface.photography.white_level = report_.lights.lighting.white_level = *white;
    const Lighting lighting = as_camera_sees(report_.lights.lighting, stack);
    if (std::string warning = warning_of(report_.lights, stack.folder.string()); !warning.empty())
        stack.warnings.push_back(std::move(warning));
    describe_lights(stack, report_.lights, surface.photography);
    const bool law_is_open = !options.diffuse_roughness || !options.haze;
    if (law_is_open && !options.lights_as_given)
        report_.law = choose_law(LightSample(stack, surveyed, transfer, noise, surface.mm_per_pixel,
                                             options.ward, options.calibration.samples),
                                 lighting, progress);
    surface.law = report_.law.law = {
        .diffuse_roughness = options.diffuse_roughness.value_or(report_.law.law.diffuse_roughness),
        .haze = options.haze.value_or(report_.law.law.haze)};
    report_.misfit = light_misfit(stack, surveyed, transfer, noise, lighting, surface.mm_per_pixel,
                                  options.ward, surface.law);
    result.errors = FitErrors(stack.width(), stack.height());
    fit_bands(stack, transfer, lighting, noise, options, nullptr, result, progress);
    const bool trusted = report_.median_rms_residual <= kTrusted;
    if (options.refine && !trusted)
        stack.warnings.push_back(fmt::format(
            "{}: photographs differ from the model by {:.1f} times what is expected (in the median): "
            "shadows and neighbours' lobes are not believed, so the fit is not refined; metal and "
            "glass look like that, and wrong light directions",
            stack.folder.string(), report_.median_rms_residual));
    if (options.refine && trusted) {
        HeightOptions rough = options.height;
        rough.tolerance = std::max(rough.tolerance, kShadowTolerance);
        integrate_normals(surface.normal, surface.confidence, surface.mm_per_pixel, surface.height_mm, rough,
                          Progress([&](std::string_view, double done) {
                              return !progress || progress("first height", done);
                          }));
        const Plane plane = best_plane(surface.height_mm, surface.confidence);
        subtract(plane, surface.height_mm);
        FirstPass first(surface, plane, result.errors, options.ward.prior);
        FitOptions second = options;
        second.ward.robust_scale = robust_scale_after(report_.median_rms_residual, options.ward.robust_scale);
        fit_bands(stack, transfer, lighting, noise, second, &first, result, progress);
    }
    report_.colour = correct_colours(stack, surface);
    report_.colour.white_by_chart = white.has_value();
    report_.height = integrate_normals(surface.normal, surface.confidence, surface.mm_per_pixel,
                                       surface.height_mm, options.height, progress, &result.errors.height);
    const Plane plane = best_plane(surface.height_mm, surface.confidence);
    subtract(plane, surface.height_mm);
    report_.support_tilt_deg = std::atan(std::hypot(plane.a, plane.b) / surface.mm_per_pixel) * 180 / M_PI;
    if (report_.too_bright > report_.fitted / 20)
        stack.warnings.push_back(
            fmt::format("{}: {:.0f} % of the pixels would reflect more than {} times the light that falls on "
                        "them: the white "
                        "level {} is too low; give the linear value of a matt white as --white-level",
                        stack.folder.string(),
                        100.0 * static_cast<double>(report_.too_bright) / static_cast<double>(report_.fitted),
                        options.ward.bounds.diffuse_max, lighting.white_level));
    report_.warnings = stack.warnings;
    return result;
}

}  // namespace tangi
