#include "fit/pipeline/fit_pass.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <mutex>

#include "capture/stack/reduced_photos.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/maps/surface_part.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

// Mean and spread of what several Gaussians say of a number: by the law of total variance.
struct Mixture {
    double weight = 0, sum = 0, squares = 0;
    void add(double w, double mean, double sigma) {
        if (!std::isfinite(sigma)) return;  // nothing is said
        weight += w;
        sum += w * mean;
        squares += w * (sigma * sigma + mean * mean);
    }
    double mean() const { return weight > 0 ? sum / weight : 0; }
    double sigma() const {
        if (!(weight > 0)) return std::numeric_limits<double>::infinity();
        return std::sqrt(std::max(squares / weight - mean() * mean(), 0.0));
    }
};

struct PriorMixture {
    Mixture ln_alpha, specular, slope_x, slope_y;
    void add(double weight, const WardPrior& p) {
        ln_alpha.add(weight, p.ln_alpha, p.ln_alpha_sigma);
        specular.add(weight, p.specular, p.specular_sigma);
        slope_x.add(weight, p.slope.x, p.slope_sigma.x);
        slope_y.add(weight, p.slope.y, p.slope_sigma.y);
    }
    // `within`: by how much more lobes of pixels differ than these do.
    WardPrior prior(double within) const {
        WardPrior p{ln_alpha.mean(), within * ln_alpha.sigma(), specular.mean(), within * specular.sigma()};
        p.slope = {slope_x.mean(), slope_y.mean()};
        p.slope_sigma = {slope_x.sigma(), slope_y.sigma()};
        return p;
    }
};

}  // namespace

FirstPass::FirstPass(const Surface& surface, const Plane& plane, const FitErrors& errors,
                     const WardPrior& general, const Image<unsigned char>& occluded,
                     const Image<float>& height_mm, int reduction, int photos)
    : lights(height_mm.width(), height_mm.height(), photos),
      lobes_(surface, errors, general),
      slopes_(surface, plane),
      shadows_(height_mm, surface.mm_per_pixel / reduction, light_radius_deg(surface, {})),
      occluded_(occluded),
      reduction_(reduction),
      width_(surface.width()),
      height_(surface.height()) {
    if (reduction == 1) return;
    lobes_.advance(0, height_);
    slopes_.advance(0, height_);
}

void FirstPass::advance(int y0, int y1) {
    if (reduction_ > 1) return;  // it knows them all
    lobes_.advance(y0, y1);
    slopes_.advance(y0, y1);
}

WardPrior FirstPass::prior_of(int x, int y) const {
    WardPrior prior = lobes_.at(x, y);
    slopes_.add_to(x, y, prior);
    return prior;
}

WardPrior FirstPass::prior_at(int x, int y) const {
    if (reduction_ == 1) return prior_of(x, y);
    const double u = (x + 0.5) / reduction_ - 0.5, v = (y + 0.5) / reduction_ - 0.5;
    const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
    PriorMixture mixture;
    for (const int j : {0, 1})
        for (const int i : {0, 1}) {
            const double weight = (i ? u - left : left + 1 - u) * (j ? v - top : top + 1 - v);
            mixture.add(weight,
                        prior_of(std::clamp(left + i, 0, width_ - 1), std::clamp(top + j, 0, height_ - 1)));
        }
    // The blocks' lobes are means: where neighbouring pixels have nothing in common, these differ so much
    // less than pixels do.
    return mixture.prior(reduction_);
}

