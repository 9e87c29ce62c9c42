// specular_colour_test.cpp: lobes of metal get their colour, those of paint stay white, and fits with a known
// colour find what the samples were made from.
#include "fit/material/specular_colour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/pipeline/fit_painting.h"
#include "surface/render/relight.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

const Rgb kGold(1, 0.77f, 0.34f), kWhite(1);

struct Paint {
    glm::dvec2 slope{0};
    double alpha = 0.25, specular = 0.2;
    glm::dvec3 diffuse{0.2, 0.15, 0.08};
    Rgb lobe = kWhite;
};

// Under lights of a dome, without noise; sigma as if of 12-bit photographs.
PixelSamples samples_of(const Paint& paint, int photos = 40) {
    PixelSamples s;
    s.resize(photos, 3);
    const std::vector<Light> lights = dome_lights(photos);
    const double theta[kWardCommon] = {paint.slope.x, paint.slope.y, std::log(paint.alpha), paint.specular};
    for (int i = 0; i < photos; ++i) {
        const glm::dvec3 l = glm::normalize(glm::dvec3(lights[static_cast<std::size_t>(i)].direction));
        s.light[static_cast<std::size_t>(i)] = l;
        const WardTerms t = ward_terms(theta, l, {0, 0, 1});
        for (int c = 0; c < 3; ++c) {
            const auto at = static_cast<std::size_t>(3 * i + c);
            s.irradiance[at] = 0.75;
            s.value[at] = 0.75 * (paint.diffuse[c] * t.matt + paint.specular * paint.lobe[c] * t.lobe);
            s.sigma[at] = 0.004;
        }
    }
    return s;
}

Paint random_paint(Random& random, const Rgb& lobe) {
    return {{0.25 * random.normal(), 0.25 * random.normal()},
            random.uniform(0.15, 0.35),
            random.uniform(0.1, 0.3),
            {random.uniform(0.05, 0.5), random.uniform(0.05, 0.5), random.uniform(0.05, 0.5)},
            lobe};
}

TEST(LobeEvidence, KnowsMetalFromPaint) {
    Random random(3);
    WardFitter fitter({});
    int seen = 0, white = 0;
    for (int i = 0; i < 60; ++i) {
        const bool metal = i % 2 == 0;
        PixelSamples s = samples_of(random_paint(random, metal ? kGold : kWhite));
        for (std::size_t k = 0; k < s.value.size(); ++k)
            s.value[k] = std::max(s.value[k] + 0.004 * random.normal(), 0.0);
        const Rgb colour = specular_colour_of(lobe_evidence(s, fitter.fit(s), {}));
        EXPECT_EQ(std::max({colour.r, colour.g, colour.b}), 1);
        if (!metal) white += colour == kWhite;
        if (metal) seen += glm::length(colour - kGold) < 0.15f;
    }
    EXPECT_GE(seen, 27) << "of 30";
    EXPECT_GE(white, 27) << "of 30";
}

TEST(LobeEvidence, SaysNothingWhereNoLightShowsTheLobe) {
    Paint matt{.specular = 0};
    const PixelSamples s = samples_of(matt);
    WardFitter fitter({});
    EXPECT_EQ(specular_colour_of(lobe_evidence(s, fitter.fit(s), {})), kWhite);
    PixelSamples grey;
    grey.resize(10, 1);
    EXPECT_EQ(lobe_evidence(grey, {}, {}).weight, 0);
    EXPECT_EQ(specular_colour_of({Rgb(2, 0.5f, 0.5f), 0}), kWhite);
}

TEST(LobeEvidence, ShrinksWhatIsNearlyWhiteToWhite) {
    EXPECT_EQ(specular_colour_of({Rgb(1.03f, 1, 0.97f), 1e6f}), kWhite);
    const Rgb clear = specular_colour_of({Rgb(1.4f, 1.1f, 0.5f), 1e6f});
    EXPECT_NEAR(clear.b, 0.5 / 1.4, 0.03);
    EXPECT_EQ(clear.r, 1);
    const Rgb missing = specular_colour_of({Rgb(3, 0, 0), 1e6f});
    EXPECT_GT(std::min(missing.g, missing.b), 0) << "divide_by_specular_colour() divides by it";
}

