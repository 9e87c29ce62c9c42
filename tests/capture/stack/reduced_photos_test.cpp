// reduced_photos_test.cpp: photographs reduced in memory are means of what is stored.
#include "capture/stack/reduced_photos.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kWidth = 13, kHeight = 8;

// A stack's bands of any height, with one value in question.
ReducedPhotos reduced(const Stack& stack, int rows, int reduction, float value = 0.5f) {
    ReducedPhotos photos(stack, reduction);
    StackReader reader(stack);
    for (int y = 0; y < kHeight; y += rows) {
        Band band = reader.read(y, std::min(y + rows, kHeight), Transfer{});
        if (band.y0() == 0) band.row(1, 0, 0)[4] = value;
        photos.add(band);
    }
    return photos;
}

TEST(ReducedPhotos, AreMeansOfBlocksWhateverTheBands) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), kWidth, kHeight);
    const Stack stack = open_stack(dir.path());
    const Band whole = StackReader(stack).read(0, kHeight, Transfer{});
    for (const int rows : {1, 3, 8}) {
        const ReducedPhotos photos = reduced(stack, rows, 3, whole.row(1, 0, 0)[4]);
        ASSERT_EQ(photos.width(), 5);
        ASSERT_EQ(photos.height(), 3);
        const Band band = photos.read(0, 3, Transfer{});
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c)
                for (int y = 0; y < 3; ++y)
                    for (int x = 0; x < 5; ++x) {
                        float sum = 0;
                        int count = 0;
                        for (int v = 3 * y; v < std::min(3 * y + 3, kHeight); ++v)
                            for (int u = 3 * x; u < std::min(3 * x + 3, kWidth); ++u, ++count)
                                sum += whole.row(i, c, v)[u];
                        const float mean = sum / static_cast<float>(count);
                        ASSERT_NEAR(band.row(i, c, y)[x], mean, 5e-4f * mean + 1e-7f);
                    }
    }
}

TEST(ReducedPhotos, AreClippedOrMissingWhereOneValueIs) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), kWidth, kHeight);
    const Stack stack = open_stack(dir.path());
    const Transfer srgb{Transfer::Kind::srgb};
    const Band clipped = reduced(stack, 4, 3, kClipped).read(0, 1, srgb);
    EXPECT_GE(clipped.row(1, 0, 0)[1], srgb.decode(kClipped));
    EXPECT_LT(clipped.row(1, 0, 0)[2], 0.5f);
    const Band missing = reduced(stack, 4, 3, std::numeric_limits<float>::quiet_NaN()).read(0, 1, srgb);
    EXPECT_TRUE(std::isnan(missing.row(1, 0, 0)[1]));
    EXPECT_FALSE(std::isnan(missing.row(1, 1, 0)[1]));
    EXPECT_FALSE(std::isnan(missing.row(1, 0, 0)[2]));
}

TEST(ReducedPhotos, AreOfAMegapixelAtMost) {
    EXPECT_EQ(ReducedPhotos::reduction_for(1000, 1000), 1);
    EXPECT_EQ(ReducedPhotos::reduction_for(1001, 1000), 2);
    EXPECT_EQ(ReducedPhotos::reduction_for(4085, 3109), 4);
}

TEST(ReducedPhotos, ForgetThoseThatAreNotKept) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), kWidth, kHeight);
    const Stack stack = open_stack(dir.path());
    ReducedPhotos photos = reduced(stack, 4, 2);
    const Band before = photos.read(0, 2, Transfer{});
    photos.keep({true, false, false, true});
    const Band after = photos.read(0, 2, Transfer{});
    EXPECT_EQ(after.photos(), 2);
    EXPECT_EQ(after.row(1, 0, 1)[3], before.row(3, 0, 1)[3]);
}

TEST(ReducedPhotos, AMaskKeepsBlocksOfWhichAnyIsKept) {
    Image<unsigned char> mask(5, 3, 0);
    mask(4, 2) = 1;
    const Image<unsigned char> small = reduced_mask(mask, 2);
    ASSERT_EQ(small.width(), 3);
    ASSERT_EQ(small.height(), 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) EXPECT_EQ(small(x, y), x == 2 && y == 1);
    EXPECT_TRUE(reduced_mask({}, 2).empty());
}

}  // namespace
}  // namespace tangi
