// quality_test.cpp: planted steps of colour, height and gloss are found as they are.
#include <gtest/gtest.h>

#include "paint/optics/palette.h"
#include "retouch/colour_match/gloss.h"
#include "retouch/inpaint/quality.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

const std::vector<Illuminant> kFewLights = {Illuminant::d65, Illuminant::a};

// A plane that rises to the right, grey, with a square patch.
struct Patched {
    Surface surface{100, 90};
    Mask patch{100, 90};

    Patched(float step_mm, const Rgb& colour, float specular, float roughness) {
        surface.mm_per_pixel = 0.25;
        surface.scale_known = true;
        for (int y = 0; y < 90; ++y)
            for (int x = 0; x < 100; ++x) {
                const bool in = x >= 35 && x < 65 && y >= 30 && y < 60;
                patch(x, y) = in ? 1.0f : 0.0f;
                surface.confidence(x, y) = 1;
                surface.height_mm(x, y) = 0.002f * static_cast<float>(x) + (in ? step_mm : 0.0f);
                surface.diffuse(x, y) = in ? colour : Rgb(0.3f);
                surface.specular(x, y) = in ? specular : 0.04f;
                surface.roughness(x, y) = in ? roughness : 0.15f;
            }
    }
    QualityReport quality() const {
        return quality_of(Canvas(std::make_shared<Surface>(surface)), patch, {}, kFewLights);
    }
};

TEST(Quality, OfWhatIsLikeItsSurroundingsIsZero) {
    const QualityReport report = Patched(0, Rgb(0.3f), 0.04f, 0.15f).quality();
    ASSERT_EQ(report.regions.size(), 1u);
    const RetouchQuality& q = report.regions[0];
    EXPECT_NEAR(q.area_mm2, 30 * 30 * 0.0625, 1e-6);
    for (const Illuminant illuminant : kFewLights) {
        EXPECT_LT(q.delta_e[static_cast<std::size_t>(illuminant)], 0.01);
        EXPECT_LT(q.border_delta_e[static_cast<std::size_t>(illuminant)], 0.01);
    }
    EXPECT_TRUE(std::isnan(q.delta_e[static_cast<std::size_t>(Illuminant::f11)])) << "nobody asked";
    EXPECT_NEAR(q.height_mm.mean, 0, 1e-3);
    EXPECT_LT(q.gloss_step, 1e-3);
}

TEST(Quality, FindsPlantedSteps) {
    const Rgb colour(0.36f, 0.3f, 0.25f);
    const QualityReport report = Patched(0.12f, colour, 0.02f, 0.3f).quality();
    const RetouchQuality& q = report.regions[0];
    const double truth = delta_e_2000(lab_from_linear(colour), lab_from_linear(Rgb(0.3f)));
    EXPECT_NEAR(q.delta_e[static_cast<std::size_t>(Illuminant::d65)], truth, 0.02 * truth);
    EXPECT_NEAR(q.border_delta_e[static_cast<std::size_t>(Illuminant::d65)], truth, 0.02 * truth);
    EXPECT_NEAR(q.height_mm.mean, 0.12, 0.003);
    EXPECT_NEAR(q.specular.mean, -0.02, 1e-4);
    EXPECT_NEAR(q.roughness.mean, 0.15, 1e-4);
    const double gloss =
        gloss_difference({0.02, 0.3, static_cast<double>(luminance(colour))}, {0.04, 0.15, 0.3});
    EXPECT_NEAR(q.gloss_step, gloss, 0.02 * gloss);
    EXPECT_NEAR(report.height_mm(50, 45), 0.12, 0.003);
    EXPECT_EQ(report.height_mm(10, 10), 0);
    EXPECT_NEAR(report.delta_e(50, 45),
                std::max(q.delta_e[static_cast<std::size_t>(Illuminant::d65)],
                         q.delta_e[static_cast<std::size_t>(Illuminant::a)]),
                0.05 * truth);
}

TEST(Quality, TellsRegionsApart) {
    Patched patched(0, Rgb(0.3f), 0.04f, 0.15f);
    for (int y = 5; y < 15; ++y)
        for (int x = 5; x < 15; ++x) patched.patch(x, y) = 1, patched.surface.diffuse(x, y) = Rgb(0.5f);
    const QualityReport report = patched.quality();
    ASSERT_EQ(report.regions.size(), 2u);
    EXPECT_GT(report.regions[0].delta_e[static_cast<std::size_t>(Illuminant::d65)], 10);
    EXPECT_LT(report.regions[1].delta_e[static_cast<std::size_t>(Illuminant::d65)], 0.1);
}

TEST(Quality, OfHundredsOfSmallRetouchesIsQuickAndRightForEach) {
    Patched flat(0, Rgb(0.3f), 0.04f, 0.15f);
    flat.surface = Surface(300, 300);
    flat.surface.mm_per_pixel = 1;
    flat.patch = Mask(300, 300);
    for (float& c : flat.surface.confidence.pixels()) c = 1;
    for (Rgb& c : flat.surface.diffuse.pixels()) c = Rgb(0.3f);
    for (int y = 5; y < 295; y += 20)
        for (int x = 5; x < 295; x += 20)
            for (int dy = 0; dy < 6; ++dy)
                for (int dx = 0; dx < 6; ++dx) {
                    flat.patch(x + dx, y + dy) = 1;
                    flat.surface.height_mm(x + dx, y + dy) = 0.001f * static_cast<float>(x);
                }
    const QualityReport report = flat.quality();
    ASSERT_EQ(report.regions.size(), 15u * 15u);
    for (const RetouchQuality& q : report.regions) {
        EXPECT_NEAR(q.height_mm.mean, 0.001 * q.box.x0, 0.1 * 0.001 * q.box.x0);
        EXPECT_LE(q.undamaged.size(), 1u) << "there are enough of them";
    }
}