namespace {

// One band; two are in memory at a time. Small ones stay in the processor's caches, and their memory is used
// again instead of given back; but photographs that are resampled share rows between bands, and each thread
// needs rows of its own.
constexpr std::size_t kBandBytes = 24u << 20, kLargestBandBytes = 96u << 20;
constexpr int kRowsAThread = 4;

// Confidence of a pixel: 1 where the slope is certain, 1/2 where its standard error is 0.1 (about 6 degrees).
float confidence_of(const WardEstimate& e) {
    const double t = e.slope_error / kHalfConfidence;
    return static_cast<float>(1 / (1 + t * t));
}

constexpr std::size_t kRmsResiduals = 1000000;
std::size_t pixels_of_painting(const Surface& s) {
    const glm::ivec2 size = painting_size(s);
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
}
std::size_t rms_step(const Surface& s) {
    return std::max<std::size_t>(1, pixels_of_painting(s) / kRmsResiduals);
}

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

// What is known of pixels beside their photographs. Lobes have the colours that the surface says.
PixelKnowledge knowledge_of(const FitPass& pass, const Surface& surface, const WardPrior& general) {
    PixelKnowledge known;
    const bool coloured = !surface.specular_colour.empty();
    if (coloured) known.specular_colour = [&](int x, int y) { return surface.specular_colour(x, y); };
    if (!surface.lobe_axes.empty())
        known.stretch = [&surface](int x, int y) {
            return glm::dvec2(stretch_of(surface.lobe_axes(x, y), surface.roughness(x, y)));
        };
    const auto stretched = [stretch = known.stretch](int x, int y, WardPrior prior) {
        if (stretch) prior.stretch = stretch(x, y);
        return prior;
    };
    if (!pass.first) {
        if (known.stretch)
            known.prior = [stretched, general](int x, int y) { return stretched(x, y, general); };
        return known;
    }
    const glm::ivec2 corner = in_painting(surface, 0, 0);
    known.prior = [&surface, coloured, stretched, corner, first = pass.first](int x, int y) {
        WardPrior prior = stretched(x, y, first->prior_at(corner.x + x, corner.y + y));
        if (!coloured) return prior;
        // rho_s of a white lobe is that of the mean channel, of a coloured one that of the largest.
        const Rgb& colour = surface.specular_colour(x, y);
        const double scale = 3 / static_cast<double>(colour.r + colour.g + colour.b);
        prior.specular *= scale;
        prior.specular_sigma *= scale;
        return prior;
    };
    known.shadows = &pass.first->shadows();
    known.occluded = [corner, first = pass.first](int x, int y) {
        return first->is_occluded(corner.x + x, corner.y + y);
    };
    known.lights = &pass.first->lights;
    return known;
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
void each_band(int height, int rows, const std::function<Band(int y0, int y1)>& read, const Do& act) {
    const auto read_from = [&](int y0) {
        return y0 < height ? read(y0, std::min(y0 + rows, height)) : Band();
    };
    Band next = read_from(0);
    for (int y0 = 0; y0 < height; y0 += rows) {
        const Band band = std::move(next);
        auto decoded = std::async(std::launch::async, [&, y0] { return read_from(y0 + rows); });
        act(band);
        next = decoded.get();
    }
}

template <class Do>
void each_band(const CalibratedStack& input, const Do& act) {
    const Transfer& transfer = input.transfer;
    if (const ReducedPhotos* reduced = input.reduced) {
        constexpr int rows = 64;  // of a megapixel, some dozens of photographs are some 20 MB
        return each_band(
            reduced->height(), rows, [&](int y0, int y1) { return reduced->read(y0, y1, transfer); }, act);
    }
    std::optional<StackReader> own;
    StackReader& reader = input.reader ? *input.reader : own.emplace(input.stack);
    const int first = input.reader ? input.first_row : 0;
    each_band(
        input.stack.height(), rows_of_band(input.stack, reader),
        [&](int y0, int y1) { return reader.read(first + y0, first + y1, transfer).moved(-first); }, act);
}

// Keeps references to all that it is given.
class PassFitter {
public:
    PassFitter(const CalibratedStack& input, const FitOptions& options, const FitPass& pass,
               FitResult& result, const Progress& progress)
        : input_(input),
          options_(options),
          ward_(ward_options(options, result.surface)),
          pass_(pass),
          known_(knowledge_of(pass, result.surface, options.ward.prior)),
          sampled_(sampled_pixels(result.surface.width(), result.surface.height())),
          result_(result),
          progress_(progress),
          counts_(pass.tile > 0 ? static_cast<std::size_t>((result.surface.width() - 1) / pass.tile + 1)
                                : 1) {}

    std::vector<PassCounts> run() {
        each_band(input_, [&](const Band& band) {
            if (pass_.first) pass_.first->advance(band.y0(), band.y1());
            fit_band(band);
        });
        // Threads found them in any order.
        for (PassCounts& counts : counts_) std::ranges::sort(counts.rms_residuals);
        return std::move(counts_);
    }

private:
    static WardFitOptions ward_options(const FitOptions& options, const Surface& surface) {
        WardFitOptions ward = options.ward;
        ward.reflectance_model = surface.reflectance_model;
        return ward;
    }
    void fit_band(const Band& band);
    void take(const Band& band, int x, int y, const WardEstimate& estimate, RowFitter& fitter);
    // Of a pixel among those of the painting.
    std::size_t index_of(int x, int y) const {
        const glm::ivec2 at = in_painting(result_.surface, x, y);
        return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(painting_size(result_.surface).x) +
               static_cast<std::size_t>(at.x);
    }

    const CalibratedStack& input_;
    const FitOptions& options_;
    const WardFitOptions ward_;
    const FitPass& pass_;
    const PixelKnowledge known_;
    const SampledPixels sampled_;
    FitResult& result_;
    const Progress& progress_;
    std::vector<PassCounts> counts_;  // of each tile
    int rows_ = 0;
    std::mutex mutex_;
};

void PassFitter::fit_band(const Band& band) {
    const Surface& surface = result_.surface;
    oneapi::tbb::enumerable_thread_specific<RowFitter> fitters(
        [&] { return RowFitter(ward_, options_.solver, input_.lighting, input_.noise, band.channels()); });
    // Enough pixels at once to keep registers full; with Ceres alone a row takes long enough.
    const int rows = options_.solver == Solver::batch ? std::max(1, 4096 / band.width()) : 1;
    const RowTask task{surface, known_, pass_.mask, pass_.judged, pass_.tile};
    parallel_for(band.y0(), band.y1(), rows, [&](int begin, int end) {
        RowFitter& fitter = fitters.local();
        std::vector<PassCounts> counts(counts_.size());
        fitter.fit(band, begin, end, task, [&](int x, int y, const WardEstimate& e) {
            PassCounts& here = counts[static_cast<std::size_t>(pass_.tile > 0 ? x / pass_.tile : 0)];
            ++here.fitted;
            here.not_converged += !e.converged;
            if (index_of(x, y) % rms_step(surface) == 0)
                here.rms_residuals.push_back(static_cast<float>(e.rms_residual));
            take(band, x, y, e, fitter);
        });
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < counts.size(); ++i) counts_[i] += counts[i];
        rows_ += end - begin;
        report(progress_, pass_.name, rows_ / static_cast<double>(surface.height()));
    });
    for (const RowFitter& fitter : fitters)
        for (std::size_t i = 0; i < fitter.agreement().size(); ++i)
            counts_[i].solvers += fitter.agreement()[i];
}

// The estimate of a pixel becomes part of the maps, and evidence for later passes.
void PassFitter::take(const Band& band, int x, int y, const WardEstimate& e, RowFitter& fitter) {
    store(e, x, y, result_);
    const Surface& surface = result_.surface;
    const auto samples = [&]() -> const PixelSamples& { return fitter.samples_at(band, x, y, surface, {}); };
    if (pass_.colours) (*pass_.colours)(x, y) = lobe_evidence(samples(), e, ward_);
    if (pass_.stretches && sampled_.x.has(x) && sampled_.y.has(y))
        (*pass_.stretches)(sampled_.x.nearest(x), sampled_.y.nearest(y)) =
            stretch_evidence(samples(), e, ward_);
}

}  // namespace

