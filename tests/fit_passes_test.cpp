// fit_passes_test.cpp: what is said of photographs that differ from the model.
#include "fit/fit_passes.h"

#include <gtest/gtest.h>

namespace tangi {
namespace {

// "1.0 times what is expected" would say that nothing is wrong.
TEST(FitPasses, SayByHowMuchPhotographsDiffer) {
    EXPECT_EQ(beyond_expected(1.004), "1 % more than is expected (in the median)");
    EXPECT_EQ(beyond_expected(1.06), "6 % more than is expected (in the median)");
    EXPECT_EQ(beyond_expected(1.9), "90 % more than is expected (in the median)");
    EXPECT_EQ(beyond_expected(1.96), "2.0 times what is expected (in the median)");
    EXPECT_EQ(beyond_expected(2.34), "2.3 times what is expected (in the median)");
}

}  // namespace
}  // namespace tangi
