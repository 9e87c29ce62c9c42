// options_test.cpp: one list of fields gives validation messages and JSON.
#include "surface/base/options.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

struct TestOptions {
    int steps = 10;
    double size_mm = 0.5;
    std::optional<double> scale{};
    bool fast = false;

    static constexpr std::string_view name = "test";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"steps", 1, 100, "1", "how many"}, self.steps);
        visit(FieldInfo{"size_mm", 0.25, 2, "mm", "how large"}, self.size_mm);
        visit(FieldInfo{"scale", 1, 3, "1", "how far"}, self.scale);
        visit(FieldInfo{"fast", 0, 0, "", "how quick"}, self.fast);
    }
};

TEST(Options, WithinTheirIntervalsAreValid) {
    EXPECT_NO_THROW(validate(TestOptions{}));
    EXPECT_NO_THROW(validate(TestOptions{.steps = 1, .size_mm = 0.25, .scale = 1.0, .fast = true}));
    EXPECT_NO_THROW(validate(TestOptions{.steps = 100, .size_mm = 2, .scale = 3.0, .fast = true}));
}

TEST(Options, OutsideTheirIntervalsAreNamedWithValueBoundsAndUnit) {
    EXPECT_EQ(error_of([] { validate(TestOptions{.steps = 0}); }), "test.steps = 0 is outside [1, 100]");
    EXPECT_EQ(error_of([] { validate(TestOptions{.steps = 101}); }), "test.steps = 101 is outside [1, 100]");
    EXPECT_EQ(error_of([] { validate(TestOptions{.size_mm = 2.5}); }),
              "test.size_mm = 2.5 is outside [0.25, 2] mm");
    EXPECT_EQ(error_of([] { validate(TestOptions{.scale = 0.5}); }), "test.scale = 0.5 is outside [1, 3]");
}

TEST(Options, OfNanAreOutsideEveryInterval) {
    EXPECT_EQ(error_of([] { validate(TestOptions{.size_mm = std::nan("")}); }),
              "test.size_mm = nan is outside [0.25, 2] mm");
    EXPECT_EQ(error_of([] { validate(TestOptions{.scale = std::nan("")}); }),
              "test.scale = nan is outside [1, 3]");
    EXPECT_EQ(error_of([] { validate(TestOptions{.size_mm = INFINITY}); }),
              "test.size_mm = inf is outside [0.25, 2] mm");
}

TEST(Options, OfWhichSeveralAreWrongNameTheFirst) {
    EXPECT_EQ(error_of([] { validate(TestOptions{.steps = -1, .size_mm = -1}); }),
              "test.steps = -1 is outside [1, 100]");
}

TEST(Options, BecomeJsonFieldByField) {
    const nlohmann::json written = to_json(TestOptions{.steps = 7, .scale = 1.5, .fast = true});
    EXPECT_EQ(written.dump(), R"({"fast":true,"scale":1.5,"size_mm":0.5,"steps":7})");
    EXPECT_TRUE(to_json(TestOptions{})["scale"].is_null());
}

}  // namespace
}  // namespace tangi
