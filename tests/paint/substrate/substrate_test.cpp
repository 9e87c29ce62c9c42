// substrate_test.cpp: supports are seamless, level, in mm, and made of what they say.
#include "paint/substrate/substrate.h"

#include <gmock/gmock.h>

#include "surface/base/parallel.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

constexpr SubstrateKind kKinds[] = {SubstrateKind::canvas, SubstrateKind::linen, SubstrateKind::burlap,
                                    SubstrateKind::panel,  SubstrateKind::gesso, SubstrateKind::paper};

SubstrateOptions small() {
    SubstrateOptions options;
    options.width_mm = 24;
    options.height_mm = 18;
    options.pixel_mm = 0.15;
    return options;
}

// Root mean square of the step from a column to the next, and from a row to the next.
double step(const Surface& s, int from, int to) {
    double sum = 0;
    for (int y = 0; y < s.height(); ++y) sum += std::pow(s.height_mm(to, y) - s.height_mm(from, y), 2);
    return std::sqrt(sum / s.height());
}
double step_down(const Surface& s, int from, int to) {
    double sum = 0;
    for (int x = 0; x < s.width(); ++x) sum += std::pow(s.height_mm(x, to) - s.height_mm(x, from), 2);
    return std::sqrt(sum / s.width());
}

TEST(Substrate, BordersMatchLikeAnyTwoColumnsAndRows) {
    SubstrateOptions large;  // several of the widest features
    large.width_mm = 180;
    large.height_mm = 130;
    large.pixel_mm = 0.4;
    for (const SubstrateOptions& options : {small(), large})
        for (const SubstrateKind kind : kKinds) {
            const Surface s = make_substrate(kind, options);
            double largest = 0, largest_down = 0;
            for (int x = 0; x + 1 < s.width(); ++x) largest = std::max(largest, step(s, x, x + 1));
            for (int y = 0; y + 1 < s.height(); ++y)
                largest_down = std::max(largest_down, step_down(s, y, y + 1));
            EXPECT_LE(step(s, s.width() - 1, 0), 1.05 * largest) << name_of(kind) << " " << options.width_mm;
            EXPECT_LE(step_down(s, s.height() - 1, 0), 1.05 * largest_down)
                << name_of(kind) << " " << options.height_mm;
            EXPECT_GT(largest, 0) << name_of(kind);
        }
}

TEST(Substrate, CanBeRelitAndIsLevel) {
    for (const SubstrateKind kind : kKinds) {
        const Surface s = make_substrate(kind, small());
        require_consistent(s);
        EXPECT_EQ(s.width(), 160) << name_of(kind);
        EXPECT_TRUE(s.scale_known);
        double sum = 0, squares = 0;
        for (const float z : s.height_mm.pixels()) sum += z, squares += z * z;
        const double rms = std::sqrt(squares / static_cast<double>(s.height_mm.size()));
        EXPECT_NEAR(sum / static_cast<double>(s.height_mm.size()), 0, 1e-5) << name_of(kind);
        EXPECT_GT(rms, 0.003) << name_of(kind);
        EXPECT_LT(rms, 0.4) << name_of(kind);
        for (const Rgb& c : s.diffuse.pixels()) {
            ASSERT_GE(std::min({c.r, c.g, c.b}), 0) << name_of(kind);
            ASSERT_LE(std::max({c.r, c.g, c.b}), 1) << name_of(kind);
        }
    }
}

TEST(Substrate, ThreadsRepeatAtTheirPitch) {
    SubstrateOptions options = small();
    options.width_mm = 68;  // 100 threads of 0.68 mm
    const Surface s = make_substrate(SubstrateKind::linen, options);
    // Plain weave is alike two threads on, and opposite one thread on.
    const auto correlation = [&](double shift_mm) {
        const int shift = static_cast<int>(std::lround(shift_mm / options.pixel_mm));
        double both = 0, own = 0;
        for (int y = 0; y < s.height(); ++y)
            for (int x = 0; x + shift < s.width(); ++x) {
                both += s.height_mm(x, y) * s.height_mm(x + shift, y);
                own += s.height_mm(x, y) * s.height_mm(x, y);
            }
        return both / own;
    };
    EXPECT_GT(correlation(2 * 0.68), 0.15);
    EXPECT_GT(correlation(2 * 0.68), correlation(0.68) + 0.1);
}