// Where a file keeps little of chroma, a paint's white highlight has the paint's own hue, in all pixels
// alike.
TEST(LobeEvidence, OfTheHueOfSaturatedPaintIsWhite) {
    Paint red{.alpha = 0.3, .specular = 0.05, .diffuse = {0.6, 0.12, 0.08}};
    red.lobe = Rgb(1.8f, 0.7f, 0.5f);
    Paint copper{.alpha = 0.3, .specular = 0.3, .diffuse = {0.08, 0.05, 0.03}};
    copper.lobe = Rgb(1.5f, 0.9f, 0.6f);
    const auto of_many = [](const Paint& paint) {
        WardFitter fitter({});
        const PixelSamples s = samples_of(paint);
        LobeEvidence e = lobe_evidence(s, fitter.fit(s), {});
        e.weight *= 50;
        return e;
    };
    LobeEvidence evidence = of_many(red);
    EXPECT_GT(evidence.weight, 100);
    EXPECT_EQ(specular_colour_of(evidence), kWhite);
    evidence.matt_hue = 0;
    EXPECT_LT(specular_colour_of(evidence).b, 0.5f) << "only the matt part speaks against it";
    EXPECT_LT(glm::length(specular_colour_of(of_many(copper)) - copper.lobe / 1.5f), 0.08f);
}

TEST(Whiten, MakesAColouredLobeAWhiteOne) {
    Random random(4);
    WardFitOptions exact;
    exact.model_error = 0;
    WardFitter fitter(exact);
    for (int i = 0; i < 20; ++i) {
        const Paint paint = random_paint(random, kGold);
        PixelSamples s = samples_of(paint);
        divide_by_specular_colour(kGold, s);
        const WardEstimate e = coloured(fitter.fit(s), kGold);
        EXPECT_LT(glm::length(e.slope - paint.slope), 0.01);
        EXPECT_NEAR(e.specular, paint.specular, 0.03 * paint.specular + 0.003);
        EXPECT_NEAR(e.roughness, paint.alpha, 0.02 * paint.alpha + 0.003);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.diffuse[c], paint.diffuse[c], 0.01);
        EXPECT_EQ(e.specular_colour, glm::dvec3(kGold));
    }
}

// Pixels of one look have one material: what is measured of it alternates by chance or by a camera's mosaic.
TEST(LobeColours, AreSmoothWhereEvidenceAlternates) {
    constexpr int size = 24;
    for (const int pattern : {0, 1, 2}) {  // columns, rows, a chessboard
        Surface s(size, size);
        Image<LobeEvidence> evidence(size, size);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                s.confidence(x, y) = 1;
                s.diffuse(x, y) = Rgb(0.1f, 0.07f, 0.03f);
                s.specular(x, y) = 0.3f;
                const int odd = (pattern == 0 ? x : pattern == 1 ? y : x + y) % 2;
                evidence(x, y) = {kGold / 0.7033f + Rgb(odd ? 0.15f : -0.15f, odd ? -0.15f : 0.15f, 0), 16};
            }
        const Image<Rgb> colours = specular_colours(s, evidence);
        for (int y = 0; y < size; ++y)
            for (int x = 1; x < size; ++x)
                EXPECT_LE(glm::length(colours(x, y) - colours(x - 1, y)), 0.08f)
                    << pattern << ": " << x << ", " << y;
    }
}

TEST(LobeColours, AreThoseOfNeighboursOfTheSameLook) {
    const Surface s = metal_beside_paint(40, 20, 30);
    Image<LobeEvidence> evidence(40, 20);
    Random random(5);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 40; ++x) {
            const bool metal = x < 20;
            const Rgb colour = metal ? kGold / 0.7033f : kWhite;
            const auto noisy = [&](float v) { return v + 0.25f * static_cast<float>(random.normal()); };
            evidence(x, y) = {{noisy(colour.r), noisy(colour.g), noisy(colour.b)}, 16};
        }
    const Image<Rgb> colours = specular_colours(s, evidence);
    double gold = 0, alone = 0, paint = 0;  // mean distances from the truth
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 40; ++x) {
            const Rgb of_itself = specular_colour_of(evidence(x, y));
            if (x < 20) gold += glm::length(colours(x, y) - kGold) / 400;
            if (x < 20) alone += glm::length(of_itself - kGold) / 400;
            if (x >= 20) paint += glm::length(colours(x, y) - kWhite) / 400;
        }
    EXPECT_LT(gold, 0.1);
    EXPECT_LT(gold, 0.4 * alone) << "neighbours help";
    EXPECT_LT(paint, 0.01);
    EXPECT_EQ(colours(30, 3), kWhite) << "not measured";
}

