// paint_layer_test.cpp: sparse tiles that are copied on write.
#include "paint/canvas/paint_layer.h"

#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

PaintTile tile_of(IngredientId id, float mm) {
    PaintTile tile;
    tile.ingredients = {id};
    tile.thickness_mm.assign(PaintTile::kPixels, mm);
    return tile;
}

TEST(PaintLayer, AnUntouchedLayerOf16kTakesLittleMemory) {
    const PaintLayer layer(16384, 16384);
    EXPECT_LT(layer.bytes(), 50u << 20);
    EXPECT_TRUE(layer.empty());
    EXPECT_EQ(layer.thickness_mm(16383, 16383), 0);
    EXPECT_EQ(layer.columns(), 256);
}

TEST(PaintLayer, CopiesShareTilesUntilOneIsWritten) {
    PaintLayer a(200, 100);
    a.set_tile({1, 1}, std::make_shared<PaintTile>(tile_of(3, 0.5f)));
    PaintLayer b = a;
    EXPECT_EQ(a.tile({1, 1}), b.tile({1, 1}));
    EXPECT_TRUE(identical(a, b));
    b.writable({1, 1}).thickness_mm[0] = 2;
    EXPECT_EQ(a.thickness_mm(64, 64), 0.5f);
    EXPECT_EQ(b.thickness_mm(64, 64), 2);
    EXPECT_FALSE(identical(a, b));
    const PaintTile* mine = &b.writable({1, 1});
    EXPECT_EQ(mine, &b.writable({1, 1}));  // nobody else holds it: no further copy
}

TEST(PaintLayer, TilesAtTheBorderAreCutOff) {
    const PaintLayer layer(200, 100);
    EXPECT_EQ(layer.region_of({3, 1}), (Region{192, 64, 200, 100}));
    EXPECT_THROW(layer.thickness_mm(200, 0), ContractError);
}

TEST(PaintLayer, VolumesAreThicknessTimesArea) {
    PaintLayer layer(128, 64);
    layer.set_tile({0, 0}, std::make_shared<PaintTile>(tile_of(1, 0.25f)));
    const auto volumes = volumes_mm3(layer, 3, 0.5);
    EXPECT_DOUBLE_EQ(volumes[0], 0);
    EXPECT_DOUBLE_EQ(volumes[1], 64 * 64 * 0.25 * 0.25);
    EXPECT_EQ(layer.thickness_mm(5, 5, 1), 0.25f);
    EXPECT_EQ(layer.thickness_mm(5, 5, 2), 0);
}

TEST(PaintLayer, AnIngredientThatIsNowhereIsAsNone) {
    PaintLayer a(64, 64), b(64, 64);
    a.set_tile({0, 0}, std::make_shared<PaintTile>(tile_of(1, 0)));
    EXPECT_TRUE(identical(a, b));
    b.set_tile({0, 0}, std::make_shared<PaintTile>(tile_of(2, 1e-9f)));
    EXPECT_FALSE(identical(a, b));
}

}  // namespace
}  // namespace tangi