PassCounts& PassCounts::operator+=(const PassCounts& other) {
    fitted += other.fitted;
    not_converged += other.not_converged;
    solvers += other.solvers;
    rms_residuals.insert(rms_residuals.end(), other.rms_residuals.begin(), other.rms_residuals.end());
    return *this;
}

void summarise(const PassCounts& counts, const FitOptions& options, FitResult& result) {
    const Surface& surface = result.surface;
    FitReport& report = result.report;
    report.pixels = static_cast<long>(surface.height_mm.size());
    report.fitted = counts.fitted;
    report.not_converged = counts.not_converged;
    report.solvers = counts.solvers;
    report.too_bright = 0;
    for (const Rgb& diffuse : surface.diffuse.pixels())
        report.too_bright +=
            std::max({diffuse.r, diffuse.g, diffuse.b}) > 0.99 * options.ward.bounds.diffuse_max;
    std::vector<float> confidences;
    for (std::size_t i = 0; i < surface.height_mm.size(); i += rms_step(surface))
        if (surface.confidence.pixels()[i] > 0) confidences.push_back(surface.confidence.pixels()[i]);
    report.median_rms_residual = median(counts.rms_residuals);
    const auto unsure =
        std::count_if(confidences.begin(), confidences.end(), [](float c) { return c < 0.5f; });
    report.unsure =
        static_cast<double>(unsure) / static_cast<double>(std::max<std::size_t>(confidences.size(), 1));
    report.median_confidence = median(std::move(confidences));
}

std::vector<PassCounts> fit_pixels(const CalibratedStack& input, const FitOptions& options,
                                   const FitPass& pass, FitResult& result, const Progress& progress) {
    return PassFitter(input, options, pass, result, progress).run();
}

void fit_pass(const CalibratedStack& input, const FitOptions& options, const FitPass& pass, FitResult& result,
              const Progress& progress) {
    summarise(fit_pixels(input, options, pass, result, progress).front(), options, result);
}

}  // namespace tangi
