// retouch_modes_test.cpp: retouches laid in a mask, their lines and colours.
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "paint/canvas/appearance.h"
#include "retouch/colour_match/pigment_pairs.h"
#include "retouch/inpaint/optical_mixing.h"
#include "retouch/inpaint/quality.h"
#include "retouch/inpaint/recipe_json.h"
#include "retouch/inpaint/retouch_modes.h"
#include "retouch/treatment/treatment.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr double kPixel = 0.2;  // [mm]
constexpr int kWide = 200, kHigh = 160;

// A painting that goes from ochre to green from left to right, with a white loss in its middle.
struct Damaged {
    std::shared_ptr<Surface> surface = std::make_shared<Surface>(kWide, kHigh);
    Mask loss{kWide, kHigh};

    Damaged() {
        surface->mm_per_pixel = kPixel;
        surface->scale_known = true;
        for (int y = 0; y < kHigh; ++y)
            for (int x = 0; x < kWide; ++x) {
                const float t = static_cast<float>(x) / (kWide - 1);
                surface->diffuse(x, y) = Rgb(0.35f, 0.22f, 0.08f) * (1 - t) + Rgb(0.12f, 0.25f, 0.10f) * t;
                surface->confidence(x, y) = 1;
                if (std::hypot(x - kWide / 2.0, y - kHigh / 2.0) > 50) continue;
                loss(x, y) = 1;
                surface->diffuse(x, y) = Rgb(0.7f, 0.68f, 0.62f);
            }
    }
    Canvas canvas() const { return Canvas(surface); }
};

RetouchReport laid(Canvas& canvas, const Damaged& damaged, RetouchMode mode) {
    RetouchOptions options;
    options.piles = 4;
    return lay_retouch(canvas, artist_acrylics(), damaged.loss, {}, {mode, "retouch 1", options});
}

TEST(Retouch, StaysInTheMaskWhateverTheMode) {
    const Damaged damaged;
    for (const RetouchMode mode : {RetouchMode::mimetic, RetouchMode::tratteggio, RetouchMode::selection,
                                   RetouchMode::abstraction, RetouchMode::dotting, RetouchMode::neutral}) {
        Canvas canvas = damaged.canvas();
        const std::string hash = sha256_of(canvas.dry());
        const RetouchReport report = laid(canvas, damaged, mode);
        ASSERT_EQ(canvas.dried().size(), 1u);
        const PaintLayer& layer = canvas.dried()[0].paint;
        EXPECT_EQ(on_original(layer, damaged.loss, kPixel).pixels, 0) << name_of(mode);
        // Volumes are those of the report, and of the area at this thickness.
        double volume = 0, reported = 0;
        for (const double v : canvas.volumes_mm3()) volume += v;
        for (const Pile& pile : report.piles) reported += pile.volume_mm3;
        EXPECT_NEAR(volume, reported, 1e-4 * volume) << name_of(mode);
        EXPECT_NEAR(volume, report.painted_mm2 * 0.05, 1e-4 * volume) << name_of(mode);
        EXPECT_NEAR(report.area_mm2, area_of(damaged.loss, kPixel).mm2, 1e-3);
        EXPECT_GT(report.painted_mm2, 0.4 * report.area_mm2) << name_of(mode);
        // Removed, nothing is left of it.
        lift_off(canvas, "retouch 1");
        EXPECT_EQ(sha256_of(canvas.dry()), hash);
        const Surface seen = appearance(canvas);
        EXPECT_EQ(sha256_of(seen), hash) << name_of(mode);
    }
}

TEST(Retouch, MimeticLooksLikeItsSurroundings) {
    const Damaged damaged;
    Canvas canvas = damaged.canvas();
    const RetouchReport report = laid(canvas, damaged, RetouchMode::mimetic);
    for (const Illuminant illuminant : {Illuminant::d65, Illuminant::a, Illuminant::f11})
        EXPECT_LT(report.delta_e_mean[static_cast<std::size_t>(illuminant)], 2) << name_of(illuminant);
    // What was there before the loss is known here: the gradient goes on through it.
    const Surface seen = appearance(canvas);
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
            if (!(damaged.loss(x, y) > 0)) continue;
            const float t = static_cast<float>(x) / (kWide - 1);
            const Rgb truth = Rgb(0.35f, 0.22f, 0.08f) * (1 - t) + Rgb(0.12f, 0.25f, 0.10f) * t;
            sum += delta_e_2000(lab_from_linear(truth), lab_from_linear(seen.diffuse(x, y)));
            ++count;
        }
    EXPECT_LT(sum / count, 2.5);
    EXPECT_LE(report.piles.size(), 4u);
}

