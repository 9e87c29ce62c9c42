#include "fit/calibration/light_sample.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>

#include "fit/material/anisotropy_estimate.h"
#include "fit/material/specular_colour.h"
#include "fit/pixel/ward_batch.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr double kBestDb = 60;  // a photograph predicted to a thousandth of what is bright in it is predicted
constexpr double kBelowBright = 0.98;  // [1] of the values

// Half of the ranks, so that a sample and those that it changes places with are in the same half.
bool is_other(std::uint32_t rank) { return (rank * 0x9E3779B1u >> 16) % 2 == 1; }

// Fits pixels in batches, and those that batches leave in doubt with Ceres. Keeps its memory; one a thread.
class SampleFitter {
public:
    SampleFitter(const WardFitOptions& options, int photos, int channels)
        : general_(options.prior), photos_(photos), channels_(channels), batches_(options), ceres_(options) {}

    // Pixels begin <= k < end, with what gather(k, samples) and prior_of(k) know of them; estimates[0] is
    // that of `begin`.
    template <class Gather, class PriorOf>
    void fit(int begin, int end, const Gather& gather, const PriorOf& prior_of,
             std::span<WardEstimate> estimates) {
        batches_.start(end - begin);
        for (int first = begin; first < end; first += kWardLanes) {
            batch_.resize(photos_, channels_, general_);
            for (int k = first; k < std::min(first + kWardLanes, end); ++k) {
                gather(k, samples_);
                batch_.set(k - first, k - begin, samples_);
                batch_.set_prior(k - first, prior_of(k));
            }
            batches_.fit(batch_);
        }
        batches_.finish();
        for (int k = begin; k < end; ++k) {
            const auto at = static_cast<std::size_t>(k - begin);
            const WardSolution& solution = batches_.solutions()[at];
            WardEstimate& estimate = estimates[at];
            estimate = solution.estimate(channels_);
            estimate.stretch = prior_of(k).stretch;
            if (!solution.doubtful) continue;
            gather(k, samples_);
            const WardEstimate other = ceres_.fit(samples_, prior_of(k));
            if (other.valid && !(estimate.valid && estimate.rms_residual <= other.rms_residual))
                estimate = other;
        }
    }

private:
    WardPrior general_;
    int photos_, channels_;
    WardBatchFitter batches_;
    WardFitter ceres_;
    WardBatch batch_;
    PixelSamples samples_;
};

}  // namespace

