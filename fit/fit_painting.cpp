#include "fit/fit_painting.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <limits>
#include <mutex>

#include "capture/survey.h"
#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr std::size_t kBandBytes = 96u << 20;  // one band; two are in memory at a time

// Standard deviation to expect of a linear value: that of a stored value, carried through the transfer curve.
class NoiseModel {
public:
    // Files of floats do not clip: light beyond 1 is light like any other.
    NoiseModel(const Transfer& transfer, double noise, bool clips) {
        for (int i = 0; i < kEntries; ++i) {
            const double v = i / double(kEntries - 1);
            const float encoded = transfer.encode(static_cast<float>(v));
            const float step = static_cast<float>(noise);
            const double read =
                (transfer.decode(encoded + step) - transfer.decode(std::max(encoded - step, 0.0f))) / 2;
            sigma_[static_cast<std::size_t>(i)] = static_cast<float>(read);
        }
        if (clips) clipped_ = transfer.decode(kClipped);
    }

    // 0 where the sample is clipped: it only says "at least this".
    double sigma(float v) const {
        if (v >= clipped_) return 0;
        const float position = std::clamp(v, 0.0f, 1.0f) * (kEntries - 1);
        const auto i = static_cast<std::size_t>(position);
        const float t = position - static_cast<float>(i);
        return sigma_[i] + t * (sigma_[std::min<std::size_t>(i + 1, kEntries - 1)] - sigma_[i]);
    }

private:
    static constexpr int kEntries = 4096;
    std::array<float, kEntries> sigma_{};
    float clipped_ = std::numeric_limits<float>::infinity();
};

struct Lighting {
    std::vector<Light> lights;
    double white_level;
};

void gather(const Band& band, int x, int y, const Vec3& point_mm, const Lighting& lighting,
            const NoiseModel& noise, PixelSamples& s) {
    s.resize(band.photos(), band.channels());
    std::size_t at = 0;
    for (int i = 0; i < band.photos(); ++i) {
        const Incidence in = incidence(lighting.lights[static_cast<std::size_t>(i)], point_mm);
        s.light[static_cast<std::size_t>(i)] = in.direction;
        for (int c = 0; c < band.channels(); ++c, ++at) {
            const float value = band.row(i, c, y)[x];
            s.value[at] = value;
            s.irradiance[at] = lighting.white_level * in.irradiance[c];
            s.sigma[at] = noise.sigma(value);
        }
    }
}

// Confidence of a pixel: 1 where the slope is certain, 1/2 where its standard error is 0.1 (about 6 degrees).
float confidence_of(const WardEstimate& e) {
    const double t = e.slope_error / 0.1;
    return static_cast<float>(1 / (1 + t * t));
}

double median(std::vector<float>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

struct Counters {
    long fitted = 0, not_converged = 0;
    int rows = 0;
    std::mutex mutex;
};

void fit_band(const Stack& stack, const Band& band, const Lighting& lighting, const NoiseModel& noise,
              const FitOptions& options, Surface& surface, Counters& counters, const Progress& progress) {
    oneapi::tbb::enumerable_thread_specific<WardFitter> fitters([&] { return WardFitter(options.ward); });
    parallel_for(band.y0(), band.y1(), 1, [&](int begin, int end) {
        WardFitter& fitter = fitters.local();
        PixelSamples samples;
        long fitted = 0, not_converged = 0;
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < band.width(); ++x) {
                if (!stack.mask.empty() && !stack.mask(x, y)) continue;
                gather(band, x, y, surface.point_mm(x, y), lighting, noise, samples);
                const WardEstimate e = fitter.fit(samples);
                if (!e.valid) continue;
                ++fitted;
                not_converged += !e.converged;
                surface.normal(x, y) =
                    normal_of({static_cast<float>(e.slope.x), static_cast<float>(e.slope.y)});
                surface.diffuse(x, y) = Rgb(e.diffuse);
                surface.specular(x, y) = static_cast<float>(e.specular);
                surface.roughness(x, y) = static_cast<float>(e.roughness);
                surface.confidence(x, y) = confidence_of(e);
                // Its place until the height is integrated, which saves a map; summarise() reads it.
                surface.height_mm(x, y) = static_cast<float>(e.rms_residual);
            }
        const std::lock_guard lock(counters.mutex);
        counters.fitted += fitted;
        counters.not_converged += not_converged;
        counters.rows += end - begin;
        report(progress, "fit", counters.rows / static_cast<double>(surface.height()));
    });
}

