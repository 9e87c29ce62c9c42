// shadow_sets_test.cpp: cast shadows (surface/render/shadow_march.h) with every instruction set that they are
// compiled for.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "surface/render/cast_shadows.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

class ShadowSets : public OnInstructionSet {};
INSTANTIATE_TEST_SUITE_P(Sets, ShadowSets, every_instruction_set(), name_of_set);

// Ridges of all sizes, under far and near lights.
TEST_P(ShadowSets, AreThoseOfSinglePixels) {
    Random random(4);
    constexpr int kWidth = 210, kHeight = 120;
    Image<float> z(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            z(x, y) = static_cast<float>(2 * std::sin(0.3 * x + 0.1 * y) +
                                         6 * std::sin(0.05 * y) * std::cos(0.07 * x));
    const CastShadows shadows(z, 1, 0.5);
    int partly = 0, dark = 0;
    for (int i = 0; i < 4000; ++i) {
        const int x0 = random.below(kWidth), y = random.below(kHeight);
        const float distance = i % 2 ? 1e6f : 150.0f;
        const Vec3 light = distance * glm::normalize(Vec3(random.uniform(-1, 1), random.uniform(-1, 1),
                                                          random.uniform(0.02, 0.5)));
        std::array<std::array<float, kMarchLanes>, 3> l;
        std::array<float, kMarchLanes> parts;
        std::array<Vec3, kMarchLanes> direction;
        for (std::size_t lane = 0; lane < kMarchLanes; ++lane) {
            direction[lane] = glm::normalize(light - Vec3(lane, 0, 0));
            for (std::size_t k = 0; k < 3; ++k) l[k][lane] = direction[lane][static_cast<int>(k)];
        }
        shadows.visible_parts(x0, y, {l[0].data(), l[1].data(), l[2].data()}, 0xffff, parts.data());
        for (int lane = 0; lane < kMarchLanes; ++lane) {
            const auto at = static_cast<std::size_t>(lane);
            if (x0 + lane >= kWidth) {
                ASSERT_EQ(parts[at], 1);
                continue;
            }
            const float single = shadows.visible_part(x0 + lane, y, direction[at]);
            ASSERT_NEAR(parts[at], single, 2e-3) << x0 << " + " << lane << ", " << y;
            partly += single > 0 && single < 1;
            dark += single == 0;
        }
    }
    EXPECT_GT(partly, 1000);
    EXPECT_GT(dark, 1000);
}

}  // namespace
}  // namespace tangi