// Grounds in one mask: a film that hides neither needs piles of its own over each, and then is as right as
// over either alone.
TEST(Retouch, EachGroundThatShowsThroughHasPilesOfItsOwn) {
    auto surface = std::make_shared<Surface>(kWide, kHigh);
    surface->mm_per_pixel = kPixel;
    Mask light(kWide, kHigh), dark = light;
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
            surface->diffuse(x, y) = Rgb(0.35f, 0.22f, 0.08f);
            surface->confidence(x, y) = 1;
            if (std::hypot(x - 60, y - 80) < 25)
                light(x, y) = 1, surface->diffuse(x, y) = Rgb(0.7f, 0.68f, 0.62f);
            if (std::hypot(x - 140, y - 80) < 20)
                dark(x, y) = 1, surface->diffuse(x, y) = Rgb(0.1f, 0.08f, 0.06f);
        }
    const Mask both = united(light, dark);
    const auto off = [&](const Mask& mask, RetouchMode mode, double thickness_mm, int grounds) {
        Canvas canvas(surface);
        RetouchOptions options;
        options.thickness_mm = thickness_mm;
        const RetouchReport report =
            lay_retouch(canvas, artist_acrylics(), mask, both, {mode, "retouch 1", options});
        EXPECT_EQ(report.grounds, grounds) << name_of(mode);
        const QualityReport quality = quality_of(canvas, mask, both, std::array{Illuminant::d65});
        double worst = 0;
        for (const RetouchQuality& region : quality.regions)
            worst = std::max(worst, region.delta_e[static_cast<std::size_t>(Illuminant::d65)]);
        return worst;
    };
    for (const RetouchMode mode : {RetouchMode::mimetic, RetouchMode::tratteggio}) {
        const double alone = std::max(off(light, mode, 0.01, 1), off(dark, mode, 0.01, 1));
        EXPECT_NEAR(off(both, mode, 0.01, 2), alone, 0.3) << name_of(mode);
    }
    EXPECT_LT(off(both, RetouchMode::mimetic, 2, 1), 2);  // thick paint hides both
}

TEST(Retouch, PairsThatAreAvoidedLieNowhereTogether) {
    const Damaged damaged;
    const std::vector<Pigment>& paints = artist_acrylics().paints;
    for (const RetouchMode mode : {RetouchMode::mimetic, RetouchMode::tratteggio, RetouchMode::dotting}) {
        // What a retouch brings together without a list is what the list forbids.
        Canvas free = damaged.canvas();
        const RetouchReport before = laid(free, damaged, mode);
        std::set<std::pair<int, int>> used = before.blended;
        for (const Pile& pile : before.piles)
            for (std::size_t i = 0; i < static_cast<std::size_t>(pile.mixture.count); ++i)
                for (std::size_t j = 0; j < static_cast<std::size_t>(pile.mixture.count); ++j)
                    if (pile.mixture.paints[i] < pile.mixture.paints[j])
                        used.insert({pile.mixture.paints[i], pile.mixture.paints[j]});
        ASSERT_FALSE(used.empty()) << name_of(mode);
        std::vector<PairWarning> forbidden;
        const PigmentPair pair;
        for (const auto& [a, b] : used) forbidden.push_back({a, b, &pair});
        RetouchOptions options;
        options.piles = 4;
        options.match.allowed = without_pairs(paints.size(), forbidden);
        Canvas canvas = damaged.canvas();
        lay_retouch(canvas, artist_acrylics(), damaged.loss, {}, {mode, "retouch 1", options});
        const PaintLayer& layer = canvas.dried()[0].paint;
        std::set<std::pair<std::string, std::string>> together;
        for (const TileIndex at : layer.painted()) {
            const PaintTile& tile = *layer.tile(at);
            for (const IngredientId a : tile.ingredients)
                for (const IngredientId b : tile.ingredients)
                    for (std::size_t i = 0; i < tile.plane(a).size(); ++i)
                        if (tile.plane(a)[i] > 0 && tile.plane(b)[i] > 0)
                            together.insert({canvas.ingredients()[a].name, canvas.ingredients()[b].name});
        }
        for (const PairWarning& w : forbidden)
            EXPECT_FALSE(together.contains(
                {paints[static_cast<std::size_t>(w.a)].name, paints[static_cast<std::size_t>(w.b)].name}))
                << name_of(mode);
    }
}