void summarise(const Surface& surface, const Counters& counters, FitReport& report) {
    report.pixels = static_cast<long>(surface.height_mm.size());
    report.fitted = counters.fitted;
    report.not_converged = counters.not_converged;
    std::vector<float> residuals, confidences;
    const std::size_t step = std::max<std::size_t>(1, surface.height_mm.size() / 1000000);
    for (std::size_t i = 0; i < surface.height_mm.size(); i += step)
        if (surface.confidence.pixels()[i] > 0) {
            residuals.push_back(surface.height_mm.pixels()[i]);
            confidences.push_back(surface.confidence.pixels()[i]);
        }
    report.median_rms_residual = median(residuals);
    report.median_confidence = median(confidences);
}

}  // namespace

FitResult fit_painting(Stack stack, const FitOptions& options, const Progress& progress) {
    validate(options);
    require_enough_lights(stack.lights(), stack.folder.string());
    // Sums are taken in this order, so the order of the lines in a lights file changes no bit of the result.
    std::sort(stack.photos.begin(), stack.photos.end(),
              [](const StackPhoto& a, const StackPhoto& b) { return a.path < b.path; });
    Survey surveyed = survey(stack, {}, progress);
    leave_out_black_photos(stack, surveyed);
    FitResult result;
    FitReport& report_ = result.report;
    report_.transfer = estimate_transfer(stack, surveyed);
    const Transfer transfer = report_.transfer.transfer;

    result.surface = Surface(stack.width(), stack.height());
    Surface& surface = result.surface;
    surface.mm_per_pixel = options.mm_per_pixel.value_or(1.0);
    surface.scale_known = options.mm_per_pixel.has_value();
    surface.photography = {.transfer = transfer, .white_level = options.white_level, .photos = {}};
    for (const StackPhoto& photo : stack.photos) surface.photography.photos.push_back({photo.light, true});
    for (const StackPhoto& photo : stack.held_out) surface.photography.photos.push_back({photo.light, false});

    const Lighting lighting{stack.lights(), options.white_level};
    const NoiseModel noise(transfer, options.noise.value_or(stack.bits == 8 ? 0.012 : 0.006),
                           stack.bits != 32);
    StackReader reader(stack);
    const int rows = reader.rows_for(kBandBytes);
    Counters counters;
    Band next = reader.read(0, std::min(rows, stack.height()), transfer);
    for (int y0 = 0; y0 < stack.height(); y0 += rows) {
        const Band band = std::move(next);
        // The next band is decoded while this one is fitted.
        const int y1 = std::min(y0 + rows, stack.height()), y2 = std::min(y1 + rows, stack.height());
        auto decoded = std::async(std::launch::async,
                                  [&, y1, y2] { return y1 < y2 ? reader.read(y1, y2, transfer) : Band(); });
        fit_band(stack, band, lighting, noise, options, surface, counters, progress);
        next = decoded.get();
    }
    summarise(surface, counters, report_);
    report_.height = integrate_normals(surface.normal, surface.confidence, surface.mm_per_pixel,
                                       surface.height_mm, options.height, progress);
    const Plane plane = best_plane(surface.height_mm, surface.confidence);
    subtract(plane, surface.height_mm);
    report_.support_tilt_deg = std::atan(std::hypot(plane.a, plane.b) / surface.mm_per_pixel) * 180 / M_PI;
    report_.warnings = stack.warnings;
    return result;
}

}  // namespace tangi
