// damage_map_test.cpp: masks of damage as a picture over the painting.
#include "viewer/model/damage_map.h"

#include <gtest/gtest.h>

namespace tangi {
namespace {

TEST(DamageMap, ShowsWhatIsThereInItsColour) {
    DamageMap map(30, 20);
    Mask mask(30, 20);
    for (int y = 5; y < 15; ++y)
        for (int x = 5; x < 15; ++x) mask(x, y) = 1;
    map.set(DamageClass::stain, mask);
    DamageMap::Style style;
    map.compose(style);
    EXPECT_EQ(map.picture()(10, 10).a, 0) << "it is not shown";
    style.shown.fill(true);
    map.compose(style);
    EXPECT_EQ(map.picture()(10, 10).a, 255);
    EXPECT_EQ(map.picture()(20, 10).a, 0);
    EXPECT_NEAR(map.picture()(10, 10).r, 255 * legend_colour_srgb(DamageClass::stain).r, 1);
    style.style = MapStyle::outlined;
    map.compose(style);
    EXPECT_EQ(map.picture()(10, 10).a, 0);
    EXPECT_EQ(map.picture()(5, 10).a, 255);
    mask(20, 10) = 1;
    map.set(DamageClass::stain, mask, {20, 10, 21, 11});
    map.compose(style, {20, 10, 21, 11});
    EXPECT_EQ(map.picture()(20, 10).a, 255) << "a hair line is seen";
    // A coarser map of a large painting still has it.
    DamageMap coarse(9000, 10);
    Mask line(9000, 10);
    line(7000, 5) = 1;
    coarse.set(DamageClass::craquelure, line);
    style.style = MapStyle::filled;
    coarse.compose(style);
    EXPECT_EQ(coarse.reduced(), 3);
    EXPECT_EQ(coarse.picture()(7000 / 3, 5 / 3).a, 255);
}

}  // namespace
}  // namespace tangi