TEST(Quality, TellsHowMuchTheSurroundingsVaryThemselves) {
    // Even surroundings: a planted step is all there is.
    const Rgb colour(0.36f, 0.3f, 0.25f);
    const RetouchQuality even = Patched(0.12f, colour, 0.02f, 0.3f).quality().regions[0];
    ASSERT_EQ(even.undamaged.size(), 2u);  // left and right; above and below, there is no room
    const auto d65 = static_cast<std::size_t>(Illuminant::d65);
    EXPECT_LT(mean_of(even.undamaged).border_delta_e[d65], 0.1);
    EXPECT_NEAR(mean_of(even.undamaged).height_mm.mean, 0, 0.003);
    EXPECT_LT(mean_of(even.undamaged).gloss_step, 1e-3);
    // Surroundings in stripes differ from themselves as much as a patch of the same stripes does.
    Patched striped(0, Rgb(0.3f), 0.04f, 0.15f);
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 100; ++x)
            striped.surface.diffuse(x, y) = x / 5 % 2 == 0 ? Rgb(0.3f) : Rgb(0.45f, 0.35f, 0.2f);
    const RetouchQuality varied = striped.quality().regions[0];
    ASSERT_FALSE(varied.undamaged.empty());
    const double own = mean_of(varied.undamaged).delta_e[d65];
    EXPECT_GT(own, 3);
    EXPECT_NEAR(varied.delta_e[d65], own, 0.35 * own);
    // No place is left for a yardstick beside a patch that is nearly all of the picture.
    Patched large(0, Rgb(0.3f), 0.04f, 0.15f);
    for (int y = 5; y < 85; ++y)
        for (int x = 5; x < 95; ++x) large.patch(x, y) = 1;
    EXPECT_TRUE(large.quality().regions[0].undamaged.empty());
}

TEST(Quality, SaysWhatIsWrong) {
    const Patched patched(0, Rgb(0.3f), 0.04f, 0.15f);
    const Canvas canvas(std::make_shared<Surface>(patched.surface));
    EXPECT_NE(error_of([&] { quality_of(canvas, Mask(100, 90), {}, kFewLights); }).find("mask is empty"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  quality_of(canvas, patched.patch, Mask(100, 90, 1), kFewLights);
              }).find("--annulus-mm"),
              std::string::npos);
}

TEST(Gloss, DifferencesAreADistance) {
    const Gloss matt{0.01, 0.4, 0.3}, satin{0.04, 0.15, 0.3}, glossy{0.06, 0.05, 0.3};
    EXPECT_EQ(gloss_difference(satin, satin), 0);
    EXPECT_EQ(gloss_difference(matt, glossy), gloss_difference(glossy, matt));
    EXPECT_LE(gloss_difference(matt, glossy),
              gloss_difference(matt, satin) + gloss_difference(satin, glossy));
    // Pellacini et al.: the same reflection shows less on a brighter surface.
    EXPECT_GT(gloss_difference({0.04, 0.1, 0.03}, {0.08, 0.1, 0.03}),
              gloss_difference({0.04, 0.1, 0.9}, {0.08, 0.1, 0.9}));
    EXPECT_EQ(remedy_for(glossy, matt), GlossRemedy::matting_agent);
    EXPECT_EQ(remedy_for(matt, glossy), GlossRemedy::varnish);
    EXPECT_EQ(remedy_for(satin, {0.041, 0.152, 0.3}), GlossRemedy::none);
}

TEST(LookUnderALamp, IsOfOneKindForPaintAndCanvas) {
    // Grey stays grey under every illuminant, painted or not.
    Surface grey(64, 64);
    grey.mm_per_pixel = 0.25, grey.scale_known = true;
    for (Rgb& c : grey.diffuse.pixels()) c = Rgb(0.4f, 0.25f, 0.1f);
    for (float& c : grey.confidence.pixels()) c = 1;
    Canvas canvas(std::make_shared<Surface>(grey));
    const Rgb bare = look_under(canvas, Illuminant::a)(40, 40);
    EXPECT_EQ(look_under(canvas, Illuminant::d65)(40, 40), grey.diffuse(40, 40));
    const Spectrum dry = reflectance_of_rgb(grey.diffuse(40, 40));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(bare[c], to_linear_rgb(dry, Illuminant::a)[c], 1e-5);
    // A trace of paint hardly changes it.
    const IngredientId white = canvas.add(artist_acrylics().at("Titanium White"));
    canvas.writable_wet().writable({0, 0}).writable_plane(white)[0] = 1e-7f;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(look_under(canvas, Illuminant::a)(0, 0)[c], bare[c], 0.005);
}

}  // namespace
}  // namespace tangi