float bright_stored(const Survey& survey) {
    std::vector<float> values;
    std::copy_if(survey.values.begin(), survey.values.end(), std::back_inserter(values),
                 [](float value) { return !std::isnan(value); });
    if (values.empty()) return 0;
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(kBelowBright * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

LightSample::LightSample(const SurveyedStack& surveyed, const WardFitOptions& ward, int wanted, bool flat)
    : survey_(surveyed.survey),
      transfer_(surveyed.transfer),
      noise_(surveyed.noise),
      ward_(ward),
      flat_(flat) {
    const auto& [stack, survey, transfer, noise, mm_per_pixel] = surveyed;
    width_mm_ = std::max(stack.width(), stack.height()) * mm_per_pixel;
    chosen_ = survey.spread(wanted);
    for (const int k : chosen_) {
        others_.push_back(survey.ranks.empty() ? others_.size() % 2 == 1
                                               : is_other(survey.ranks[static_cast<std::size_t>(k)]));
        const glm::dvec2 centred(
            survey.positions[static_cast<std::size_t>(k)].x - (stack.width() - 1) / 2.0,
            (stack.height() - 1) / 2.0 - survey.positions[static_cast<std::size_t>(k)].y);
        points_mm_.emplace_back(Vec3(centred * mm_per_pixel, 0));
        places_px_.emplace_back(survey.positions[static_cast<std::size_t>(k)]);
    }
    bright_ = bright_stored(survey);
}

LightSample LightSample::with_ln_alpha(double ln_alpha) const {
    LightSample result = *this;
    result.ward_.prior.ln_alpha = ln_alpha;
    return result;
}

// Samples of pixel k in these photographs; the lighting has one light for each of them.
void LightSample::gather(int k, const std::vector<int>& photos, const Lighting& lighting,
                         PixelSamples& s) const {
    illuminate(lighting, point_mm(k), survey_.channels, s);
    std::size_t at = 0;
    for (const int photo : photos) {
        const float* stored = this->stored(k, photo);
        for (int c = 0; c < survey_.channels; ++c, ++at) {
            const float value = transfer_.decode(stored[c]);
            s.value[at] = value;
            // Outside a registered photograph there is nothing, which decodes as black.
            s.sigma[at] = std::isnan(stored[c]) ? 0 : noise_.sigma(value);
        }
    }
}

std::vector<Rgb> LightSample::specular_colours(const std::vector<WardEstimate>& estimates,
                                               const std::vector<int>& photos, const Lighting& lighting,
                                               const ReflectanceModel& reflectance_model) const {
    WardFitOptions options = ward_;
    options.reflectance_model = reflectance_model;
    std::vector<Rgb> colours(static_cast<std::size_t>(size()), Rgb(1));
    parallel_for(0, size(), 4 * kWardLanes, [&](int begin, int end) {
        PixelSamples samples;
        for (int k = begin; k < end; ++k) {
            const auto at = static_cast<std::size_t>(k);
            if (!estimates[at].valid) continue;
            gather(k, photos, lighting, samples);
            colours[at] = specular_colour_of(lobe_evidence(samples, estimates[at], options));
        }
    });
    return colours;
}

std::vector<Stretch> LightSample::stretches(const std::vector<WardEstimate>& estimates,
                                            const std::vector<int>& photos, const Lighting& lighting,
                                            const ReflectanceModel& reflectance_model) const {
    WardFitOptions options = ward_;
    options.reflectance_model = reflectance_model;
    std::vector<Stretch> stretches(static_cast<std::size_t>(size()), Stretch(0));
    parallel_for(0, size(), kWardLanes, [&](int begin, int end) {
        PixelSamples samples;
        for (int k = begin; k < end; ++k) {
            const auto at = static_cast<std::size_t>(k);
            if (!estimates[at].valid) continue;
            gather(k, photos, lighting, samples);
            stretches[at] = stretch_of(stretch_evidence(samples, estimates[at], options));
        }
    });
    return stretches;
}

std::vector<WardEstimate> LightSample::fit(const std::vector<int>& photos, const Lighting& lighting,
                                           const ReflectanceModel& reflectance_model,
                                           const std::vector<Rgb>& specular_colours,
                                           const std::vector<Stretch>& stretches) const {
    WardFitOptions options = ward_;
    options.reflectance_model = reflectance_model;
    std::vector<WardEstimate> estimates(static_cast<std::size_t>(size()));
    const auto gather_white = [&](int k, PixelSamples& samples) {
        gather(k, photos, lighting, samples);
        if (!specular_colours.empty())
            divide_by_specular_colour(specular_colours[static_cast<std::size_t>(k)], samples);
    };
    const auto prior_of = [&](int k) {
        WardPrior prior = options.prior;
        if (!stretches.empty()) prior.stretch = glm::dvec2(stretches[static_cast<std::size_t>(k)]);
        return prior;
    };
    oneapi::tbb::enumerable_thread_specific<SampleFitter> all(
        [&] { return SampleFitter(options, static_cast<int>(photos.size()), survey_.channels); });
    parallel_for(0, size(), 4 * kWardLanes, [&](int begin, int end) {
        all.local().fit(begin, end, gather_white, prior_of,
                        std::span(estimates).subspan(static_cast<std::size_t>(begin)));
        for (int k = begin; k < end && !specular_colours.empty(); ++k) {
            WardEstimate& estimate = estimates[static_cast<std::size_t>(k)];
            estimate = coloured(estimate, specular_colours[static_cast<std::size_t>(k)]);
        }
    });
    return estimates;
}

std::vector<double> LightSample::squared_errors(const std::vector<WardEstimate>& estimates, int photo,
                                                const Lighting& lighting,
                                                const ReflectanceModel& reflectance_model) const {
    const double white = transfer_.encode(static_cast<float>(lighting.white_level));
    const float clipped = transfer_.encode(noise_.clipped());
    std::vector<double> errors(static_cast<std::size_t>(size()), std::numeric_limits<double>::quiet_NaN());
    PixelSamples s;
    for (int k = 0; k < size(); ++k) {
        const WardEstimate& e = estimates[static_cast<std::size_t>(k)];
        const float* stored = this->stored(k, photo);
        if (!e.valid || std::isnan(stored[0])) continue;  // outside a registered photograph
        illuminate(lighting, point_mm(k), survey_.channels, s);
        const double theta[kWardCommon] = {e.slope.x, e.slope.y, std::log(e.roughness), e.specular};
        const WardTerms t = ward_terms(theta, s.light[0], s.view, reflectance_model, e.stretch);
        double squares = 0;
        for (int c = 0; c < survey_.channels; ++c) {
            const double linear =
                s.irradiance[static_cast<std::size_t>(c)] *
                (e.diffuse[c] * (t.matt + s.ambient[0]) + e.specular * e.specular_colour[c] * t.lobe);
            const float shown = transfer_.encode(std::min(static_cast<float>(linear), noise_.clipped()));
            squares += std::pow((shown - std::min(stored[c], clipped)) / white, 2);
        }
        errors[static_cast<std::size_t>(k)] = squares / survey_.channels;
    }
    return errors;
}

double LightSample::psnr_db(const std::vector<double>& squared_errors, double white_level,
                            const std::vector<bool>& marked) const {
    double squares = 0;
    long count = 0;
    for (std::size_t k = 0; k < squared_errors.size(); ++k) {
        if (std::isnan(squared_errors[k]) || !(marked.empty() || marked[k])) continue;
        squares += squared_errors[k];
        ++count;
    }
    const double white = transfer_.encode(static_cast<float>(white_level));
    // Of photographs that are dark as a whole, a thousandth of white would be a large part.
    const double best_db = kBestDb - 20 * std::log10(std::clamp(bright_ / white, 1e-3, 1.0));
    if (count == 0 || squares <= 0) return best_db;
    return std::min(-10 * std::log10(squares / static_cast<double>(count)), best_db);
}

double LightSample::squared_noise(double white_level) const {
    const double sigma = noise_.stored() / transfer_.encode(static_cast<float>(white_level));
    return sigma * sigma;
}

std::vector<float> LightSample::log_ratios(const std::vector<WardEstimate>& estimates, int photo,
                                           const Lighting& lighting,
                                           const ReflectanceModel& reflectance_model) const {
    constexpr double kDark = 0.02;  // [1] of the white level: noise, and shadows
    std::vector<float> ratios;
    PixelSamples s;
    for (int k = 0; k < size(); ++k) {
        ratios.push_back(std::numeric_limits<float>::quiet_NaN());
        const WardEstimate& e = estimates[static_cast<std::size_t>(k)];
        const int channel = survey_.channels / 2;
        const float stored = this->stored(k, photo)[channel];
        if (!e.valid || std::isnan(stored)) continue;
        illuminate(lighting, point_mm(k), survey_.channels, s);
        const double theta[kWardCommon] = {e.slope.x, e.slope.y, std::log(e.roughness), e.specular};
        const WardTerms t = ward_terms(theta, s.light[0], s.view, reflectance_model);
        const double predicted = s.irradiance[static_cast<std::size_t>(channel)] *
                                 (e.diffuse[channel] * (t.matt + s.ambient[0]) + e.specular * t.lobe);
        const double measured = transfer_.decode(stored), dark = kDark * lighting.white_level;
        if (measured >= noise_.clipped() || measured < dark || predicted < dark) continue;
        ratios.back() = static_cast<float>(std::log(measured / predicted));
    }
    return ratios;
}

const float* LightSample::stored(int k, int photo) const {
    return survey_.sample(chosen_[static_cast<std::size_t>(k)]) +
           static_cast<std::ptrdiff_t>(photo) * survey_.channels;
}

}  // namespace tangi