// A panel of waves, left half gold, right half paint, under 30 lights.
Surface half_gilded() {
    Surface s(48, 24);
    s.specular_colour = Image<Rgb>(s.width(), s.height(), kWhite);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const bool gold = x < s.width() / 2;
            s.normal(x, y) = normal_of(
                {static_cast<float>(0.25 * std::sin(0.7 * x)), static_cast<float>(0.25 * std::cos(0.5 * y))});
            s.diffuse(x, y) = gold ? 0.3f * kGold : Rgb(0.15f, 0.25f, 0.4f);
            s.specular(x, y) = gold ? 0.12f : 0.05f;
            s.roughness(x, y) = 0.2f;
            s.confidence(x, y) = 1;
            if (gold) s.specular_colour(x, y) = kGold;
        }
    return s;
}

FitResult fit_of(const Surface& truth, const FitOptions& options) {
    const TestDir folder;
    std::vector<Light> lights = dome_lights(30, 30);
    Random random(10);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].name = fmt::format("photo{:02}.tif", i);
        Image<Rgb> picture = relight(truth, {&lights[i], 1});
        for (Rgb& value : picture.pixels())
            for (int c = 0; c < 3; ++c)
                value[c] =
                    std::clamp(0.6f * value[c] + 0.001f * static_cast<float>(random.normal()), 0.0f, 1.0f);
        write_picture(folder / lights[i].name, picture, {}, {.bits = 16});
    }
    write_lights(folder / "lights.lp", lights);
    FitOptions given = options;
    given.register_photos = false;
    given.white_level = 0.6;
    return fit_painting(open_stack(folder.path(), {.transfer = Transfer{}}), given);
}

TP_LONG TEST(FitPainting, FindsTheColourOfGoldAndLeavesPaintWhite) {
    const Surface truth = half_gilded();
    const FitResult fit = fit_of(truth, {});
    EXPECT_TRUE(fit.report.reflectance_model.colours.chosen);
    EXPECT_NEAR(fit.report.reflectance_model.colours.part, 0.5, 0.1);
    ASSERT_FALSE(fit.surface.specular_colour.empty());
    double gold = 0, paint = 0, specular = 0, slope = 0;
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x) {
            const double off = glm::length(fit.surface.specular_colour(x, y) - truth.specular_colour(x, y));
            const Slope found = slope_of(fit.surface.normal(x, y)), is = slope_of(truth.normal(x, y));
            slope += std::hypot(found.x - is.x, found.y - is.y) / static_cast<double>(truth.height_mm.size());
            (x < truth.width() / 2 ? gold : paint) += off * 2 / static_cast<double>(truth.height_mm.size());
            if (x < truth.width() / 2)
                specular += fit.surface.specular(x, y) * 2.0 / static_cast<double>(truth.height_mm.size());
        }
    EXPECT_LT(gold, 0.05);
    EXPECT_LT(paint, 0.01);
    EXPECT_NEAR(specular, 0.12, 0.01);
    EXPECT_LT(slope, 0.01);
    EXPECT_NEAR(fit.report.coloured, 0.5, 0.03);
    EXPECT_GE(fit.report.solvers.cost_agrees + fit.report.solvers.cheaper,
              0.97 * static_cast<double>(fit.report.solvers.compared));
}

TP_LONG TEST(FitPainting, TakesLobesForWhiteWhereItIsTold) {
    const FitResult fit = fit_of(half_gilded(), {.coloured_specular = 0, .refine = false});
    EXPECT_TRUE(fit.surface.specular_colour.empty());
    EXPECT_EQ(fit.report.coloured, 0);
}

TP_LONG TEST(FitPainting, LeavesLobesWhiteWhereTheyAre) {
    Surface truth = half_gilded();
    truth.specular_colour = {};
    const FitResult fit = fit_of(truth, {.refine = false});
    EXPECT_FALSE(fit.report.reflectance_model.colours.chosen);
    EXPECT_TRUE(fit.surface.specular_colour.empty());
}

}  // namespace
}  // namespace tangi
