// white_balances_test.cpp: white balance that changes from photograph to photograph, and what only
// looks like that.
#include "capture/radiometry/white_balances.h"

#include <gmock/gmock.h>

#include "capture/colour_chart/colour_calibration.h"
#include "datasets/generator.h"
#include "surface/image_file/image_io.h"
#include "tests/support/capture/chart_pictures.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kCastPhotos = 16;
constexpr int kCastSide = 40;

// A survey of a matt painting with some gloss under lights all around; `tint` may change a linear value.
template <class Tint>
Survey surveyed(const Tint& tint, double saturation = 0.5, float encode_to = 1) {
    Random random(4);
    Survey s;
    s.photos.resize(kCastPhotos);
    for (int y = 0; y < kCastSide; ++y)
        for (int x = 0; x < kCastSide; ++x) {
            s.positions.emplace_back(x, y);
            const Rgb paint = Rgb(random.real(0.08, 0.6)) * Rgb(std::exp(saturation * random.normal()), 1,
                                                                std::exp(saturation * random.normal()));
            const glm::dvec2 slope = 0.2 * glm::dvec2(random.normal(), random.normal());
            const bool glossy = random.real(0, 1) < 0.2;
            for (std::size_t i = 0; i < kCastPhotos; ++i) {
                const double around = 2.4 * static_cast<double>(i), up = 0.5 + 0.06 * static_cast<double>(i);
                const double n_l = std::max(0.0, std::sin(up) - std::cos(up) * (slope.x * std::cos(around) +
                                                                                slope.y * std::sin(around)));
                Rgb value = paint * static_cast<float>(0.7 * n_l);
                if (glossy && random.real(0, 1) < 0.2) value += Rgb(0.4f);
                value = tint(i, x, y, value);
                for (int c = 0; c < 3; ++c)
                    s.values.push_back(std::clamp(
                        encode_to * (value[c] + 0.002f * static_cast<float>(random.normal())), 0.0f, 1.0f));
            }
        }
    return s;
}

WhiteBalances balances_of(const Survey& survey) { return white_balances(survey, Transfer{}, kClipped, 16); }

void expect_gain(const WhiteBalances& found, std::size_t photo, const Rgb& gain) {
    SCOPED_TRACE(photo);
    EXPECT_NEAR(found.gain(photo).r, gain.r, 0.015 * gain.r);
    EXPECT_NEAR(found.gain(photo).g, 1, 1e-6);
    EXPECT_NEAR(found.gain(photo).b, gain.b, 0.015 * gain.b);
}

TEST(WhiteBalances, AreAlikeWherePhotographsAre) {
    const WhiteBalances found = balances_of(surveyed([](std::size_t, int, int, const Rgb& v) { return v; }));
    ASSERT_EQ(found.photos.size(), kCastPhotos);
    EXPECT_EQ(found.differing(), 0);
    EXPECT_EQ(found.unclear(), 0);
    const std::vector<std::string> names(kCastPhotos, "a.png");
    EXPECT_EQ(warning_of(found, names, "here"), "");
    EXPECT_TRUE(to_json(found, names).empty());
}

// A dome whose lights have colours of all kinds: what they differ by from their mean is told, and not undone,
// since nobody knows the colour of a light that was not photographed.
TEST(WhiteBalances, OfLightsOfManyColoursAreBesideTheirMean) {
    const auto red = [](std::size_t i) { return 1 + 0.25f * std::sin(1.7f * static_cast<float>(i)); };
    const WhiteBalances found =
        balances_of(surveyed([&](std::size_t i, int, int, const Rgb& v) { return v * Rgb(red(i), 1, 1); }));
    EXPECT_EQ(found.differing(), 0);
    EXPECT_GT(2 * found.unclear(), static_cast<int>(kCastPhotos));
    double mean = 0;
    for (std::size_t i = 0; i < kCastPhotos; ++i) mean += std::log(red(i)) / kCastPhotos;
    for (std::size_t i = 0; i < kCastPhotos; ++i)
        EXPECT_NEAR(found.photos[i].log_gain.x, std::log(red(i)) - mean, 0.015) << i;
    const std::vector<std::string> names(kCastPhotos, "a.png");
    EXPECT_THAT(warning_of(found, names, "here"),
                AllOf(HasSubstr("colours change"), HasSubstr("lights of several colours")));
}

