// anisotropy_estimate_test.cpp: lobes that are anisotropic are found, those that are not stay as they are,
// and both solvers and the reference renderer have one model of them.
#include "fit/material/anisotropy_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/pipeline/fit_painting.h"
#include "fit/pixel/ward_batch.h"
#include "surface/render/relight.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

struct Metal {
    glm::dvec2 slope{0};
    double alpha = 0.25, specular = 0.25;
    glm::dvec2 stretch{0};
    glm::dvec3 diffuse{0.2, 0.15, 0.08};
};

// Under lights of a dome; sigma as if of 12-bit photographs.
PixelSamples samples_of(const Metal& metal, Random& random, int photos = 48) {
    PixelSamples s;
    s.resize(photos, 3);
    const std::vector<Light> lights = dome_lights(photos, 20);
    const double theta[kWardCommon] = {metal.slope.x, metal.slope.y, std::log(metal.alpha), metal.specular};
    for (int i = 0; i < photos; ++i) {
        const glm::dvec3 l = glm::normalize(glm::dvec3(lights[static_cast<std::size_t>(i)].direction));
        s.light[static_cast<std::size_t>(i)] = l;
        const WardTerms t = ward_terms(theta, l, {0, 0, 1}, {}, metal.stretch);
        for (int c = 0; c < 3; ++c) {
            const auto at = static_cast<std::size_t>(3 * i + c);
            s.irradiance[at] = 0.75;
            s.value[at] = std::max(
                0.75 * (metal.diffuse[c] * t.matt + metal.specular * t.lobe) + 0.003 * random.normal(), 0.0);
            s.sigma[at] = 0.004;
        }
    }
    return s;
}

Metal random_metal(Random& random, double stretch) {
    const double angle = random.uniform(0, 2 * M_PI);
    return {{0.15 * random.normal(), 0.15 * random.normal()},
            random.uniform(0.18, 0.35),
            random.uniform(0.15, 0.4),
            stretch * glm::dvec2(std::cos(angle), std::sin(angle)),
            {random.uniform(0.05, 0.4), random.uniform(0.05, 0.4), random.uniform(0.05, 0.4)}};
}

WardVector vector_of(const Metal& m) {
    return {m.slope.x, m.slope.y, std::log(m.alpha), m.specular, m.diffuse[0], m.diffuse[1], m.diffuse[2]};
}

TEST(DrawnOutLobe, DerivativesAreThoseOfCentralDifferences) {
    constexpr int kUnknowns = kWardParameters + 2;
    Random random(1);
    for (int trial = 0; trial < 60; ++trial) {
        // The last ones are next to no stretch.
        const Metal is = random_metal(random, trial < 50 ? random.uniform(0, 1) : 1e-5 * trial);
        PixelSamples s = samples_of(random_metal(random, 0.5), random, 12);
        s.view = glm::normalize(glm::dvec3(random.direction(0.9)));
        const WardResiduals residuals(s, {}, 3, {.second_lobe_weight = trial % 2 ? 0.4 : 0});
        const auto rows = static_cast<std::size_t>(residuals.size());
        const auto at = [&](std::size_t column, double step) {
            std::vector<double> r(rows);
            WardVector theta = vector_of(is);
            glm::dvec2 stretch = is.stretch;
            if (column < kWardParameters)
                theta[column] += step;
            else
                stretch[static_cast<int>(column) - kWardParameters] += step;
            residuals.evaluate(theta.data(), stretch, r.data(), nullptr);
            return r;
        };
        std::vector<double> here(rows), jacobian(rows * kUnknowns);
        residuals.evaluate(vector_of(is).data(), is.stretch, here.data(), jacobian.data());
        for (std::size_t column = 0; column < kUnknowns; ++column) {
            const auto up = at(column, 1e-6), down = at(column, -1e-6);
            for (std::size_t row = 0; row < rows; ++row) {
                const double analytic = jacobian[column * rows + row];
                const double scale = std::max({1.0, std::abs(analytic), std::abs(here[row])});
                EXPECT_NEAR((up[row] - down[row]) / 2e-6 / scale, analytic / scale, 1e-5)
                    << "trial " << trial << ", column " << column;
            }
        }
    }
}

