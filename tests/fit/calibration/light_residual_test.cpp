// light_residual_test.cpp: the derivatives of the joint problem of pixels, lights and rig.
#include "fit/calibration/light_residual.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "fit/calibration/light_sample.h"
#include "surface/maps/light.h"
#include "surface/reflectance/oren_nayar.h"
#include "surface/reflectance/ward.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kBlocks = 5, kSizes[kBlocks] = {kJointPixel, 1, kJointRig, kJointTurn, kJointBeam};

struct Trial {
    double pixel[kJointPixel], gain[1], rig[kJointRig], turn[kJointTurn], beam[kJointBeam];
    JointSample sample;
};

Trial random_trial(Random& random) {
    return {{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), std::log(random.uniform(0.1, 0.6)),
             random.uniform(0, 0.5), random.uniform(0, 1)},
            {random.uniform(-1, 1)},
            {random.uniform(0, 0.8), random.uniform(0, 0.4), random.uniform(0, 0.8),
             random.uniform(-0.3, 0.3), random.uniform(0, 0.8), random.uniform(-0.2, 0.2)},
            {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)},
            {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
             random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)},
            {.direction = glm::dvec3(random.direction(0.2)),
             .nearer = random.uniform(0.7, 1.4),
             .position = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)},
             .camera_axis = {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)},
             .value = 0.3,
             .sigma = 0.02}};
}

double residual_of(const Trial& t) {
    const double* blocks[] = {t.pixel, t.gain, t.rig, t.turn, t.beam};
    double residual = 0;
    EXPECT_TRUE(JointResidual(t.sample).Evaluate(blocks, &residual, nullptr));
    return residual;
}

TEST(JointResidual, DerivativesAreThoseOfCentralDifferences) {
    Random random(4);
    for (int trial = 0; trial < 500; ++trial) {
        Trial t = random_trial(random);
        double by_pixel[kJointPixel], by_gain[1], by_rig[kJointRig], by_turn[kJointTurn], by_beam[kJointBeam],
            residual = 0;
        double* jacobians[] = {by_pixel, by_gain, by_rig, by_turn, by_beam};
        double* blocks[] = {t.pixel, t.gain, t.rig, t.turn, t.beam};
        const JointResidual cost(t.sample);
        ASSERT_TRUE(cost.Evaluate(blocks, &residual, jacobians));
        EXPECT_EQ(residual, residual_of(t));
        for (int block = 0; block < kBlocks; ++block)
            for (int i = 0; i < kSizes[block]; ++i) {
                const double at = blocks[block][i], step = 1e-5;
                blocks[block][i] = at + step;
                const double above = residual_of(t);
                blocks[block][i] = at - step;
                const double below = residual_of(t);
                blocks[block][i] = at;
                const double found = jacobians[block][i], numeric = (above - below) / (2 * step);
                EXPECT_NEAR(found, numeric, 1e-5 * std::max(10.0, std::abs(numeric)))
                    << "trial " << trial << ", block " << block << ", parameter " << i;
            }
    }
}

// The relit picture and the calibration must mean the same by a rig.
TEST(JointResidual, IsWhatTheReferenceRendererShows) {
    Random random(5);
    constexpr double width_mm = 200;
    for (int trial = 0; trial < 200; ++trial) {
        const Trial t = random_trial(random);
        const Rig rig{.ambient = static_cast<float>(t.rig[1]),
                      .camera_distance_mm = static_cast<float>(width_mm / t.rig[2]),
                      .camera_axis_mm = glm::vec2(t.sample.camera_axis * width_mm),
                      .light_distance_mm = static_cast<float>(width_mm / (t.rig[0] * t.sample.nearer)),
                      .surface_above_mm = static_cast<float>(t.rig[5] * width_mm),
                      .bend_per_mm = static_cast<float>(t.rig[3] / width_mm)};
        Light light = distant_light(Vec3(turned(t.sample.direction, {t.turn[0], t.turn[1]})));
        light.gain = Rgb(static_cast<float>(std::exp(t.gain[0])));
        place(light, rig);
        light.beam = beam_of({t.beam[0], t.beam[1], t.beam[2], t.beam[3], t.beam[4]}, width_mm);
        const Vec3 point_mm(glm::vec2(t.sample.position) * static_cast<float>(width_mm), 0);
        const Incidence in = incidence(light, point_mm, rig);
        const Vec3 normal =
            glm::normalize(Vec3(-static_cast<float>(t.pixel[0]), -static_cast<float>(t.pixel[1]), 1));
        const WardAngles<float> a = ward_angles(normal, in.direction, view_direction(rig, point_mm));
        const double n_l = std::max(a.n_l, 0.0f);
        const double lobe = ward_lobe(WardModel::bounded, a, static_cast<float>(std::exp(t.pixel[2])));
        const double matt = n_l > 0 ? rough_diffuse<double>(n_l, a.n_v, a.h_h / 2 - 1, t.rig[4]).value : 0;
        const double shown =
            in.irradiance.g * (t.pixel[4] * (matt + t.rig[1]) + t.pixel[3] * std::numbers::pi * lobe * n_l);
        EXPECT_NEAR(residual_of(t) * 0.02 + 0.3, shown, 2e-4 * std::max(1.0, shown)) << "trial " << trial;
    }
}

}  // namespace
}  // namespace tangi