TEST(WhiteBalances, ThatDifferAreMeasured) {
    const Rgb cast(1.25f, 1, 0.7f);
    // Every second one: the first has what counts as usual.
    const WhiteBalances halves =
        balances_of(surveyed([&](std::size_t i, int, int, const Rgb& v) { return i % 2 ? v * cast : v; }));
    for (std::size_t i = 0; i < kCastPhotos; ++i) expect_gain(halves, i, i % 2 ? cast : Rgb(1));
    // One of all, and of another exposure.
    const WhiteBalances one = balances_of(surveyed(
        [&](std::size_t i, int, int, const Rgb& v) { return i == 3 ? 0.6f * v * Rgb(0.9f, 1, 1.08f) : v; }));
    for (std::size_t i = 0; i < kCastPhotos; ++i) expect_gain(one, i, i == 3 ? Rgb(0.9f, 1, 1.08f) : Rgb(1));
    // A drift: those in the middle, or the most that are alike, are the usual ones.
    const auto drift = [](std::size_t i) { return 0.02 * static_cast<double>(i); };
    const WhiteBalances drifting = balances_of(surveyed([&](std::size_t i, int, int, const Rgb& v) {
        return v * Rgb(std::exp(drift(i)), 1, std::exp(-drift(i)));
    }));
    for (std::size_t i = 1; i < kCastPhotos; ++i) {
        const glm::dvec2 step = drifting.photos[i].log_gain - drifting.photos[0].log_gain;
        EXPECT_NEAR(step.x, drift(i), 0.01);
        EXPECT_NEAR(step.y, -drift(i), 0.01);
    }
    EXPECT_GT(drifting.differing() + drifting.unclear(), 8);
}

TEST(WhiteBalances, StateErrorsThatHold) {
    const WhiteBalances found = balances_of(surveyed(
        [](std::size_t i, int, int, const Rgb& v) { return i % 4 == 1 ? v * Rgb(1.1f, 1, 0.9f) : v; }));
    int inside = 0;
    for (std::size_t i = 0; i < kCastPhotos; ++i) {
        const glm::dvec2 truth = i % 4 == 1 ? glm::dvec2(std::log(1.1), std::log(0.9)) : glm::dvec2(0);
        for (int c = 0; c < 2; ++c) {
            inside += std::abs(found.photos[i].log_gain[c] - truth[c]) < 2 * found.photos[i].sigma[c];
            EXPECT_LT(found.photos[i].sigma[c], 0.02);
        }
    }
    EXPECT_GE(inside, 0.9 * 2 * kCastPhotos);
}

// White light over a picture that is yellowish as a whole makes all of it bluer, but the yellower the more.
TEST(WhiteBalances, AreNotAVeilOfWhite) {
    const WhiteBalances found = balances_of(surveyed([](std::size_t i, int, int, const Rgb& v) {
        const Rgb yellow = v * Rgb(1.3f, 1, 0.5f);
        return i % 3 == 0 ? yellow + Rgb(0.1f * yellow.g) : yellow;
    }));
    EXPECT_EQ(found.differing(), 0);
}