TEST(Retouch, LinesFuseToTheColourTheyStandFor) {
    const Damaged damaged;
    for (const RetouchMode mode : {RetouchMode::tratteggio, RetouchMode::selection, RetouchMode::dotting}) {
        Canvas canvas = damaged.canvas();
        const RetouchReport report = laid(canvas, damaged, mode);
        EXPECT_GE(report.piles.size(), 2u) << name_of(mode);
        EXPECT_GT(report.marks, 10) << name_of(mode);
        EXPECT_LT(report.delta_e_mean[static_cast<std::size_t>(Illuminant::d65)], 4) << name_of(mode);
    }
}

TEST(Retouch, NeutralToneIsLessColourful) {
    const Damaged damaged;
    Canvas canvas = damaged.canvas();
    const RetouchReport report = laid(canvas, damaged, RetouchMode::neutral);
    ASSERT_EQ(report.piles.size(), 1u);
    const Lab tone = lab_under(report.piles[0].look);
    const Lab beside = lab_from_linear(Rgb(0.235f, 0.235f, 0.09f));
    EXPECT_LT(std::hypot(tone.a, tone.b), 0.6 * std::hypot(beside.a, beside.b));
    EXPECT_NEAR(tone.l, beside.l - 3, 3);
}

TEST(Retouch, SaysWhatIsWrong) {
    const Damaged damaged;
    Canvas canvas = damaged.canvas();
    EXPECT_NE(error_of([&] {
                  lay_retouch(canvas, artist_acrylics(), Mask(kWide, kHigh), {}, {RetouchMode::mimetic, "r"});
              }).find("mask is empty"),
              std::string::npos);
    RetouchOptions fine;
    fine.width_mm = 0.05;
    EXPECT_NE(
        error_of([&] {
            lay_retouch(canvas, artist_acrylics(), damaged.loss, {}, {RetouchMode::tratteggio, "r", fine});
        }).find("finer than the painting's pixels of 0.2 mm"),
        std::string::npos);
    EXPECT_NE(
        error_of([&] {
            lay_retouch(canvas, artist_acrylics(), Mask(kWide, kHigh, 1), {}, {RetouchMode::mimetic, "r"});
        }).find("covers the whole picture"),
        std::string::npos);
    EXPECT_TRUE(canvas.dried().empty());
}

TEST(Marks, KeepTheirPitch) {
    const Mask all(90, 60, 1);
    const MarkGeometry g{6, 2, 20, 3};
    const Image<int> lines = rasterised(vertical_marks(all, g), all, g.width_px);
    for (int x = 0; x < 90; ++x)
        for (int y = 0; y < 60; ++y) EXPECT_EQ(lines(x, y) >= 0, x % 6 < 2) << x << " " << y;
    const std::vector<Mark> points = dots(all, g);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_GE(glm::length(points[i].path_px[0] - points[j].path_px[0]), 6);
    EXPECT_GT(static_cast<double>(points.size()), 0.6 * 90 * 60 / (6 * 6)) << "as dense as they go";
}

TEST(Marks, FollowTheFormAcrossTheLoss) {
    // Stripes at 30 degrees with a hole.
    Image<float> lightness(120, 120);
    Mask hole(120, 120);
    const double angle = std::numbers::pi / 6;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 120; ++x) {
            lightness(x, y) = static_cast<float>(
                50 + 20 * std::sin((-x * std::sin(angle) + y * std::cos(angle)) * 2 * std::numbers::pi / 10));
            hole(x, y) = std::hypot(x - 60.0, y - 60.0) < 25 ? 1.0f : 0.0f;
        }
    const Image<float> direction = form_direction_rad(lightness, hole, 6);
    for (const auto& [x, y] : {std::pair(60, 60), {50, 70}, {75, 60}}) {
        const double off = std::remainder(static_cast<double>(direction(x, y)) - angle, std::numbers::pi);
        EXPECT_NEAR(off, 0, 0.1) << x << " " << y;
    }
    const MarkGeometry g{5, 2, 40, 1};
    for (const Mark& mark : flow_marks(hole, direction, g)) {
        if (mark.path_px.size() < 20) continue;
        const glm::vec2 along = mark.path_px.back() - mark.path_px.front();
        EXPECT_NEAR(std::remainder(std::atan2(along.y, along.x) - angle, std::numbers::pi), 0, 0.15);
    }
}

