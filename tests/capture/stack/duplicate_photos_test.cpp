// duplicate_photos_test.cpp: pictures that are in a stack twice are found by their pixels.
#include "capture/stack/duplicate_photos.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

struct Copied {
    TestDir dir;
    std::vector<Light> lights = dome_lights(9);

    // Photograph `to` becomes that of `from`.
    explicit Copied(const std::vector<std::pair<int, int>>& copies) {
        write_test_stack(dir, lights, 20, 16);
        for (const auto& [from, to] : copies)
            fs::copy_file(dir / lights[static_cast<std::size_t>(from)].name,
                          dir / lights[static_cast<std::size_t>(to)].name,
                          fs::copy_options::overwrite_existing);
    }
};

TEST(StrayPhotos, SamePicturesAreFound) {
    const Copied stack({{1, 5}, {2, 3}, {2, 8}});
    EXPECT_THAT(same_pictures(survey(open_stack(stack.dir.path()))),
                ElementsAre(ElementsAre(1, 5), ElementsAre(2, 3, 8)));
    EXPECT_THAT(same_pictures(survey(open_stack(Copied({}).dir.path()))), IsEmpty());
}

TEST(StrayPhotos, PicturesOfOneValueAreNoCopies) {
    const Copied stack({});
    for (const int i : {0, 4})
        write_picture_8bit(stack.dir / stack.lights[static_cast<std::size_t>(i)].name,
                           Image<Rgb>(20, 16, Rgb(1)));
    EXPECT_THAT(same_pictures(survey(open_stack(stack.dir.path()))), IsEmpty());
}

TEST(StrayPhotos, CopiesUnderAnotherLightAreAllLeftOut) {
    const Copied copied({{1, 5}});
    Stack stack = open_stack(copied.dir.path());
    Survey surveyed = survey(stack);
    const std::vector<float> last(surveyed.sample(0) + 8 * 3, surveyed.sample(0) + 9 * 3);
    std::vector<RejectedPhoto> rejected;
    leave_out_copies(stack, surveyed, rejected);
    ASSERT_EQ(stack.photos.size(), 7u);
    ASSERT_EQ(surveyed.photos.size(), 7u);
    EXPECT_EQ(std::vector<float>(surveyed.sample(0) + 6 * 3, surveyed.sample(0) + 7 * 3), last);
    ASSERT_EQ(rejected.size(), 2u);
    EXPECT_EQ(rejected[0].name, "photo_001.png");
    EXPECT_EQ(rejected[1].name, "photo_005.png");
    EXPECT_THAT(stack.warnings, ElementsAre(testing::AllOf(HasSubstr("photo_001.png, photo_005.png"),
                                                           HasSubstr("degrees apart"))));
}

TEST(StrayPhotos, ACopyUnderTheSameLightIsUsedOnce) {
    Copied copied({{1, 5}});
    copied.lights[5].direction = copied.lights[1].direction;
    write_lights(copied.dir / "lights.lp", copied.lights);
    Stack stack = open_stack(copied.dir.path());
    Survey surveyed = survey(stack);
    std::vector<RejectedPhoto> rejected;
    leave_out_copies(stack, surveyed, rejected);
    ASSERT_EQ(rejected.size(), 1u);
    EXPECT_EQ(rejected[0].name, "photo_005.png");
    EXPECT_EQ(stack.photos.size(), 8u);
}

// Nine photographs, four of which are others once more, are five good ones.
TEST(StrayPhotos, CopiesUnderTheSameLightCostNothing) {
    Copied copied({{0, 5}, {1, 6}, {2, 7}, {3, 8}});
    for (const std::size_t i : {0u, 1u, 2u, 3u}) copied.lights[i + 5].direction = copied.lights[i].direction;
    write_lights(copied.dir / "lights.lp", copied.lights);
    Stack stack = open_stack(copied.dir.path());
    Survey surveyed = survey(stack);
    std::vector<RejectedPhoto> rejected;
    leave_out_copies(stack, surveyed, rejected);
    EXPECT_EQ(rejected.size(), 4u);
    EXPECT_EQ(stack.photos.size(), 5u);
    EXPECT_THAT(error_of([&] {
                    Stack again = open_stack(copied.dir.path());
                    Survey of_again = survey(again);
                    leave_out_copies(again, of_again, rejected, 6);
                }),
                HasSubstr("4 of 9 photographs are copies of others, which leaves 5; at least 6 are needed"));
}

TEST(StrayPhotos, AThirdOfCopiesIsAnError) {
    const auto message = [](const std::vector<std::pair<int, int>>& copies) {
        const Copied copied(copies);
        return error_of([&] {
            Stack stack = open_stack(copied.dir.path());
            Survey surveyed = survey(stack);
            std::vector<RejectedPhoto> rejected;
            leave_out_copies(stack, surveyed, rejected);
        });
    };
    EXPECT_THAT(message({{0, 1}, {0, 2}}), HasSubstr("3 of 9 photographs"));
    EXPECT_THAT(message({{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}, {0, 6}, {0, 7}, {0, 8}}),
                HasSubstr("all 9 photographs are the same picture"));
}

}  // namespace
}  // namespace tangi