TEST(DrawnOutLobe, IsThatOfTheReferenceRenderer) {
    Random random(2);
    for (int i = 0; i < 200; ++i) {
        const Metal m = random_metal(random, random.uniform(0, 1));
        Surface s(1, 1);
        s.normal(0, 0) = normal_of({static_cast<float>(m.slope.x), static_cast<float>(m.slope.y)});
        s.diffuse(0, 0) = Rgb(m.diffuse);
        s.specular(0, 0) = static_cast<float>(m.specular);
        s.roughness(0, 0) = static_cast<float>(m.alpha);
        s.lobe_axes = Image<LobeAxes>(1, 1, axes_of(Stretch(m.stretch), static_cast<float>(m.alpha)));
        s.reflectance_model.second_lobe_weight = 0.3;
        const Vec3 light = random.direction(0.1), view = random.direction(0.8);
        const WardTerms t = ward_terms(vector_of(m).data(), glm::dvec3(light), glm::dvec3(view),
                                       s.reflectance_model, m.stretch);
        const Rgb shown = reflected(s, 0, 0, light, view, WardModel::bounded);
        for (int c = 0; c < 3; ++c) {
            const double expected = m.diffuse[c] * t.matt + m.specular * t.lobe;
            EXPECT_NEAR(shown[c], expected, 1e-4 * expected + 1e-5);
        }
    }
}

WardPrior prior_with(const glm::dvec2& stretch) {
    WardPrior prior;
    prior.stretch = stretch;
    return prior;
}

TEST(DrawnOutLobe, BatchesFindWhatCeresFinds) {
    Random random(3);
    WardFitOptions options;
    options.reflectance_model.second_lobe_weight = 0.3;
    WardFitter ceres(options);
    WardBatchFitter batches(options);
    constexpr int kCount = 64;
    std::vector<PixelSamples> samples;
    std::vector<Metal> metals;
    for (int i = 0; i < kCount; ++i) {
        metals.push_back(random_metal(random, i % 4 == 0 ? 0 : random.uniform(0.2, 0.9)));
        samples.push_back(samples_of(metals.back(), random));
    }
    batches.start(kCount);
    WardBatch batch;
    for (int first = 0; first < kCount; first += kWardLanes) {
        batch.resize(48, 3, {});
        for (int k = first; k < first + kWardLanes; ++k) {
            const auto at = static_cast<std::size_t>(k);
            batch.set(k - first, k, samples[at]);
            batch.set_prior(k - first, prior_with(metals[at].stretch));
        }
        batches.fit(batch);
    }
    batches.finish();
    int agree = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
        const WardEstimate a = batches.solutions()[k].estimate(3),
                           b = ceres.fit(samples[k], prior_with(metals[k].stretch));
        agree +=
            glm::length(a.slope - b.slope) < 0.01 && std::abs(a.rms_residual / b.rms_residual - 1) < 0.01;
    }
    EXPECT_GE(agree, kCount - 2);
}

// Lanes without a stretch come to the same bits beside lanes that have one.
TEST(DrawnOutLobe, LanesDoNotDependOnTheirNeighbours) {
    Random random(4);
    const PixelSamples plain = samples_of(random_metal(random, 0), random),
                       other = samples_of(random_metal(random, 0.6), random);
    std::vector<WardSolution> found;
    for (const bool beside : {false, true}) {
        WardBatchFitter batches({});
        batches.start(2);
        WardBatch batch;
        batch.resize(48, 3, {});
        batch.set(0, 0, plain);
        batch.set(1, 1, other);
        if (beside) batch.set_prior(1, prior_with({0.5, 0.2}));
        batches.fit(batch);
        batches.finish();
        found.push_back(batches.solutions()[0]);
    }
    EXPECT_EQ(found[0].theta, found[1].theta);
    EXPECT_EQ(found[0].cost, found[1].cost);
}

