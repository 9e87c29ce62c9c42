// capture_order_gain_test.cpp: a light that drifts while it is carried around is predicted from its
// neighbours in time.
#include "fit/calibration/capture_order_gain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Up and down the sky in arcs, as one carries a light; `log_gain` of the place in the order.
template <class LogGain>
std::vector<Light> arcs(int count, LogGain&& log_gain) {
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        const double azimuth = 0.5 * (i / 6), elevation = 0.3 + 0.2 * (i / 6 % 2 ? 5 - i % 6 : i % 6);
        Light light = distant_light({static_cast<float>(std::cos(azimuth) * std::cos(elevation)),
                                     static_cast<float>(std::sin(azimuth) * std::cos(elevation)),
                                     static_cast<float>(std::sin(elevation))});
        light.gain = Rgb(static_cast<float>(std::exp(log_gain(i))));
        lights.push_back(light);
    }
    return lights;
}

struct HeldOut {
    std::vector<Light> fitted, held_out;
    std::vector<int> before;
    explicit HeldOut(const std::vector<Light>& all) {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (i % 8 == 4) {
                before.push_back(static_cast<int>(fitted.size()));
                held_out.push_back(all[i]);
            } else {
                fitted.push_back(all[i]);
            }
    }
    // rms of ln gain, by order and by direction alone
    std::pair<double, double> errors() const {
        const LightModel model = fit_light_model(fitted);
        const ShotOrder order = fit_shot_order(model, fitted);
        double by_order = 0, by_direction = 0;
        for (std::size_t k = 0; k < held_out.size(); ++k) {
            const Light& light = held_out[k];
            const auto square = [&](double gain) { return std::pow(std::log(gain / light.gain.g), 2); };
            by_order += square(predicted_gain(order, model, fitted, light.direction, before[k]));
            by_direction += square(predicted_gain(model, fitted, light.direction));
        }
        const double n = static_cast<double>(held_out.size());
        return {std::sqrt(by_order / n), std::sqrt(by_direction / n)};
    }
};

TEST(ShotOrder, FollowsALampThatDrifts) {
    double drift = 0;
    Random random(4);
    std::vector<double> drifts;
    for (int i = 0; i < 72; ++i) drifts.push_back(drift = 0.8 * drift + 0.15 * random.normal());
    const auto [by_order, by_direction] =
        HeldOut(arcs(72, [&](int i) { return drifts[static_cast<std::size_t>(i)]; })).errors();
    EXPECT_LT(by_order, 0.75 * by_direction);
}

TEST(ShotOrder, SaysNothingWhereLightsOfADomeDifferAtRandom) {
    Random random(5);
    std::vector<double> gains;
    for (int i = 0; i < 72; ++i) gains.push_back(0.1 * random.normal());
    const HeldOut stack(arcs(72, [&](int i) { return gains[static_cast<std::size_t>(i)]; }));
    const auto [by_order, by_direction] = stack.errors();
    EXPECT_LT(by_order, 1.2 * by_direction);
}

TEST(ShotOrder, OfEqualLightsPredictsTheSame) {
    const std::vector<Light> lights = arcs(40, [](int) { return 0.3; });
    const LightModel model = fit_light_model(lights);
    const ShotOrder order = fit_shot_order(model, lights);
    EXPECT_NEAR(std::log(predicted_gain(order, model, lights, {0, 0, 1}, 7)), 0.3, 1e-3);
}

}  // namespace
}  // namespace tangi
