// stack_sizes_test.cpp: photographs as large as cameras make them, and none of them lost.
#include "tests/programs/support/stack_sizes.h"

namespace tangi {
namespace {

using testing::HasSubstr;

// Registration looks at 36 photographs of more than 0.7 megapixels in another way than at smaller ones, and
// at those that are held out, of which there are fewer, in the same.
TEST(CliStackSizes, LargerThanHalfAMegapixel) { expect_through_the_program(1040, 780, 36, "4:8", 4, 0.05); }

// Eight grazing lights around a camera that stands still: what shadows at edges feign goes with the light.
TEST(CliStackSizes, NineLights) { expect_through_the_program(500, 375, 9, "4", 1, 0.1); }

// Held-out photographs that show something else are told, and the number that they were to give is missed.
TEST(CliStackSizes, HeldOutPhotographsThatAreLostAreMissed) {
    const TinyStack stack({}, 128), other([](GeneratorOptions&options) { options.seed = 5; }, 128);
    const Image<Rgb> painting = read_picture(stack.photo(3));
    Image<Rgb> strange(painting.width(), painting.height());
    for (int y = 0; y < strange.height(); ++y)
        for (int x = 0; x < strange.width(); ++x)
            strange(x, y) = Rgb((x * 7 / 16 + y * 5 / 16) % 3 == 0 ? 0.6f : 0.1f);
    const auto fit = [&](const std::string& which) {
        return tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--hold-out", which});
    };
    write_picture(stack.photo(3), strange, {}, {.bits = 16});
    const Finished some = fit("3,8");
    EXPECT_TRUE(ended(some, 0, {"cannot be registered", stack.name(3)}));
    EXPECT_EQ(some.json()["photographs"]["held_out"], 1);
    const Finished none = fit("3");
    EXPECT_TRUE(ended(none, 3, {"cannot be registered", "--hold-out"}));
    EXPECT_EQ(none.json()["photographs"]["held_out"], 0);
    EXPECT_THAT(none.json()["poor"].dump(), HasSubstr("all 1 photographs of --hold-out"));
}

}  // namespace
}  // namespace tangi