TEST(Substrate, HasNoSpikesThatCastShadowsOfOnePixel) {
    // Part of the pixels that lie in shadow with hardly any neighbour, in light from 18 degrees.
    const auto lone = [](SubstrateKind kind) {
        SubstrateOptions options = small();
        options.pixel_mm = 0.1;
        const Surface s = make_substrate(kind, options);
        const Image<float> lit = visibility(s, distant_light({-1, 0.4f, 0.35f}), 0.25);
        int count = 0;
        for (int y = 1; y + 1 < s.height(); ++y)
            for (int x = 1; x + 1 < s.width(); ++x) {
                if (lit(x, y) >= 0.2f) continue;
                int dark = 0;
                for (int k = 0; k < 9; ++k) dark += lit(x + k % 3 - 1, y + k / 3 - 1) < 0.5f;
                count += dark <= 2;
            }
        return static_cast<double>(count) / static_cast<double>(s.height_mm.size());
    };
    EXPECT_LT(lone(SubstrateKind::linen), 0.006);
    EXPECT_LT(lone(SubstrateKind::canvas), 0.001);
    for (const SubstrateKind kind : {SubstrateKind::panel, SubstrateKind::gesso, SubstrateKind::paper})
        EXPECT_EQ(lone(kind), 0) << name_of(kind);
}

TEST(Substrate, ReliefIsThatOfTheRealThing) {
    // Root mean square [mm] of the relief without what is broader than 5 mm.
    const auto roughness = [](SubstrateKind kind) {
        SubstrateOptions options = small();
        options.width_mm = options.height_mm = 40;
        const Surface s = make_substrate(kind, options);
        const int half = static_cast<int>(2.5 / options.pixel_mm);
        double squares = 0, count = 0;
        for (int y = half; y + half < s.height(); y += 3)
            for (int x = half; x + half < s.width(); x += 3) {
                double mean = 0, n = 0;
                for (int j = -half; j <= half; j += 2)
                    for (int i = -half; i <= half; i += 2) mean += s.height_mm(x + i, y + j), ++n;
                squares += std::pow(s.height_mm(x, y) - mean / n, 2);
                ++count;
            }
        return std::sqrt(squares / count);
    };
    const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
    EXPECT_TRUE(within(roughness(SubstrateKind::gesso), 0.001, 0.008)) << roughness(SubstrateKind::gesso);
    EXPECT_TRUE(within(roughness(SubstrateKind::paper), 0.003, 0.012)) << roughness(SubstrateKind::paper);
    EXPECT_TRUE(within(roughness(SubstrateKind::panel), 0.003, 0.015)) << roughness(SubstrateKind::panel);
    EXPECT_TRUE(within(roughness(SubstrateKind::canvas), 0.01, 0.03)) << roughness(SubstrateKind::canvas);
    EXPECT_TRUE(within(roughness(SubstrateKind::linen), 0.015, 0.04)) << roughness(SubstrateKind::linen);
    EXPECT_TRUE(within(roughness(SubstrateKind::burlap), 0.06, 0.2)) << roughness(SubstrateKind::burlap);
}

TEST(Substrate, IsTheSameOnAnyNumberOfThreadsAndDiffersBySeed) {
    SubstrateOptions options = small();
    set_thread_count(1);
    const Surface one = make_substrate(SubstrateKind::burlap, options);
    set_thread_count(3);
    const Surface three = make_substrate(SubstrateKind::burlap, options);
    set_thread_count(0);
    options.seed = 2;
    const Surface other = make_substrate(SubstrateKind::burlap, options);
    EXPECT_TRUE(images_identical(one.height_mm, three.height_mm));
    EXPECT_TRUE(images_identical(one.diffuse, three.diffuse));
    EXPECT_FALSE(images_identical(one.height_mm, other.height_mm));
}

TEST(Substrate, RefusesSizesThatCannotBe) {
    SubstrateOptions options = small();
    options.pixel_mm = 10;
    EXPECT_THAT(error_of([&] { make_substrate(SubstrateKind::linen, options); }), HasSubstr("2 x 2 pixels"));
    options.pixel_mm = -1;
    EXPECT_THAT(error_of([&] { make_substrate(SubstrateKind::linen, options); }), HasSubstr("pixel_mm"));
    EXPECT_FALSE(substrate_named("silk"));
    for (const std::string& name : substrate_names()) EXPECT_EQ(name_of(*substrate_named(name)), name);
}

}  // namespace
}  // namespace tangi
