#include "fit/light_sample.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>

#include "fit/lobe_colour.h"
#include "fit/lobe_stretch.h"
#include "fit/ward_batch.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr double kModelError = 0.03;
constexpr double kBestDb = 60;  // a photograph predicted to a thousandth of what is bright in it is predicted
constexpr double kBelowBright = 0.98;  // [1] of the values

// `white` [1]: linear value of a matt white in the origin that faces the lamp.
void add_observation(const PixelSamples& s, int photo, const glm::dvec3& white, int pixel,
                     JointLights& joint) {
    double value = 0, variance = 0, irradiance = 0;
    for (int c = 0; c < s.channels; ++c) {
        const auto at = static_cast<std::size_t>(photo * s.channels + c);
        if (!(s.sigma[at] > 0)) return;
        value += s.value[at] / s.channels;
        irradiance += white[c] / s.channels;
        variance += s.sigma[at] * s.sigma[at] / s.channels;  // JPEG's noise is shared by the channels
    }
    const JointLights::Pixel& p = joint.pixels[static_cast<std::size_t>(pixel)];
    const glm::dvec3& l = s.light[static_cast<std::size_t>(photo)];
    const double n_l =
        std::max(l.z - p.slope.x * l.x - p.slope.y * l.y, 0.0) / std::sqrt(1 + glm::dot(p.slope, p.slope));
    // A weak lamp's shadows would hardly be outliers if its error were that of one of usual strength.
    const double strength = std::exp(joint.log_gains[static_cast<std::size_t>(photo)]);
    const double model_error = kModelError * std::max(strength * p.diffuse * n_l, value / irradiance);
    joint.observations.push_back(
        {pixel, photo, value / irradiance, std::hypot(std::sqrt(variance) / irradiance, model_error)});
}

// A smooth field has said what it can of a single lamp.
DirectionFreedom of_its_own(DirectionFreedom directions) {
    return directions == DirectionFreedom::smooth ? DirectionFreedom::listed : directions;
}

// Half of the ranks, so that a sample and those that it changes places with are in the same half.
bool is_other(std::uint32_t rank) { return (rank * 0x9E3779B1u >> 16) % 2 == 1; }

}  // namespace

Beam beam_of(const std::array<double, 5>& terms, double width_mm) {
    Beam beam;
    for (std::size_t i = 0; i < terms.size(); ++i)
        beam.terms[i] = static_cast<float>(terms[i] * std::pow(2 / width_mm, i < 2 ? 1 : 2));
    return beam;
}

std::array<double, 5> scaled_beam(const Beam& beam, double width_mm) {
    std::array<double, 5> terms{};
    for (std::size_t i = 0; i < terms.size(); ++i)
        terms[i] = static_cast<double>(beam.terms[i]) * std::pow(width_mm / 2, i < 2 ? 1 : 2);
    return terms;
}

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

