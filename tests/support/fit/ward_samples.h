// ward_samples.h: pixels of a generated stack, and where a solver may start on them: what the tests of
// WardFitter and its benchmark share.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <limits>
#include <vector>

#include "datasets/generator.h"
#include "fit/pixel/ward_fit.h"
#include "tests/support/test_support.h"

namespace tangi {

inline double robust_cost(const PixelSamples& samples, const WardFitOptions& options,
                          const WardVector& theta) {
    const WardResiduals residuals(samples, options.prior, options.robust_scale);
    std::vector<double> r(static_cast<std::size_t>(residuals.size()));
    residuals.evaluate(theta.data(), r.data(), nullptr);
    double sum = 0;
    for (const double value : r) sum += value * value;
    return sum;
}

// Where WardFitter starts: photometric stereo, and the best of five widths with the rho_s that suits each.
inline WardVector start_of(const PixelSamples& s, const WardFitOptions& options) {
    const LambertEstimate matt = photometric_stereo(s);
    WardVector best{};
    double best_cost = std::numeric_limits<double>::infinity();
    for (const double alpha : {0.06, 0.12, 0.2, 0.32, 0.5}) {
        WardVector theta = {-matt.normal.x / matt.normal.z,
                            -matt.normal.y / matt.normal.z,
                            std::log(alpha),
                            0,
                            matt.diffuse[0],
                            matt.diffuse[1],
                            matt.diffuse[2]};
        double numerator = 0, denominator = 0;
        for (std::size_t i = 0; i < s.value.size(); ++i) {
            if (!(s.sigma[i] > 0)) continue;
            const auto channels = static_cast<std::size_t>(s.channels);
            const WardTerms t = ward_terms(theta.data(), s.light[i / channels], s.view);
            const double lobe = s.irradiance[i] * t.lobe / s.sigma[i];
            const double left = s.value[i] - s.irradiance[i] * theta[kWardCommon + i % channels] * t.matt;
            numerator += lobe * left / s.sigma[i];
            denominator += lobe * lobe;
        }
        theta[3] =
            denominator > 0 ? std::clamp(numerator / denominator, 0.002, options.bounds.specular_max) : 0.002;
        const double cost = robust_cost(s, options, theta);
        if (cost < best_cost) {
            best_cost = cost;
            best = theta;
        }
    }
    return best;
}

// Pixels of a generated stack: GGX, cast shadows, sensor noise. sigma has the model's error in it already, so
// that WardFitter is run without its own and both solvers see the same.
inline std::vector<PixelSamples> generated_pixels(int count, int channels) {
    const PaintingTruth truth = procedural_painting({.width = 64, .height = 48});
    GeneratorOptions options;
    options.lights = 40;
    const Photography photography = photography_of(truth, options);
    Random random(77);
    std::vector<glm::ivec2> places;
    for (int i = 0; i < count; ++i) places.emplace_back(random.below(64), random.below(48));
    std::vector<PixelSamples> pixels(places.size());
    for (PixelSamples& s : pixels) s.resize(options.lights, channels);
    for (int i = 0; i < options.lights; ++i) {
        const Light& light = photography.photos[static_cast<std::size_t>(i)].light;
        const Image<Rgb> photo = apply_sensor(render_photo(truth, light, options), options, i);
        for (std::size_t k = 0; k < places.size(); ++k) {
            PixelSamples& s = pixels[k];
            s.light[static_cast<std::size_t>(i)] = light.direction;
            for (int c = 0; c < channels; ++c) {
                const auto at = static_cast<std::size_t>(i * channels + c);
                s.value[at] = photo(places[k].x, places[k].y)[c];
                s.irradiance[at] = options.white_level;
                s.sigma[at] = s.value[at] > 0.99 ? 0 : std::hypot(0.006, 0.05 * s.value[at]);
            }
        }
    }
    return pixels;
}

}  // namespace tangi
