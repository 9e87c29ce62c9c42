// brush_shape_test.cpp: laws of the table of brush shapes, which a new row must keep.
#include "paint/brush/brush_shape.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

#include "paint/brush/brush_settings.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(BrushShape, NamesReadBack) {
    std::set<std::string> names;
    for (const BrushShapeTraits& traits : kBrushShapes) {
        EXPECT_EQ(brush_shape_named(traits.name), traits.shape) << traits.name;
        EXPECT_TRUE(names.insert(traits.name).second) << traits.name;
        const BrushSettings settings = brush_from_json({{"shape", traits.name}}, "test");
        EXPECT_EQ(settings.shape, traits.shape) << traits.name;
        EXPECT_EQ(brush_to_json(settings)["shape"], traits.name);
    }
    EXPECT_EQ(brush_shape_named("square"), std::nullopt);
    EXPECT_EQ(error_of([] {
                  brush_from_json({{"shape", 3}}, "here");
              }),
              "here: 'shape' is 3, not one of " + brush_shape_names());
}

TEST(BrushShape, TipsEndWithinTwiceTheirExtents) {
    for (const BrushShapeTraits& traits : kBrushShapes)
        for (int degrees = 0; degrees < 360; degrees += 5) {
            const double angle = degrees * std::numbers::pi / 180;
            const auto u = static_cast<float>(std::cos(angle)), v = static_cast<float>(std::sin(angle));
            EXPECT_GT(traits.dome(2 * u, 2 * v, 5), 1) << traits.name << " " << degrees;
            EXPECT_LT(traits.dome(0.3f * u, 0.3f * v, 5), 1) << traits.name << " " << degrees;
            EXPECT_EQ(traits.dome(u, v, 5), traits.dome(u, v, 5)) << traits.name;
            if (traits.elliptic) {
                EXPECT_NEAR(traits.dome(u, v, 5), 1, 1e-6) << traits.name << " " << degrees;
            }
        }
}

}  // namespace
}  // namespace tangi