LightSample::LightSample(const Stack& stack, const Survey& survey, const Transfer& transfer,
                         const NoiseModel& noise, double mm_per_pixel, const WardFitOptions& ward, int wanted)
    : survey_(survey), transfer_(transfer), noise_(noise), ward_(ward) {
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

std::vector<Rgb> LightSample::lobe_colours(const std::vector<WardEstimate>& estimates,
                                           const std::vector<int>& photos, const Lighting& lighting,
                                           const ReflectanceLaw& law) const {
    WardFitOptions options = ward_;
    options.law = law;
    std::vector<Rgb> colours(static_cast<std::size_t>(size()), Rgb(1));
    parallel_for(0, size(), 4 * kWardLanes, [&](int begin, int end) {
        PixelSamples samples;
        for (int k = begin; k < end; ++k) {
            const auto at = static_cast<std::size_t>(k);
            if (!estimates[at].valid) continue;
            gather(k, photos, lighting, samples);
            colours[at] = lobe_colour_of(lobe_evidence(samples, estimates[at], options));
        }
    });
    return colours;
}

std::vector<Stretch> LightSample::stretches(const std::vector<WardEstimate>& estimates,
                                            const std::vector<int>& photos, const Lighting& lighting,
                                            const ReflectanceLaw& law) const {
    WardFitOptions options = ward_;
    options.law = law;
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
                                           const ReflectanceLaw& law, const std::vector<Rgb>& lobe_colours,
                                           const std::vector<Stretch>& stretches) const {
    WardFitOptions options = ward_;
    options.law = law;
    std::vector<WardEstimate> estimates(static_cast<std::size_t>(size()));
    struct Fitters {
        explicit Fitters(const WardFitOptions& options) : batches(options), ceres(options) {}
        WardBatchFitter batches;
        WardFitter ceres;
        WardBatch batch;
        PixelSamples samples;
    };
    oneapi::tbb::enumerable_thread_specific<Fitters> all([&] { return Fitters(options); });
    const auto gather_white = [&](int k, PixelSamples& samples) {
        gather(k, photos, lighting, samples);
        if (!lobe_colours.empty()) whiten(lobe_colours[static_cast<std::size_t>(k)], samples);
    };
    const auto prior_of = [&](int k) {
        WardPrior prior = options.prior;
        if (!stretches.empty()) prior.stretch = glm::dvec2(stretches[static_cast<std::size_t>(k)]);
        return prior;
    };
    parallel_for(0, size(), 4 * kWardLanes, [&](int begin, int end) {
        Fitters& f = all.local();
        f.batches.start(end - begin);
        for (int first = begin; first < end; first += kWardLanes) {
            f.batch.resize(static_cast<int>(photos.size()), survey_.channels, options.prior);
            for (int k = first; k < std::min(first + kWardLanes, end); ++k) {
                gather_white(k, f.samples);
                f.batch.set(k - first, k - begin, f.samples);
                f.batch.set_prior(k - first, prior_of(k));
            }
            f.batches.fit(f.batch);
        }
        f.batches.finish();
        for (int k = begin; k < end; ++k) {
            const WardSolution& solution = f.batches.solutions()[static_cast<std::size_t>(k - begin)];
            WardEstimate& estimate = estimates[static_cast<std::size_t>(k)];
            estimate = solution.estimate(survey_.channels);
            estimate.stretch = prior_of(k).stretch;
            if (solution.doubtful) {
                gather_white(k, f.samples);
                const WardEstimate other = f.ceres.fit(f.samples, prior_of(k));
                if (other.valid && !(estimate.valid && estimate.rms_residual <= other.rms_residual))
                    estimate = other;
            }
            if (!lobe_colours.empty())
                estimate = coloured(estimate, lobe_colours[static_cast<std::size_t>(k)]);
        }
    });
    return estimates;
}

double LightSample::psnr_db(const std::vector<WardEstimate>& estimates, int photo, const Lighting& lighting,
                            const ReflectanceLaw& law, const std::vector<bool>& marked) const {
    const double white = transfer_.encode(static_cast<float>(lighting.white_level));
    const float clipped = transfer_.encode(noise_.clipped());
    double squares = 0;
    long count = 0;
    PixelSamples s;
    for (int k = 0; k < size(); ++k) {
        const WardEstimate& e = estimates[static_cast<std::size_t>(k)];
        if (!e.valid || !(marked.empty() || marked[static_cast<std::size_t>(k)])) continue;
        illuminate(lighting, point_mm(k), survey_.channels, s);
        const double theta[kWardCommon] = {e.slope.x, e.slope.y, std::log(e.roughness), e.specular};
        const WardTerms t = ward_terms(theta, s.light[0], s.view, law, e.stretch);
        const float* stored = this->stored(k, photo);
        if (std::isnan(stored[0])) continue;  // outside a registered photograph
        for (int c = 0; c < survey_.channels; ++c, ++count) {
            const double linear =
                s.irradiance[static_cast<std::size_t>(c)] *
                (e.diffuse[c] * (t.matt + s.ambient[0]) + e.specular * e.lobe_colour[c] * t.lobe);
            const float shown = transfer_.encode(std::min(static_cast<float>(linear), noise_.clipped()));
            squares += std::pow((shown - std::min(stored[c], clipped)) / white, 2);
        }
    }
    // Of photographs that are dark as a whole, a thousandth of white would be a large part.
    const double best_db = kBestDb - 20 * std::log10(std::clamp(bright_ / white, 1e-3, 1.0));
    if (count == 0 || squares <= 0) return best_db;
    return std::min(-10 * std::log10(squares / static_cast<double>(count)), best_db);
}

double LightSample::noise_db(double white_level) const {
    return -20 * std::log10(noise_.stored() / transfer_.encode(static_cast<float>(white_level)));
}

std::vector<float> LightSample::log_ratios(const std::vector<WardEstimate>& estimates, int photo,
                                           const Lighting& lighting, const ReflectanceLaw& law) const {
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
        const WardTerms t = ward_terms(theta, s.light[0], s.view, law);
        const double predicted = s.irradiance[static_cast<std::size_t>(channel)] *
                                 (e.diffuse[channel] * (t.matt + s.ambient[0]) + e.specular * t.lobe);
        const double measured = transfer_.decode(stored), dark = kDark * lighting.white_level;
        if (measured >= noise_.clipped() || measured < dark || predicted < dark) continue;
        ratios.back() = static_cast<float>(std::log(measured / predicted));
    }
    return ratios;
}

