// large_stacks_test.cpp: photographs of 0.6 megapixels, many of them, and of 2 and 12.
#include "tests/programs/support/stack_sizes.h"

namespace tangi {
namespace {

// Between the sizes from which on all photographs, and those that are held out alone, are looked at reduced.
TEST(CliLargeStacks, ManyOfSixTenthsOfAMegapixel) { expect_through_the_program(900, 700, 48, "4:8", 6, 0.3); }
TEST(CliLargeStacks, TwoMegapixels) { expect_through_the_program(1600, 1250, 30, "3:6", 5, 0.3); }
TEST(CliLargeStacks, TwelveMegapixels) { expect_through_the_program(4000, 3000, 9, "4", 1, 0.1); }

}  // namespace
}  // namespace tangi