TEST(Membrane, IsHarmonic) {
    // x + 2y and x^2 - y^2 solve Laplace's equation on the grid as well.
    for (const bool linear : {true, false}) {
        Image<float> values(80, 70);
        Mask hole(80, 70);
        const auto truth = [&](int x, int y) {
            const float u = static_cast<float>(x) / 40 - 1, v = static_cast<float>(y) / 40 - 1;
            return linear ? u + 2 * v : u * u - v * v;
        };
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 80; ++x) {
                hole(x, y) = std::hypot(x - 38.0, y - 33.0) < 24 ? 1.0f : 0.0f;
                values(x, y) = hole(x, y) > 0 ? 99.0f : truth(x, y);
            }
        membrane_into(values, hole);
        float most = 0;
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 80; ++x) most = std::max(most, std::abs(values(x, y) - truth(x, y)));
        EXPECT_LT(most, 0.01f) << linear;
    }
}

TEST(Inpainting, OfEveryKindFillsTheHoleOnly) {
    const Damaged damaged;
    for (const Inpainting method : {Inpainting::membrane, Inpainting::telea, Inpainting::navier_stokes}) {
        Image<Rgb> colours = damaged.surface->diffuse;
        inpaint_into(colours, damaged.loss, method);
        for (int y = 0; y < kHigh; ++y)
            for (int x = 0; x < kWide; ++x) {
                if (!(damaged.loss(x, y) > 0)) {
                    ASSERT_EQ(colours(x, y), damaged.surface->diffuse(x, y));
                    continue;
                }
                const float t = static_cast<float>(x) / (kWide - 1);
                const Rgb truth = Rgb(0.35f, 0.22f, 0.08f) * (1 - t) + Rgb(0.12f, 0.25f, 0.10f) * t;
                ASSERT_LT(delta_e_2000(lab_from_linear(truth), lab_from_linear(colours(x, y))), 12)
                    << name_of(method) << " " << x << " " << y;
            }
    }
}

TEST(Surroundings, TellTheCommonestColour) {
    Damaged damaged;
    // A fifth of the surroundings is dark dirt, which the mode is not drawn to, as a mean would be.
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x)
            damaged.surface->diffuse(x, y) = (x * 7 + y * 13) % 5 == 0 ? Rgb(0.01f) : Rgb(0.3f, 0.2f, 0.1f);
    const Annulus round = annulus_of(*damaged.surface, damaged.loss, {});
    EXPECT_LT(delta_e_2000(lab_from_linear(round.mode), lab_from_linear({0.3f, 0.2f, 0.1f})), 0.5);
    EXPECT_LT(round.spread, 0.5);
    EXPECT_GT(round.pixels, 1000);
    EXPECT_NE(error_of([&] {
                  annulus_of(*damaged.surface, damaged.loss, Mask(kWide, kHigh, 1));
              }).find("--annulus-mm"),
              std::string::npos);
}

TEST(Juxtaposition, MixesByArea) {
    std::vector<Spectrum> looks;
    for (const char* name :
         {"Titanium White", "Bone Black", "Pyrrole Red", "Cobalt Blue", "Diarylide Yellow"}) {
        const Pigment& paint = artist_acrylics().at(name);
        looks.push_back(opaque_look({paint.k, paint.s}));
    }
    Spectrum target{}, bare;
    bare.fill(0.7f);
    // 0.2 bare; the rest 1/4 white, 1/4 red, 1/2 blue.
    for (std::size_t band = 0; band < kBands; ++band)
        target[band] = 0.2f * bare[band] +
                       0.8f * (0.25f * looks[0][band] + 0.25f * looks[2][band] + 0.5f * looks[3][band]);
    const std::vector<Illuminant> illuminants = {Illuminant::d65, Illuminant::a, Illuminant::f11};
    const Juxtaposition found = juxtapose(looks, target, illuminants, bare, 0.2);
    EXPECT_LT(found.delta_e, 2.5);
    double sum = 0;
    for (const double share : found.shares) sum += share;
    EXPECT_NEAR(sum, 1, 1e-9);
}

}  // namespace
}  // namespace tangi