void LightSample::add_pixel(int k, const WardEstimate& e, const std::vector<int>& photos,
                            const Lighting& lighting, JointLights& joint) const {
    if (!e.valid) return;
    double diffuse = 0;
    for (int c = 0; c < survey_.channels; ++c) diffuse += e.diffuse[c] / survey_.channels;
    const int pixel = static_cast<int>(joint.pixels.size());
    joint.pixels.push_back({.position = glm::dvec2(point_mm(k)) / width_mm_,
                            .sample = k,
                            .slope = e.slope,
                            .ln_alpha = std::log(e.roughness),
                            .specular = std::max(e.specular, 0.002),
                            .diffuse = diffuse});
    add_samples(k, photos, lighting, pixel, joint);
}

JointLights LightSample::joint_problem(const std::vector<int>& photos, const Lighting& lighting) const {
    JointLights joint;
    describe(lighting, joint);
    // In doubles, one pixel after the other: lamps whose strength is not known yet leave a pixel several
    // minima, and with those that batches find, lamps sevenfold apart come out wrong.
    std::vector<WardEstimate> estimates(static_cast<std::size_t>(size()));
    WardFitOptions options = ward_;
    options.by_highlight = false;  // what is poor here are the lamps
    oneapi::tbb::enumerable_thread_specific<WardFitter> fitters([&] { return WardFitter(options); });
    parallel_for(0, size(), 8, [&](int begin, int end) {
        PixelSamples samples;
        for (int k = begin; k < end; ++k) {
            gather(k, photos, lighting, samples);
            estimates[static_cast<std::size_t>(k)] = fitters.local().fit(samples);
        }
    });
    for (int k = 0; k < size(); ++k)
        add_pixel(k, estimates[static_cast<std::size_t>(k)], photos, lighting, joint);
    return joint;
}

Lighting LightSample::located(const std::vector<WardEstimate>& estimates, int photo, const Lighting& lighting,
                              const JointFreedom& freedom) const {
    JointLights joint;
    describe(lighting, joint);
    joint.rig.ambient = lighting.rig.ambient;
    joint.rig.bend = lighting.rig.bend_per_mm * width_mm_;
    for (int k = 0; k < size(); ++k)
        if (!others_[static_cast<std::size_t>(k)])
            add_pixel(k, estimates[static_cast<std::size_t>(k)], {photo}, lighting, joint);
    Lighting result = lighting;
    const JointFreedom of_lamp{.rig = false,
                               .gains = freedom.gains,
                               .directions = of_its_own(freedom.directions),
                               .beams = freedom.beams,
                               .pixels = false};
    const bool fixed = !freedom.gains && !freedom.beams && of_lamp.directions == DirectionFreedom::listed;
    if (fixed || joint.observations.empty() || !joint.solve(of_lamp, JointStart::far)) return result;
    Light& light = result.lights.front();
    light.gain *= static_cast<float>(std::exp(joint.log_gains.front()));
    light.direction = Vec3(turned(joint.directions.front(), joint.turns.front()));
    if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
    light.beam = beam_of(joint.beams.front(), width_mm_);
    return result;
}

