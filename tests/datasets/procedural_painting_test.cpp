// procedural_painting_test.cpp: the truth is reproducible, consistent and like a painting.
#include "datasets/procedural_painting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using Mask = Image<unsigned char>;

constexpr PaintingOptions kSmall{.width = 144, .height = 128, .brush_width_mm = 3, .crack_distance_mm = 4};

bool same_bits(const PaintingTruth& a, const PaintingTruth& b) {
    return images_identical(a.height_mm, b.height_mm) && images_identical(a.normal, b.normal) &&
           images_identical(a.diffuse, b.diffuse) && images_identical(a.specular, b.specular) &&
           images_identical(a.roughness, b.roughness) && images_identical(a.loss, b.loss) &&
           images_identical(a.craquelure, b.craquelure) && images_identical(a.varnish, b.varnish) &&
           images_identical(a.retouch, b.retouch) && images_identical(a.valid, b.valid);
}

double part_of(const Mask& mask) {
    double sum = 0;
    for (const unsigned char value : mask.pixels()) sum += value;
    return sum / static_cast<double>(mask.size());
}

double mean_where(const Image<float>& map, const Mask& mask, bool inside) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < map.size(); ++i)
        if ((mask.pixels()[i] != 0) == inside) {
            sum += map.pixels()[i];
            ++count;
        }
    return sum / count;
}

TEST(ProceduralPainting, HasTheSameBitsOnOneThreadAndOnTwo) {
    set_thread_count(1);
    const PaintingTruth one = procedural_painting(kSmall);
    set_thread_count(2);
    const PaintingTruth two = procedural_painting(kSmall);
    set_thread_count(0);
    EXPECT_TRUE(same_bits(one, two));
}

TEST(ProceduralPainting, IsAnotherOneForAnotherSeed) {
    PaintingOptions other = kSmall;
    other.seed = 2;
    const PaintingTruth a = procedural_painting(kSmall), b = procedural_painting(other);
    EXPECT_FALSE(images_identical(a.height_mm, b.height_mm));
    EXPECT_FALSE(images_identical(a.diffuse, b.diffuse));
    EXPECT_FALSE(images_identical(a.loss, b.loss));
}

TEST(ProceduralPainting, HasTheCentralDifferencesOfItsHeightsAsNormalsWithoutSupersampling) {
    PaintingOptions options = kSmall;
    options.supersampling = 1;
    const PaintingTruth truth = procedural_painting(options);
    const Image<Vec3> expected = normals_of(truth.height_mm, truth.mm_per_pixel);
    for (int y = 1; y < truth.height() - 1; ++y)
        for (int x = 1; x < truth.width() - 1; ++x)
            ASSERT_LT(glm::length(truth.normal(x, y) - expected(x, y)), 1e-4f) << x << ", " << y;
}

// The mean slope of two neighbours is the slope of the height between them (trapezoidal rule) but for relief
// as fine as a pixel. The relief is continuous and the rule of second order, so that each halving of the
// pixels leaves at most half of that; damage has details too fine for so small a picture.
TEST(ProceduralPainting, HasNormalsThatIntegrateToItsHeight) {
    double error_before = 0;
    for (const int scale : {1, 2, 4}) {
        const PaintingTruth truth = procedural_painting({.width = 96 * scale,
                                                         .height = 64 * scale,
                                                         .mm_per_pixel = 0.12 / scale,
                                                         .brush_width_mm = 3,
                                                         .craquelure = 0,
                                                         .losses = false,
                                                         .varnish = false,
                                                         .retouch = false});
        double error2 = 0, step2 = 0;
        for (int y = 0; y + 1 < truth.height(); ++y)
            for (int x = 0; x + 1 < truth.width(); ++x) {
                const Slope here = slope_of(truth.normal(x, y)), right = slope_of(truth.normal(x + 1, y)),
                            down = slope_of(truth.normal(x, y + 1));
                const double dx = (truth.height_mm(x + 1, y) - truth.height_mm(x, y)) / truth.mm_per_pixel;
                const double dy = (truth.height_mm(x, y) - truth.height_mm(x, y + 1)) / truth.mm_per_pixel;
                error2 += std::pow((here.x + right.x) / 2 - dx, 2) + std::pow((here.y + down.y) / 2 - dy, 2);
                step2 += dx * dx + dy * dy;
            }
        const double error = std::sqrt(error2 / step2);
        if (scale == 1) {
            EXPECT_LT(error, 0.3);
        } else {
            EXPECT_LT(error, error_before / 2);
        }
        error_before = error;
    }
}

