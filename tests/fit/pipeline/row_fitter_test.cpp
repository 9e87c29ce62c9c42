// row_fitter_test.cpp: rows fitted in batches and by Ceres alone; lights near and far.
#include "fit/pipeline/row_fitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "capture/stack/stack.h"
#include "tests/support/fit/fit_test_support.h"

namespace tangi {
namespace {

using Fitted = std::map<std::pair<int, int>, WardEstimate>;

struct BandScene {
    SmallStack small;
    Stack stack = small.open();
    Lighting lighting{stack.lights(), {}, 1};
    NoiseModel noise{Transfer{}, 0.006, true};
    Surface surface{stack.width(), stack.height()};
    Band band = StackReader(stack).read(0, stack.height(), Transfer{});

    BandScene() { surface.mm_per_pixel = 0.4; }
    Fitted fit(Solver solver, int rows = 1000, const Image<unsigned char>& mask = {},
               const PixelKnowledge& known = {}, SolverAgreement* agreement = nullptr) {
        RowFitter fitter({}, solver, lighting, noise, band.channels());
        Fitted result;
        for (int y = 0; y < surface.height(); y += rows)
            fitter.fit(band, y, std::min(y + rows, surface.height()), {surface, known, mask},
                       [&](int x, int row, const WardEstimate& e) {
                           result[{x, row}] = e;
                       });
        if (agreement) *agreement = fitter.agreement().at(0);
        return result;
    }
};

void expect_alike(const Fitted& a, const Fitted& b, double part) {
    ASSERT_EQ(a.size(), b.size());
    std::size_t alike = 0;
    for (const auto& [place, e] : a)
        alike += std::abs(e.rms_residual / b.at(place).rms_residual - 1) < 0.005 &&
                 glm::length(e.slope - b.at(place).slope) < 0.01;
    EXPECT_GE(static_cast<double>(alike), part * static_cast<double>(a.size()));
}

TEST(RowFitter, FindsInBatchesWhatCeresFinds) {
    BandScene scene;
    SolverAgreement agreement;
    const Fitted batch = scene.fit(Solver::batch, 1000, {}, {}, &agreement);
    expect_alike(batch, scene.fit(Solver::ceres), 0.95);
    EXPECT_GT(agreement.compared, 30);
    EXPECT_GE(agreement.cost_agrees, 0.95 * static_cast<double>(agreement.compared));
    EXPECT_LE(agreement.cost_agrees + agreement.cheaper, agreement.compared);
    EXPECT_LE(agreement.polished, agreement.doubtful);
}

TEST(RowFitter, FindsItUnderNearLightsABentFieldAndANearCamera) {
    BandScene scene;
    scene.lighting.rig.ambient = 0.03f;
    scene.lighting.rig.camera_distance_mm = 60;
    scene.lighting.rig.camera_axis_mm = {2, -1};
    scene.lighting.rig.bend_per_mm = 0.002f;
    for (std::size_t i = 0; i < scene.lighting.lights.size(); ++i) {
        Light& light = scene.lighting.lights[i];
        light.gain = {1.1f, 0.9f, 0.8f};
        if (i % 3) light.position_mm = light.direction * (30.0f + static_cast<float>(i));
    }
    // These are not the lights that the photographs had, so more pixels than usual have two minima.
    expect_alike(scene.fit(Solver::batch), scene.fit(Solver::ceres), 0.9);
}

TEST(RowFitter, FindsItUnderUnevenLights) {
    BandScene scene;
    BandScene even;
    for (std::size_t i = 0; i < scene.lighting.lights.size(); ++i) {
        Light& light = scene.lighting.lights[i];
        const float by = i % 2 ? 0.02f : -0.02f;
        light.beam.terms = {by, 0.01f, -0.3f * by * by, 5e-4f, by * by};
        if (i % 3) light.position_mm = light.direction * 40.0f;
        even.lighting.lights[i].position_mm = light.position_mm;
    }
    const Fitted batch = scene.fit(Solver::batch);
    expect_alike(batch, scene.fit(Solver::ceres), 0.9);
    EXPECT_NE(batch.at({2, 2}).slope, even.fit(Solver::batch).at({2, 2}).slope) << "beams matter here";
}

TEST(RowFitter, GivesTheSameBitsForAnyRowsAtOnce) {
    BandScene scene;
    const Fitted whole = scene.fit(Solver::batch), rows = scene.fit(Solver::batch, 1);
    ASSERT_EQ(whole.size(), rows.size());
    for (const auto& [place, e] : whole) {
        EXPECT_EQ(e.slope, rows.at(place).slope);
        EXPECT_EQ(e.slope_error, rows.at(place).slope_error);
    }
}

TEST(RowFitter, LeavesOutWhatIsMaskedOrMissing) {
    BandScene scene;
    Image<unsigned char> mask(scene.surface.width(), scene.surface.height(), 1);
    for (int x = 0; x < mask.width(); ++x) mask(x, 4) = 0;
    mask(7, 9) = 0;
    for (int i = 0; i < scene.band.photos(); ++i)
        for (int c = 0; c < scene.band.channels(); ++c)
            scene.band.row(i, c, 2)[3] = std::numeric_limits<float>::quiet_NaN();
    scene.band.row(0, 0, 2)[5] = std::numeric_limits<float>::infinity();
    const Fitted fitted = scene.fit(Solver::batch, 1000, mask);
    EXPECT_FALSE(fitted.contains({0, 4}));
    EXPECT_FALSE(fitted.contains({7, 9}));
    EXPECT_FALSE(fitted.contains({3, 2}));
    EXPECT_TRUE(fitted.contains({8, 9}));
    EXPECT_TRUE(fitted.contains({5, 2}));  // its other samples are as good as ever
}

TEST(RowFitter, HandsOnWhatIsKnownOfAPixel) {
    BandScene scene;
    PixelKnowledge known;
    known.prior = [](int x, int) {
        return WardPrior{x % 2 ? -1.2 : -2.0, 0.1, 0.05, 0.02, {0.2, -0.1}, {0.05, x % 2 ? 1e-4 : 0.02}};
    };
    Image<float> height_mm(scene.surface.width(), scene.surface.height());
    for (int y = 0; y < height_mm.height(); ++y) height_mm(9, y) = 0.5f;  // a ridge, twice as high as wide
    const CastShadows shadows(height_mm, scene.surface.mm_per_pixel, 0.25);
    known.shadows = &shadows;
    const Fitted told = scene.fit(Solver::batch, 1000, {}, known);
    expect_alike(told, scene.fit(Solver::ceres, 1000, {}, known), 0.95);
    const Fitted untold = scene.fit(Solver::batch);
    EXPECT_NE(told.at({5, 5}).roughness, untold.at({5, 5}).roughness);
    EXPECT_NEAR(told.at({5, 5}).slope.y, -0.1, 1e-3);  // the prior is nearly certain
    known.prior = nullptr;
    const Fitted shaded = scene.fit(Solver::batch, 1000, {}, known);
    EXPECT_NE(shaded.at({8, 5}).slope, untold.at({8, 5}).slope);
    EXPECT_EQ(shaded.at({9, 5}).slope, untold.at({9, 5}).slope);  // on the ridge, above all
}

TEST(IsCompared, SpreadsAboutFiveHundredPixelsOverAnyPicture) {
    for (const auto& [width, height] : {std::pair{4000, 3000}, {500, 300}, {3000, 100}}) {
        int count = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) count += is_compared(x, y, width, height);
        EXPECT_GT(count, 300) << width;
        EXPECT_LT(count, 1000) << width;
    }
}

}  // namespace
}  // namespace tangi
