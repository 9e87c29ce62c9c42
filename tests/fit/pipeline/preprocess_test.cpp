// preprocess_test.cpp: what is left out of photographs before anything is made of them.
#include "fit/pipeline/preprocess.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Calibration knows no lights yet, and may do with one photograph.
TEST(Preprocessed, LeavesBlackPhotographsOutBeforeLightsAreKnown) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4));
    write_picture_8bit(dir / "photo_000.png", Image<Rgb>(8, 6, Rgb(0)));
    Stack stack = open_stack(dir.path());
    for (StackPhoto& photo : stack.photos) photo.light.direction = {0, 0, 1};
    const std::vector<RejectedPhoto> rejected = leave_out_damaged_and_copies(stack, {});
    ASSERT_EQ(rejected.size(), 1u);
    EXPECT_EQ(rejected[0].name, "photo_000.png");
    EXPECT_THAT(rejected[0].reason, testing::HasSubstr("black"));
    EXPECT_EQ(stack.photos.size(), 3u);
    for (int i = 1; i < 4; ++i)
        write_picture_8bit(dir / fmt::format("photo_{:03}.png", i), Image<Rgb>(8, 6, Rgb(0)));
    Stack black = open_stack(dir.path());
    EXPECT_THAT(error_of([&] { leave_out_damaged_and_copies(black, {}); }),
                testing::HasSubstr("all 4 photographs are black"));
}

}  // namespace
}  // namespace tangi