TEST(ProceduralPainting, IsAsSteepAsOilPaint) {
    const PaintingTruth truth = procedural_painting({.width = 192, .height = 192});
    double sum = 0, beyond_65 = 0;
    for (const Vec3& n : truth.normal.pixels()) {
        EXPECT_NEAR(glm::length(n), 1, 1e-5);
        const double angle = std::acos(std::min(n.z, 1.0f)) * 180 / std::numbers::pi;
        sum += angle;
        beyond_65 += angle > 65;
    }
    const double count = static_cast<double>(truth.normal.size());
    EXPECT_GT(sum / count, 5);
    EXPECT_LT(sum / count, 16);
    EXPECT_LT(beyond_65 / count, 2e-3);
}

TEST(ProceduralPainting, HasReflectancesThatOilPaintCanHave) {
    const PaintingTruth truth = procedural_painting(kSmall);
    for (std::size_t i = 0; i < truth.height_mm.size(); ++i) {
        const Rgb& diffuse = truth.diffuse.pixels()[i];
        ASSERT_GT(std::min({diffuse.r, diffuse.g, diffuse.b}), 0);
        ASSERT_LT(std::max({diffuse.r, diffuse.g, diffuse.b}), 0.95f);
        ASSERT_GE(truth.specular.pixels()[i], 0.015f);
        ASSERT_LE(truth.specular.pixels()[i], 0.06f);
        ASSERT_GE(truth.roughness.pixels()[i], 0.05f);
        ASSERT_LE(truth.roughness.pixels()[i], 0.8f);
        ASSERT_LT(std::abs(truth.height_mm.pixels()[i]), 2.5f);
    }
}

TEST(ProceduralPainting, ShowsEveryKindOfDamageWhateverTheSeed) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        PaintingOptions options = kSmall;
        options.seed = seed;
        const PaintingTruth truth = procedural_painting(options);
        EXPECT_GT(part_of(truth.loss), 0.005) << seed;
        EXPECT_GT(part_of(truth.craquelure), 0.005) << seed;
        EXPECT_GT(part_of(truth.varnish), 0.02) << seed;
        EXPECT_GT(part_of(truth.retouch), 0.01) << seed;
        EXPECT_GT(part_of(truth.valid), 0.8) << seed;
        EXPECT_LT(part_of(truth.valid), 1) << seed;
    }
}

// What later hands and wear did is where its mask says, and changes what it should there and nothing
// elsewhere.
TEST(ProceduralPainting, ShowsWearAndRepairWhereAskedFor) {
    PaintingOptions options = kSmall;
    const PaintingTruth sound = procedural_painting(options);
    options.abrasion = options.flaking = options.stain = options.old_fill = options.overpaint = true;
    const PaintingTruth worn = procedural_painting(options);
    for (const Mask* mask : {&worn.abrasion, &worn.flaking, &worn.stain, &worn.old_fill, &worn.overpaint})
        EXPECT_GT(part_of(*mask), 0.01);
    for (const Mask* mask :
         {&sound.abrasion, &sound.flaking, &sound.stain, &sound.old_fill, &sound.overpaint})
        EXPECT_EQ(part_of(*mask), 0);
    const auto change = [&](const Mask& where, auto&& of) {
        double sum = 0, count = 0;
        for (std::size_t i = 0; i < where.size(); ++i)
            if (where.pixels()[i]) sum += static_cast<double>(of(worn, i) - of(sound, i)), ++count;
        return sum / count;
    };
    const auto height = [](const PaintingTruth& t, std::size_t i) { return t.height_mm.pixels()[i]; };
    const auto alpha = [](const PaintingTruth& t, std::size_t i) { return t.roughness.pixels()[i]; };
    const auto blue = [](const PaintingTruth& t, std::size_t i) { return t.diffuse.pixels()[i].b; };
    EXPECT_LT(change(worn.abrasion, height), -0.02);
    EXPECT_GT(change(worn.abrasion, alpha), 0.05);
    EXPECT_GT(change(worn.overpaint, height), 0.05);
    EXPECT_LT(change(worn.stain, blue), -0.02);
    EXPECT_EQ(change(worn.stain, height), 0);
    EXPECT_EQ(change(worn.stain, alpha), 0);
}

TEST(ProceduralPainting, LeavesOutWhatIsSwitchedOff) {
    PaintingOptions options = kSmall;
    options.craquelure = 0;
    options.losses = options.varnish = options.retouch = false;
    const PaintingTruth truth = procedural_painting(options);
    EXPECT_EQ(part_of(truth.loss), 0);
    EXPECT_EQ(part_of(truth.craquelure), 0);
    EXPECT_EQ(part_of(truth.varnish), 0);
    EXPECT_EQ(part_of(truth.retouch), 0);
    EXPECT_EQ(part_of(truth.valid), 1);
}