JointLights LightSample::joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                                       const JointLights& solved) const {
    JointLights joint;
    joint.pixels = solved.pixels;
    describe(lighting, joint);
    joint.rig = solved.rig;
    joint.gain_scatter = solved.gain_scatter;
    joint.robust_scale = solved.robust_scale;
    for (std::size_t i = 0; i < photos.size(); ++i) {
        joint.log_gains[i] = solved.log_gains[static_cast<std::size_t>(photos[i])];
        joint.turns[i] = solved.turns[static_cast<std::size_t>(photos[i])];
        joint.beams[i] = solved.beams[static_cast<std::size_t>(photos[i])];
    }
    for (std::size_t pixel = 0; pixel < joint.pixels.size(); ++pixel)
        add_samples(joint.pixels[pixel].sample, photos, lighting, static_cast<int>(pixel), joint);
    return joint;
}

JointLights LightSample::joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                                       const JointLights& lamps,
                                       const std::vector<WardEstimate>& estimates) const {
    JointLights joint;
    describe(lighting, joint);
    joint.rig = lamps.rig;
    joint.gain_scatter = lamps.gain_scatter;
    joint.robust_scale = lamps.robust_scale;
    joint.log_gains = lamps.log_gains;
    joint.turns = lamps.turns;
    joint.beams = lamps.beams;
    for (int k = 0; k < size(); ++k)
        add_pixel(k, estimates[static_cast<std::size_t>(k)], photos, lighting, joint);
    return joint;
}

const float* LightSample::stored(int k, int photo) const {
    return survey_.sample(chosen_[static_cast<std::size_t>(k)]) +
           static_cast<std::ptrdiff_t>(photo) * survey_.channels;
}

// What is given of the lamps and the camera.
void LightSample::describe(const Lighting& lighting, JointLights& joint) const {
    joint.lamps_known = !lighting.lights.empty() &&
                        std::all_of(lighting.lights.begin(), lighting.lights.end(),
                                    [](const Light& light) { return light.position_mm.has_value(); });
    for (const Light& light : lighting.lights) {
        joint.directions.emplace_back(light.direction);
        joint.nearer.push_back(joint.lamps_known ? width_mm_ / glm::length(*light.position_mm) : 1);
        joint.log_gains.push_back(0);
        joint.turns.emplace_back(0);
        joint.beams.push_back(scaled_beam(light.beam, width_mm_));
    }
    joint.direction_sigma.assign(lighting.lights.size(), 0);
    for (std::size_t i = 0; i < lighting.direction_sigma_deg.size(); ++i)
        joint.direction_sigma[i] = lighting.direction_sigma_deg[i] * std::numbers::pi / 180;
    if (joint.lamps_known) joint.rig.lamp_nearness = 1;
    if (lighting.rig.camera_distance_mm) {
        joint.camera_known = true;
        joint.rig.camera_nearness = width_mm_ / *lighting.rig.camera_distance_mm;
        joint.camera_axis = glm::dvec2(lighting.rig.camera_axis_mm) / width_mm_;
    }
}

void LightSample::add_samples(int k, const std::vector<int>& photos, const Lighting& lighting, int pixel,
                              JointLights& joint) const {
    PixelSamples s;
    gather(k, photos, lighting, s);
    for (int i = 0; i < s.photos(); ++i) {
        const Rgb& gain = lighting.lights[static_cast<std::size_t>(i)].gain;
        add_observation(s, i, lighting.white_level * glm::dvec3(gain), pixel, joint);
    }
}

}  // namespace tangi
