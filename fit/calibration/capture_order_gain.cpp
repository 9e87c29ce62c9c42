#include "fit/calibration/capture_order_gain.h"

#include <cmath>
#include <vector>

namespace tangi {

namespace {

constexpr double kScoreScale = 0.05;   // [1] ln gain: errors well above count by their number, not their size
constexpr double kWorthOfOrder = 0.9;  // [1] part of the model's score that order must stay below

double log_gain(const Light& light) { return std::log(std::max(static_cast<double>(light.gain.g), 1e-6)); }

double trend_at(const LightModel& model, const Vec3& direction) {
    return std::log(predicted_gain(model, {}, direction));
}

// `place` of the photograph in the order; `validation` < 0: none.
double predicted_log_gain(const ShotOrder& o, const LightModel& model, std::span<const Light> lights,
                          const Vec3& direction, double place, int validation) {
    double sum = 0, weight = o.shrink;
    for (int i = 0; i < static_cast<int>(lights.size()); ++i) {
        if (i == validation) continue;
        const Light& light = lights[static_cast<std::size_t>(i)];
        const Vec3 d = light.direction - direction;
        const double shots = (i - place) / o.reach;
        const double w = std::exp(-glm::dot(d, d) / (2 * o.distance * o.distance) - shots * shots / 2);
        sum += w * (log_gain(light) - trend_at(model, light.direction));
        weight += w;
    }
    return trend_at(model, direction) + sum / weight;
}

template <class Predict>
double score(std::span<const Light> lights, Predict&& predict) {
    double sum = 0;
    for (int i = 0; i < static_cast<int>(lights.size()); ++i) {
        const double error = (predict(i) - log_gain(lights[static_cast<std::size_t>(i)])) / kScoreScale;
        sum += std::log1p(error * error);
    }
    return sum;
}

std::vector<Light> without(std::span<const Light> lights, int validation) {
    std::vector<Light> rest(lights.begin(), lights.end());
    rest.erase(rest.begin() + validation);
    return rest;
}

}  // namespace

ShotOrder fit_shot_order(const LightModel& model, std::span<const Light> lights) {
    ShotOrder best;
    double best_score = kWorthOfOrder * score(lights, [&](int i) {
                            return std::log(predicted_gain(model, without(lights, i),
                                                           lights[static_cast<std::size_t>(i)].direction));
                        });
    for (const double reach : {0.7, 1.0, 1.5, 3.0})
        for (const double distance : {0.2, 0.4, 0.8})
            for (const double shrink : {0.1, 0.3, 1.0}) {
                const ShotOrder order{reach, distance, shrink};
                const double here = score(lights, [&](int i) {
                    return predicted_log_gain(order, model, lights,
                                              lights[static_cast<std::size_t>(i)].direction, i, i);
                });
                if (here >= best_score) continue;
                best_score = here;
                best = order;
            }
    return best;
}

double predicted_gain(const ShotOrder& order, const LightModel& model, std::span<const Light> lights,
                      const Vec3& direction, int before) {
    if (!(order.reach > 0)) return predicted_gain(model, lights, direction);
    return std::exp(predicted_log_gain(order, model, lights, direction, before - 0.5, -1));
}

}  // namespace tangi