TEST(ProceduralPainting, LiesLowerAndMatterInLosses) {
    const PaintingTruth truth = procedural_painting(kSmall);
    // The neighbourhood: within 8 pixels of a loss, but not in it.
    Mask around(truth.width(), truth.height());
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x)
            for (int dy = -8; dy <= 8 && !truth.loss(x, y); ++dy)
                for (int dx = -8; dx <= 8; ++dx) around(x, y) |= truth.loss.clamped(x + dx, y + dy);
    EXPECT_LT(mean_where(truth.height_mm, truth.loss, true), mean_where(truth.height_mm, around, true) - 0.1);
    EXPECT_GT(mean_where(truth.roughness, truth.loss, true), mean_where(truth.roughness, around, true) + 0.1);
    EXPECT_LT(mean_where(truth.specular, truth.loss, true), mean_where(truth.specular, around, true));
}

TEST(ProceduralPainting, IsGlossierUnderVarnishAndMatterInTheRetouch) {
    const PaintingTruth truth = procedural_painting(kSmall);
    EXPECT_LT(mean_where(truth.roughness, truth.varnish, true),
              0.6 * mean_where(truth.roughness, truth.varnish, false));
    EXPECT_GT(mean_where(truth.specular, truth.varnish, true),
              mean_where(truth.specular, truth.varnish, false));
    EXPECT_GT(mean_where(truth.roughness, truth.retouch, true),
              1.2 * mean_where(truth.roughness, truth.retouch, false));
}

TEST(ProceduralPainting, IsGroovedByItsCracks) {
    PaintingOptions options = kSmall;
    options.losses = options.varnish = options.retouch = false;
    const PaintingTruth cracked = procedural_painting(options);
    options.craquelure = 0;
    const PaintingTruth whole = procedural_painting(options);
    double deeper = 0, count = 0;
    for (std::size_t i = 0; i < whole.height_mm.size(); ++i)
        if (cracked.craquelure.pixels()[i]) {
            deeper += whole.height_mm.pixels()[i] - cracked.height_mm.pixels()[i];
            ++count;
        }
    EXPECT_GT(deeper / count, 0.03);
}

// Correlation of a map with itself, shifted by some columns.
double self_correlation(const Image<float>& map, int shift) {
    double mean = 0, product = 0, left = 0, right = 0;
    for (const float value : map.pixels()) mean += value / static_cast<double>(map.size());
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x + shift < map.width(); ++x) {
            const double a = map(x, y) - mean, b = map(x + shift, y) - mean;
            product += a * b;
            left += a * a;
            right += b * b;
        }
    return product / std::sqrt(left * right);
}

// Bare canvas, 6 pixels a thread: threads lie side by side, and those that lie on top alternate, so that a
// plain weave repeats exactly after two of them.
TEST(ProceduralPainting, RepeatsItsWeaveAfterTwoThreads) {
    const Image<float> weave = procedural_painting({.width = 96,
                                                    .height = 96,
                                                    .mm_per_pixel = 0.2,
                                                    .thread_pitch_mm = 1.2,
                                                    .thread_irregularity = 0,
                                                    .coverage = 0,
                                                    .craquelure = 0,
                                                    .losses = false,
                                                    .varnish = false,
                                                    .retouch = false})
                                   .height_mm;
    EXPECT_GT(self_correlation(weave, 12), 0.9);
    EXPECT_GT(self_correlation(weave, 12), self_correlation(weave, 6) + 0.03);
    EXPECT_GT(self_correlation(weave, 6), self_correlation(weave, 3) + 0.5);
}

TEST(ProceduralPainting, NamesTheOptionThatIsWrong) {
    EXPECT_EQ(error_of([] { procedural_painting({.width = 0}); }),
              "painting.width = 0 is outside [2, 32768] pixels");
    EXPECT_EQ(error_of([] { procedural_painting({.mm_per_pixel = std::nan("")}); }),
              "painting.mm_per_pixel = nan is outside [0.001, 10] mm");
}

TEST(ProceduralPainting, StopsWhereItsUserWantsItTo) {
    EXPECT_THROW(procedural_painting(kSmall, [](std::string_view, double) { return false; }), Cancelled);
}

TEST(ProceduralPainting, BecomesASurfaceThatIsCertainWhereItsTruthIs) {
    const PaintingTruth truth = procedural_painting(kSmall);
    const Surface surface = surface_of(truth);
    require_consistent(surface);
    EXPECT_TRUE(images_identical(surface.height_mm, truth.height_mm));
    EXPECT_TRUE(surface.scale_known);
    EXPECT_EQ(surface.mm_per_pixel, truth.mm_per_pixel);
    for (std::size_t i = 0; i < truth.valid.size(); ++i)
        ASSERT_EQ(surface.confidence.pixels()[i], truth.valid.pixels()[i]);
}

}  // namespace
}  // namespace tangi