TEST(StretchEvidence, KnowsBrushedMetalFromPaint) {
    Random random(5);
    WardFitter fitter({});
    int found = 0, none = 0;
    for (int i = 0; i < 60; ++i) {
        const bool brushed = i % 2 == 0;
        const Metal metal = random_metal(random, brushed ? 0.6 : 0);
        const PixelSamples s = samples_of(metal, random);
        const Stretch stretch = stretch_of(stretch_evidence(s, fitter.fit(s), {}));
        if (brushed) found += glm::length(glm::dvec2(stretch) - metal.stretch) < 0.2;
        if (!brushed) none += stretch == Stretch(0);
    }
    EXPECT_GE(found, 26) << "of 30";
    EXPECT_GE(none, 26) << "of 30";
}

TEST(StretchEvidence, SaysNothingWhereNoLightShowsTheLobe) {
    Random random(6);
    Metal matt;
    matt.specular = 0;
    const PixelSamples s = samples_of(matt, random);
    WardFitter fitter({});
    EXPECT_EQ(stretch_of(stretch_evidence(s, fitter.fit(s), {})), Stretch(0));
    EXPECT_EQ(stretch_of(StretchEvidence{{0.5, 0.5}, glm::dmat2(0)}), Stretch(0));
    EXPECT_EQ(stretch_of(StretchEvidence{{0.05, 0.05}, glm::dmat2(1e6)}), Stretch(0)) << "nearly none";
    EXPECT_NEAR(stretch_of(StretchEvidence{{0.6, 0}, glm::dmat2(1e6)}).x, 0.6, 0.03);
    EXPECT_NEAR(glm::length(stretch_of(StretchEvidence{{2, 2}, glm::dmat2(1e6)})), kMostStretch, 1e-6);
}

// A panel of gentle waves, left half brushed metal, right half paint.
Surface half_brushed(const Stretch& stretch) {
    Surface s(48, 32);
    s.lobe_axes = Image<LobeAxes>(s.width(), s.height(), {0.2f, 0});
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const bool metal = x < s.width() / 2;
            s.normal(x, y) = normal_of(
                {static_cast<float>(0.15 * std::sin(0.7 * x)), static_cast<float>(0.15 * std::cos(0.5 * y))});
            s.diffuse(x, y) = metal ? Rgb(0.25f, 0.24f, 0.22f) : Rgb(0.15f, 0.25f, 0.4f);
            s.specular(x, y) = metal ? 0.15f : 0.05f;
            s.roughness(x, y) = metal ? 0.25f : 0.2f;
            s.confidence(x, y) = 1;
            if (metal) s.lobe_axes(x, y) = axes_of(stretch, 0.25f);
        }
    return s;
}

Image<Rgb> turned_clockwise(const Image<Rgb>& picture) {
    Image<Rgb> turned(picture.height(), picture.width());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) turned(picture.height() - 1 - y, x) = picture(x, y);
    return turned;
}

// Of photographs that were all turned clockwise, if they were.
FitResult seeded_fit_of(const Surface& truth, const FitOptions& options, unsigned seed = 10,
                        bool turned = false) {
    const TestDir folder;
    std::vector<Light> lights = dome_lights(40, 25);
    Random random(seed);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].name = fmt::format("photo{:02}.tif", i);
        Image<Rgb> picture = relight(truth, {&lights[i], 1});
        for (Rgb& value : picture.pixels())
            for (int c = 0; c < 3; ++c)
                value[c] =
                    std::clamp(0.5f * value[c] + 0.001f * static_cast<float>(random.normal()), 0.0f, 1.0f);
        write_picture(folder / lights[i].name, turned ? turned_clockwise(picture) : picture, {},
                      {.bits = 16});
        if (turned)
            lights[i].direction = {lights[i].direction.y, -lights[i].direction.x, lights[i].direction.z};
    }
    write_lights(folder / "lights.lp", lights);
    FitOptions given = options;
    given.register_photos = false;
    given.white_level = 0.5;
    return fit_painting(open_stack(folder.path(), {.transfer = Transfer{}}), given);
}