// A second light of another colour that reaches one side more: what is undone makes no quarter worse.
TEST(WhiteBalances, OfPartsOfThePictureAreToldAndLeft) {
    const auto beside_light = [](double left, double right) {
        return balances_of(surveyed([=](std::size_t i, int x, int, const Rgb& v) {
            const double at = left + (right - left) * x / kCastSide;
            return i == 5 ? v * Rgb(std::exp(at), 1, 1) : v;
        }));
    };
    const WhiteBalances found = beside_light(-0.3, 0.4);
    EXPECT_EQ(found.differing(), 0);
    EXPECT_TRUE(found.photos[5].unclear);
    EXPECT_EQ(found.unclear(), 1);
    const std::vector<std::string> names(kCastPhotos, "a.png");
    EXPECT_THAT(warning_of(found, names, "here"),
                AllOf(HasSubstr("here: colours change"), HasSubstr("is not undone")));
    const WhiteBalances more = beside_light(0.2, 0.4);
    EXPECT_EQ(more.differing(), 1);
    EXPECT_NEAR(more.photos[5].log_gain.x, 0.3, 0.03);
}

TEST(WhiteBalances, ReferToThoseOfAChart) {
    const Rgb cast(1.25f, 1, 0.8f);
    WhiteBalances found =
        balances_of(surveyed([&](std::size_t i, int, int, const Rgb& v) { return i % 2 ? v * cast : v; }));
    std::vector<std::optional<glm::dvec2>> chart(kCastPhotos);
    for (std::size_t i = 0; i < 6; ++i)
        chart[i] = i % 2 ? glm::dvec2(0) : glm::dvec2(-std::log(1.25), -std::log(0.8));
    found.refer_to(chart);
    for (std::size_t i = 0; i < kCastPhotos; ++i) expect_gain(found, i, i % 2 ? Rgb(1) : Rgb(1) / cast);
}

TEST(WhiteBalances, BesideWhatIsExpected) {
    Random random(2);
    std::vector<Rgb> expected, seen;
    std::vector<int> part;
    for (int i = 0; i < 400; ++i) {
        expected.emplace_back(random.real(0.1, 0.6), random.real(0.1, 0.6), random.real(0.1, 0.6));
        seen.push_back(0.8f * expected.back() * Rgb(1.1f, 1, 0.85f));
        part.push_back(i % 4);
    }
    const WhiteBalance found = white_balance_beside(expected, seen, part, {0, 0, 1});
    EXPECT_TRUE(found.differs);
    EXPECT_NEAR(found.gain().r, 1.1, 0.01);
    EXPECT_NEAR(found.gain().b, 0.85, 0.01);
}

// Photographs that the generator renders, of paint as `change` makes it, their channels times `gains`; in 8
// bits, sRGB, as JPEG has them without its losses, or with 16 bits of linear light.
template <class Change>
struct CastRendering {
    PaintingTruth truth;
    GeneratorOptions options;
    std::vector<Light> lights;
    std::vector<Image<Rgb>> photos;

    CastRendering(std::uint64_t seed, GeneratorOptions o, const Change& change, bool gilding = false)
        : truth(procedural_painting(
              {.seed = seed, .width = 72, .height = 54, .mm_per_pixel = 1.5, .gilding = gilding})),
          options(o) {
        options.seed = seed;
        options.held_out = 0;
        for (int y = 0; y < truth.height(); ++y)
            for (int x = 0; x < truth.width(); ++x) change(truth, x, y);
        for (const Photography::Photo& photo : photography_of(truth, options).photos) {
            lights.push_back(photo.light);
            photos.push_back(render_photo(truth, photo.light, options));
        }
    }

    WhiteBalances balances(const std::vector<Rgb>& gains, bool of_8_bits) const {
        const Transfer transfer{of_8_bits ? Transfer::Kind::srgb : Transfer::Kind::linear};
        const float codes = of_8_bits ? 255.0f : 65535.0f;
        Survey s;
        s.photos.resize(photos.size());
        std::vector<Image<Rgb>> sensed;
        for (std::size_t i = 0; i < photos.size(); ++i) {
            Image<Rgb> cast = photos[i];
            for (Rgb& v : cast.pixels()) v *= gains[i];
            sensed.push_back(apply_sensor(cast, options, static_cast<int>(i)));
        }
        for (int y = 0; y < truth.height(); ++y)
            for (int x = 0; x < truth.width(); ++x) {
                s.positions.emplace_back(x, y);
                for (const Image<Rgb>& photo : sensed)
                    for (int c = 0; c < 3; ++c)
                        s.values.push_back(
                            std::round(codes * transfer.encode(std::clamp(photo(x, y)[c], 0.0f, 1.0f))) /
                            codes);
            }
        return white_balances(s, transfer, kClipped, of_8_bits ? 8 : 16, lights);
    }
};

