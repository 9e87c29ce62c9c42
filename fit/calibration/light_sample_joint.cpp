// light_sample_joint.cpp: what a LightSample's photographs say of the lights, as a joint problem.
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/calibration/light_sample.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr double kModelError = 0.03;

// `white` [1]: linear value of a matt white in the origin that faces the light. Grey is the mean of what
// channels are in units of their own white.
void add_observation(const PixelSamples& s, int photo, const glm::dvec3& white, int pixel,
                     LightBundleAdjustment& joint) {
    double value = 0, variance = 0;
    for (int c = 0; c < s.channels; ++c) {
        const auto at = static_cast<std::size_t>(photo * s.channels + c);
        if (!(s.sigma[at] > 0)) return;
        value += s.value[at] / white[c] / s.channels;
        // JPEG's noise is shared by the channels.
        variance += s.sigma[at] * s.sigma[at] / (white[c] * white[c]) / s.channels;
    }
    const LightBundleAdjustment::Pixel& p = joint.pixels[static_cast<std::size_t>(pixel)];
    const glm::dvec3& l = s.light[static_cast<std::size_t>(photo)];
    const double n_l =
        std::max(l.z - p.slope.x * l.x - p.slope.y * l.y, 0.0) / std::sqrt(1 + glm::dot(p.slope, p.slope));
    // A weak light's shadows would hardly be outliers if its error were that of one of usual strength.
    const double strength = std::exp(joint.log_gains[static_cast<std::size_t>(photo)]);
    const double model_error = kModelError * std::max(strength * p.diffuse * n_l, value);
    joint.observations.push_back({pixel, photo, value, std::hypot(std::sqrt(variance), model_error)});
}

// A smooth field has said what it can of a single light.
DirectionFreedom of_its_own(DirectionFreedom directions) {
    return directions == DirectionFreedom::smooth ? DirectionFreedom::listed : directions;
}

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

void LightSample::add_pixel(int k, const WardEstimate& e, const std::vector<int>& photos,
                            const Lighting& lighting, LightBundleAdjustment& joint) const {
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

LightBundleAdjustment LightSample::joint_problem(const std::vector<int>& photos,
                                                 const Lighting& lighting) const {
    LightBundleAdjustment joint;
    describe(lighting, joint);
    // In doubles, one pixel after the other: lights whose strength is not known yet leave a pixel several
    // minima, and with those that batches find, lights sevenfold apart come out wrong.
    std::vector<WardEstimate> estimates(static_cast<std::size_t>(size()));
    WardFitOptions options = ward_;
    options.by_highlight = false;  // what is poor here are the lights
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
    LightBundleAdjustment joint;
    describe(lighting, joint);
    joint.rig.ambient = lighting.rig.ambient;
    joint.rig.bend = lighting.rig.bend_per_mm * width_mm_;
    for (int k = 0; k < size(); ++k)
        if (!others_[static_cast<std::size_t>(k)])
            add_pixel(k, estimates[static_cast<std::size_t>(k)], {photo}, lighting, joint);
    Lighting result = lighting;
    const JointFreedom of_light{.rig = false,
                                .gains = freedom.gains,
                                .directions = of_its_own(freedom.directions),
                                .beams = freedom.beams,
                                .pixels = false};
    const bool fixed = !freedom.gains && !freedom.beams && of_light.directions == DirectionFreedom::listed;
    if (fixed || joint.observations.empty() || !joint.solve(of_light, JointStart::far)) return result;
    Light& light = result.lights.front();
    light.gain *= static_cast<float>(std::exp(joint.log_gains.front()));
    light.direction = Vec3(turned(joint.directions.front(), joint.turns.front()));
    if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
    light.beam = beam_of(joint.beams.front(), width_mm_);
    return result;
}

LightBundleAdjustment LightSample::joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                                                 const LightBundleAdjustment& solved) const {
    LightBundleAdjustment joint;
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

LightBundleAdjustment LightSample::joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                                                 const LightBundleAdjustment& lights,
                                                 const std::vector<WardEstimate>& estimates) const {
    LightBundleAdjustment joint;
    describe(lighting, joint);
    joint.rig = lights.rig;
    joint.gain_scatter = lights.gain_scatter;
    joint.robust_scale = lights.robust_scale;
    joint.log_gains = lights.log_gains;
    joint.turns = lights.turns;
    joint.beams = lights.beams;
    for (int k = 0; k < size(); ++k)
        add_pixel(k, estimates[static_cast<std::size_t>(k)], photos, lighting, joint);
    return joint;
}

// What is given of the lights and the camera.
void LightSample::describe(const Lighting& lighting, LightBundleAdjustment& joint) const {
    joint.lights_known = !lighting.lights.empty() &&
                         std::all_of(lighting.lights.begin(), lighting.lights.end(),
                                     [](const Light& light) { return light.position_mm.has_value(); });
    joint.flat = flat_;
    for (const Light& light : lighting.lights) {
        joint.directions.emplace_back(light.direction);
        joint.nearer.push_back(joint.lights_known ? width_mm_ / glm::length(*light.position_mm) : 1);
        joint.log_gains.push_back(0);
        joint.turns.emplace_back(0);
        joint.beams.push_back(scaled_beam(light.beam, width_mm_));
    }
    joint.direction_sigma.assign(lighting.lights.size(), 0);
    for (std::size_t i = 0; i < lighting.direction_sigma_deg.size(); ++i)
        joint.direction_sigma[i] = lighting.direction_sigma_deg[i] * std::numbers::pi / 180;
    if (joint.lights_known) joint.rig.light_inverse_distance = 1;
    if (lighting.rig.camera_distance_mm) {
        joint.camera_known = true;
        joint.rig.camera_inverse_distance = width_mm_ / *lighting.rig.camera_distance_mm;
        joint.camera_axis = glm::dvec2(lighting.rig.camera_axis_mm) / width_mm_;
    }
}

void LightSample::add_samples(int k, const std::vector<int>& photos, const Lighting& lighting, int pixel,
                              LightBundleAdjustment& joint) const {
    PixelSamples s;
    gather(k, photos, lighting, s);
    for (int i = 0; i < s.photos(); ++i) {
        const Rgb& gain = lighting.lights[static_cast<std::size_t>(i)].gain;
        add_observation(s, i, lighting.white_level * glm::dvec3(gain), pixel, joint);
    }
}

}  // namespace tangi