TP_LONG TEST(FitPainting, TurnedPhotographsOfBrushedMetalGiveTurnedMaps) {
    Surface truth = half_brushed({0.4f, 0.3f});
    const FitOptions options{.anisotropic_specular = 1, .refine = false};
    const Surface as_it_is = seeded_fit_of(truth, options).surface,
                  turned = seeded_fit_of(truth, options, 10, true).surface;
    ASSERT_FALSE(as_it_is.lobe_axes.empty());
    ASSERT_EQ(turned.width(), as_it_is.height());
    int apart = 0;
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x) {
            const int u = truth.height() - 1 - y, v = x;
            const Stretch a = stretch_of(as_it_is.lobe_axes(x, y), as_it_is.roughness(x, y)),
                          b = stretch_of(turned.lobe_axes(u, v), turned.roughness(u, v));
            const Vec3 &n = as_it_is.normal(x, y), &m = turned.normal(u, v);
            apart += glm::length(a + b) > 1e-3f || glm::length(Vec3(n.y, -n.x, n.z) - m) > 1e-3f ||
                     std::abs(as_it_is.roughness(x, y) - turned.roughness(u, v)) > 1e-3f;
        }
    EXPECT_LE(apart, 8);  // pixels with two minima
}

TP_LONG TEST(FitPainting, FindsHowMetalIsBrushedAndLeavesPaintAndLightsAsTheyAre) {
    const Stretch is(0.4f, 0.3f);
    const Surface truth = half_brushed(is);
    const double half = static_cast<double>(truth.height_mm.size()) / 2;
    for (const unsigned seed : {10u, 15u}) {
        const FitResult fit = seeded_fit_of(truth, {}, seed);
        // Turns of 20 degrees and other strengths explain brushed metal better than no stretch does.
        EXPECT_EQ(fit.report.lights.model, LightingModel{}) << name_of(fit.report.lights.model);
        EXPECT_TRUE(fit.report.reflectance_model.stretches.chosen);
        EXPECT_EQ(fit.report.reflectance_model.reflectance_model.second_lobe_weight, 0);
        EXPECT_GT(fit.report.reflectance_model.stretches.anisotropic_db,
                  fit.report.reflectance_model.stretches.isotropic_db + 1);
        ASSERT_FALSE(fit.surface.lobe_axes.empty());
        double metal = 0, paint = 0, specular = 0, alpha = 0, slope = 0;
        for (int y = 0; y < truth.height(); ++y)
            for (int x = 0; x < truth.width(); ++x) {
                const Stretch found = stretch_of(fit.surface.lobe_axes(x, y), fit.surface.roughness(x, y));
                const Slope a = slope_of(fit.surface.normal(x, y)), b = slope_of(truth.normal(x, y));
                slope += std::hypot(a.x - b.x, a.y - b.y) / (2 * half);
                if (x >= truth.width() / 2) {
                    paint += glm::length(found) / half;
                    continue;
                }
                metal += glm::length(found - is) / half;
                specular += fit.surface.specular(x, y) / half;
                alpha += fit.surface.roughness(x, y) / half;
            }
        EXPECT_LT(metal, 0.05);
        EXPECT_LT(paint, 0.01);
        EXPECT_NEAR(specular, 0.15, 0.005);
        EXPECT_NEAR(alpha, 0.25, 0.005);
        EXPECT_LT(slope, 0.005);
        EXPECT_NEAR(fit.report.anisotropic, 0.5, 0.02);
        EXPECT_GE(fit.report.solvers.cost_agrees + fit.report.solvers.cheaper,
                  0.97 * static_cast<double>(fit.report.solvers.compared));
    }
}

TP_LONG TEST(FitPainting, LeavesLobesIsotropicWhereTheyAreAndWhereItIsTold) {
    const FitResult fit = seeded_fit_of(half_brushed(Stretch(0)), {.refine = false});
    EXPECT_FALSE(fit.report.reflectance_model.stretches.chosen);
    EXPECT_TRUE(fit.surface.lobe_axes.empty());
    const FitResult told =
        seeded_fit_of(half_brushed({0.5f, 0}), {.anisotropic_specular = 0, .refine = false});
    EXPECT_TRUE(told.surface.lobe_axes.empty());
    EXPECT_EQ(told.report.anisotropic, 0);
}

}  // namespace
}  // namespace tangi