float grey_of(const Rgb& v) { return 0.3f * v.r + 0.6f * v.g + 0.1f * v.b; }

// A varnished brown board: gloss makes it whiter in photographs whose light is high, all of it, as a cast
// would.
void brown_board(PaintingTruth& t, int x, int y) {
    t.diffuse(x, y) = grey_of(t.diffuse(x, y)) * Rgb(1.2f, 1, 0.5f);
    t.specular(x, y) = 0.05f;
    t.roughness(x, y) = 0.35f;
}

// A painting on a ground of gold, which takes two thirds of the picture.
void gold_ground(PaintingTruth& t, int x, int y) {
    const float u = static_cast<float>(x) / static_cast<float>(t.width()) - 0.5f,
                v = static_cast<float>(y) / static_cast<float>(t.height()) - 0.5f;
    if (u * u + 1.2f * v * v < 0.1f) return;
    t.diffuse(x, y) = grey_of(t.diffuse(x, y)) * Rgb(0.3f, 0.18f, 0.08f);
    t.specular(x, y) = 0.5f;
    t.roughness(x, y) = 0.32f;
    t.specular_colour(x, y) = Rgb(1, 0.78f, 0.34f);
}

void as_painted(PaintingTruth&, int, int) {}

template <class Change>
void expect_honest(const Change& change, bool gilding) {
    for (const std::uint64_t seed : {11u, 12u, 13u})
        for (const bool ring : {false, true}) {
            GeneratorOptions options{.lights = ring ? 12 : 24};
            if (ring) options.min_elevation_deg = options.max_elevation_deg = 45;
            const CastRendering rendering(seed, options, change, gilding);
            for (const bool of_8_bits : {false, true}) {
                const WhiteBalances found =
                    rendering.balances(std::vector<Rgb>(rendering.lights.size(), Rgb(1)), of_8_bits);
                EXPECT_EQ(found.differing() + found.unclear(), 0)
                    << seed << " " << ring << " " << of_8_bits << " "
                    << warning_of(found, std::vector<std::string>(rendering.lights.size(), "a"), "b");
            }
        }
}

TP_LONG TEST(RenderedWhiteBalances, OfPaintAreAlike) { expect_honest(as_painted, false); }
TP_LONG TEST(RenderedWhiteBalances, OfAVarnishedBoardAreAlike) { expect_honest(brown_board, false); }
TP_LONG TEST(RenderedWhiteBalances, OfAGoldGroundAreAlike) { expect_honest(gold_ground, true); }

// Where photographs are of another colour this is said, whatever they show, and those that are not are left.
template <class Change>
void expect_found(const Change& change, bool gilding, double within) {
    for (const std::uint64_t seed : {21u, 22u}) {
        const CastRendering rendering(seed, {.lights = 24}, change, gilding);
        std::vector<Rgb> gains(24, Rgb(1));
        for (std::size_t i = 0; i < gains.size(); i += 3) gains[i] = {1.2f, 1, 0.8f};
        const WhiteBalances found = rendering.balances(gains, true);
        EXPECT_GT(found.differing(), 0);
        for (std::size_t i = 0; i < gains.size(); ++i) {
            const WhiteBalance& b = found.photos[i];
            if (!b.differs) continue;
            EXPECT_NEAR(b.gain().r, gains[i].r, within) << seed << " " << i << " ± " << b.sigma.x;
            EXPECT_NEAR(b.gain().b, gains[i].b, within) << seed << " " << i << " ± " << b.sigma.y;
        }
    }
}

