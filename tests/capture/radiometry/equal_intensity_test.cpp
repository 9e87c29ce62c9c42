// equal_intensity_test.cpp: lights of equal strength over a glossy surface are told from their levels.
#include "capture/radiometry/equal_intensity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "surface/base/noise.h"
#include "surface/reflectance/ward.h"

namespace tangi {
namespace {

// Of a surface with a slope towards the light: matt reflection of 1, and the lobe.
double brightness(double m, double slope, double gloss, double width) {
    const glm::dvec3 l = glm::normalize(glm::dvec3(m, 0, 1)), v(0, 0, 1);
    const auto lobe = [&](const glm::dvec3& n, const glm::dvec3& to_light) {
        const glm::dvec3 h = to_light + v;
        return ward_lobe(WardModel::bounded,
                         WardAngles<double>{.n_l = glm::dot(n, to_light),
                                            .n_v = glm::dot(n, v),
                                            .h_n = glm::dot(h, n),
                                            .h_h = glm::dot(h, h)},
                         width);
    };
    const glm::dvec3 n = glm::normalize(glm::dvec3(slope, 0, 1));
    return glm::dot(n, l) * (1 + gloss * lobe(n, l) / lobe(v, v));
}

TEST(FlatShading, IsThatOfAWardLobeAndHowItGrowsWithASlope) {
    for (const double gloss : {0.0, 0.1, 0.6})
        for (const double width : {0.15, 0.3})
            for (const double m : {0.1, 0.5, 1.0, 3.0}) {
                const FlatShading<double> flat = flat_shading(m, gloss, width);
                const double step = 1e-5, level = brightness(m, 0, gloss, width);
                EXPECT_NEAR(flat.level, level, 1e-9);
                const double grows =
                    (brightness(m, step, gloss, width) - brightness(m, -step, gloss, width)) / (2 * step);
                EXPECT_NEAR(flat.response, grows / level, 1e-6 * (1 + flat.response)) << gloss << " " << m;
            }
}

struct Lights {
    Eigen::MatrixXd t, right;
    Eigen::VectorXd log_level;
    // All around, 15 to 78 degrees high, equally strong but for `scatter` [1, ln].
    Lights(double gloss, double width, double scatter) : t(40, 2), right(40, 2), log_level(40) {
        Eigen::Matrix2d unknown;
        unknown << 0.8, 0.3, 0, 1.3;
        for (int j = 0; j < 40; ++j) {
            const double azimuth = 2.4 * j, elevation = (15 + 63.0 * j / 39) * std::numbers::pi / 180;
            const double m = 1 / std::tan(elevation);
            const Eigen::Vector2d to(std::cos(azimuth), std::sin(azimuth));
            const FlatShading<double> flat = flat_shading(m, gloss, width);
            t.row(j) = m * to.transpose();
            right.row(j) = (unknown * to * flat.response).transpose();
            const double noise = procedural::uniform(procedural::hash(procedural::Seed{1}, j, 0)) - 0.5;
            log_level[j] = std::log(0.4 * flat.level) + std::sqrt(12.0) * scatter * noise;
        }
    }
    // [deg] mean error of the elevations: azimuths are known but for a rotation.
    double error_deg(const EqualStrength& found) const {
        double sum = 0;
        for (int j = 0; j < 40; ++j)
            sum += std::abs(std::atan(found.t.row(j).norm()) - std::atan(t.row(j).norm()));
        return sum / 40 * 180 / std::numbers::pi;
    }
};

TEST(EqualStrength, TellsElevationsOfLightsOverAMattSurface) {
    const Lights lights(0, 0.3, 0.01);
    for (const bool glossy : {false, true}) {
        const EqualStrength found = by_equal_strength(lights.right, lights.log_level, glossy);
        EXPECT_LT(lights.error_deg(found), 1) << glossy;
        EXPECT_LT(found.gloss, 0.03);
        EXPECT_LT(found.log_strengths.norm() / std::sqrt(40.0), 0.02);
    }
}

TEST(EqualStrength, TellsGlossFromElevation) {
    const Lights lights(0.3, 0.25, 0.01);
    const EqualStrength glossy = by_equal_strength(lights.right, lights.log_level, true),
                        matt = by_equal_strength(lights.right, lights.log_level, false);
    EXPECT_LT(lights.error_deg(glossy), 1.5);
    EXPECT_NEAR(glossy.gloss, 0.3, 0.06);
    EXPECT_EQ(matt.gloss, 0);
    EXPECT_GT(lights.error_deg(matt), 5);  // gloss looks like lights that are too low
}

}  // namespace
}  // namespace tangi
