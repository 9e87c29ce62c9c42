// gaussian_process_test.cpp: a smooth function over directions.
#include "surface/maps/gaussian_process.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec3;

struct Known {
    std::vector<dvec3> directions;
    std::vector<double> values;

    template <class Value>
    Known(int count, Value&& value) {
        for (const Light& light : dome_lights(count)) {
            directions.emplace_back(light.direction);
            values.push_back(value(directions.back()));
        }
    }
    double at(const dvec3& direction) const {
        return predicted(fit_gaussian_process(directions, values), directions, direction);
    }
    // rms of what is predicted elsewhere
    template <class Value>
    double error(Value&& value) const {
        const GaussianProcess process = fit_gaussian_process(directions, values);
        Random random(7);
        double squares = 0;
        constexpr int looks = 200;
        for (int i = 0; i < looks; ++i) {
            const dvec3 d(random.direction(0.3));
            squares += std::pow(predicted(process, directions, d) - value(d), 2) / looks;
        }
        return std::sqrt(squares);
    }
};

double smooth(const dvec3& d) { return 0.4 * d.x - 0.3 * d.x * d.y + 0.2 * std::sin(3 * d.y); }

TEST(GaussianProcess, IsThroughWhatIsSmooth) {
    const Known known(40, smooth);
    EXPECT_LT(known.error(smooth), 0.01);
    for (std::size_t i = 0; i < known.values.size(); ++i)
        EXPECT_NEAR(known.at(known.directions[i]), known.values[i], 0.01);
}

TEST(GaussianProcess, HasTheUnitAndTheMeanOfItsValues) {
    const Known once(30, smooth), twice(30, [](const dvec3&d) { return 5 + 100 * smooth(d); });
    const dvec3 between = glm::normalize(dvec3(0.3, -0.2, 0.8));
    EXPECT_NEAR(twice.at(between), 5 + 100 * once.at(between), 0.05);
}

// A frame of other axes is no other function.
TEST(GaussianProcess, TurnsWithTheDirections) {
    Known known(30, smooth);
    const dvec3 between = glm::normalize(dvec3(0.3, -0.2, 0.8));
    const double before = known.at(between);
    for (dvec3& d : known.directions) d = {-d.y, d.x, d.z};
    EXPECT_NEAR(known.at({-between.y, between.x, between.z}), before, 1e-9);
}

TEST(GaussianProcess, AveragesNoiseAway) {
    Random random(3);
    constexpr double sigma = 0.1;
    const Known known(100, [&](const dvec3& d) { return smooth(d) + sigma * random.normal(); });
    EXPECT_LT(known.error(smooth), 0.5 * sigma);
}

TEST(GaussianProcess, IsNotBentByOneValueThatIsFarOff) {
    int index = 0;
    const Known known(40, [&](const dvec3& d) { return smooth(d) + (index++ == 11 ? 2 : 0); });
    EXPECT_LT(known.error(smooth), 0.03);
    EXPECT_NEAR(known.at(known.directions[11]), smooth(known.directions[11]), 0.05);
}

TEST(GaussianProcess, OfEqualFewAndNoValues) {
    EXPECT_NEAR(Known(20, [](const dvec3&) { return 0.7; }).at({0, 0, 1}), 0.7, 1e-6);
    EXPECT_EQ(fit_gaussian_process({}, {}), GaussianProcess());
    const std::vector<dvec3> one = {{0, 0, 1}}, two = {{0, 0, 1}, {1, 0, 0}};
    EXPECT_EQ(predicted(fit_gaussian_process(one, std::vector{2.5}), one, {1, 0, 0}), 2.5);
    const double between =
        predicted(fit_gaussian_process(two, std::vector{1.0, 2.0}), two, glm::normalize(dvec3(1, 0, 1)));
    EXPECT_NEAR(between, 1.5, 1e-9);
}

// The same direction twice: both values count alike.
TEST(GaussianProcess, TakesDirectionsThatComeTwice) {
    Known known(20, smooth);
    known.directions.push_back(known.directions[3]);
    known.values.push_back(known.values[3] + 0.02);
    EXPECT_NEAR(known.at(known.directions[3]), known.values[3] + 0.01, 0.015);
}

}  // namespace
}  // namespace tangi