TEST(RenderedWhiteBalances, OfPaintAreFound) { expect_found(as_painted, false, 0.02); }
TEST(RenderedWhiteBalances, OfAVarnishedBoardAreFound) { expect_found(brown_board, false, 0.06); }
TEST(RenderedWhiteBalances, OfAGoldGroundAreFound) { expect_found(gold_ground, true, 0.06); }

// Photographs of a chart under lights, every second one with another white balance.
std::vector<std::filesystem::path> chart_photos(const std::filesystem::path& folder, const Rgb& cast) {
    std::vector<std::filesystem::path> paths;
    for (int i = 0; i < 8; ++i) {
        Image<Rgb> picture(300, 230, Rgb(0.1f));
        draw_chart(picture, chart_map(turned_corners({150, 115}, 200, 0, 0.05)), classic_chart());
        for (int y = 0; y < 230; ++y)
            for (int x = 0; x < 300; ++x)
                picture(x, y) *=
                    (i % 2 ? cast : Rgb(1)) * (0.5f + 0.2f * static_cast<float>(i % 3 ? x : 300 - x) / 300);
        add_noise(picture, 0.01, 0.001, static_cast<std::uint64_t>(i) + 5);
        paths.push_back(folder / fmt::format("chart_{}.exr", i));
        write_picture(paths.back(), picture, {});
    }
    return paths;
}

TEST(ChartWhiteBalances, AreUndoneAndTold) {
    const Rgb cast(1.25f, 1, 0.75f);
    const TestDir dir, other;
    const auto plain = calibrate_colours(chart_photos(dir.path(), Rgb(1)), {});
    const auto mixed = calibrate_colours(chart_photos(other.path(), cast), {});
    ASSERT_TRUE(plain && mixed);
    EXPECT_EQ(plain->white_balances.differing(), 0);
    EXPECT_THAT(plain->warnings, Each(Not(HasSubstr("white balance"))));
    EXPECT_EQ(mixed->white_balances.differing(), 4);
    for (std::size_t i = 0; i < 8; ++i) expect_gain(mixed->white_balances, i, i % 2 ? cast : Rgb(1));
    EXPECT_THAT(mixed->warnings, Contains(AllOf(HasSubstr("white balance"), HasSubstr("4 of 8 differ"))));
    EXPECT_THAT(mixed->warnings, Each(Not(HasSubstr("a shadow or a highlight"))));
    // What is said of the chart holds for every photograph, by itself.
    ASSERT_EQ(mixed->correction.of_photos.size(), 8u);
    for (const auto& photo : mixed->correction.of_photos)
        EXPECT_LT(photo.after.mean, mixed->correction.after.mean + 0.7);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mixed->correction.white_balance[c], plain->correction.white_balance[c], 0.02);
    const nlohmann::json j = to_json(*mixed);
    EXPECT_EQ(j["white_balances"].size(), 8u);
    EXPECT_NEAR(j["white_balances"][1]["red"].get<double>(), 1.25, 0.02);
    EXPECT_THAT(colour_section(*mixed), HasSubstr("white balance of 4 of them differs"));
}

// Without that, casts of opposite colours make a good mean of bad photographs.
TEST(ChartWhiteBalances, AreJudgedPhotographByPhotograph) {
    const TestDir dir;
    const auto plain = calibrate_colours(chart_photos(dir.path(), Rgb(1)), {});
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->tolerances[0].level, "4 stars");
    ColourCorrection c = plain->correction;
    ASSERT_FALSE(c.of_photos.empty());
    c.of_photos[3].after.mean = 9;
    c.of_photos[3].after_flat.mean = 9;
    for (const ToleranceResult& result : judge_colours(c)) EXPECT_NE(result.level, "A");
    EXPECT_EQ(judge_colours(c)[0].level, "");
    EXPECT_EQ(c.worst_photo(), 3u);
}

}  // namespace
}  // namespace tangi
