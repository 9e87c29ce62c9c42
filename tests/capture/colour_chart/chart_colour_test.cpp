// Colours from charts: laws of the solution, light that is uneven, patches that are wrong, and levels of
// guidelines.
#include <gmock/gmock.h>

#include "capture/colour_chart/colour_tolerance.h"
#include "tests/support/capture/chart_pictures.h"

namespace tangi {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;
using testing::Contains;
using testing::HasSubstr;

// What a light at `light` (in pitches of the chart, as is z) makes of a patch, 1 at most.
double light_of_its_own(std::size_t patch, const dvec3& light) {
    const dvec3 place(static_cast<double>(patch % 6) + 0.5, static_cast<double>(patch / 6) + 0.5, 0);
    const dvec3 ray = light - place;
    return 100 * ray.z / std::pow(glm::length(ray), 3);
}

// A reading of each patch by a camera, in the light of a light. Values are exact but for rounding.
ChartReading reading_of(const ChartReference& reference, const dmat3& camera, const dvec3& light,
                        double relative_noise = 0, std::uint64_t seed = 1) {
    Random random(seed);
    ChartReading reading{fmt::format("{}.png", seed), {}};
    for (std::size_t i = 0; i < 24; ++i) {
        dvec3 value = light_of_its_own(i, light) * (camera * dvec3(reference.patches[i].linear));
        for (int k = 0; k < 3; ++k) value[k] *= 1 + relative_noise * random.normal();
        reading.patches[i] = {Rgb(value), Rgb(value * relative_noise) + 1e-6f, 400, PatchState::good};
    }
    return reading;
}

const dvec3 kFarLight(3, 2, 1e3);

std::vector<ChartReading> several(double noise = 0) {
    std::vector<ChartReading> photos;
    for (std::uint64_t i = 0; i < 6; ++i) {
        const double turn = static_cast<double>(i);
        photos.push_back(reading_of(classic_chart(), kTestCamera,
                                    {3 + 20 * std::cos(turn), 2 + 20 * std::sin(turn), 30}, noise, i + 1));
    }
    return photos;
}

TEST(ChartColour, IsExactWhereTheCameraIsAMatrix) {
    const std::vector<ChartReading> photos = {reading_of(classic_chart(), kTestCamera, kFarLight)};
    const ColourCorrection c = correct_colours(photos, classic_chart(), {});
    ASSERT_TRUE(c.matrix_solved);
    EXPECT_EQ(c.patches_used, 24);
    EXPECT_GT(c.before.mean, 3);
    EXPECT_TRUE(c.neutral_kept);
    EXPECT_LT(c.after.mean, 0.01);  // though the chart's greys are not quite neutral
    const ColourCorrection open = correct_colours(photos, classic_chart(), {.neutral_cost = 0});
    EXPECT_FALSE(open.neutral_kept);
    EXPECT_LT(open.after.maximum, 2e-3);
    EXPECT_LT(open.cross_validated.maximum, 5e-3);
    // The matrix is the camera's inverse, up to brightness.
    const dmat3 product = open.total() * kTestCamera;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(product[i][k] / product[1][1], i == k, 2e-4) << i << k;
}

TEST(ChartColour, KeepsGreysGreyAndBrightness) {
    const std::vector<ChartReading> photos = several();
    const ColourCorrection c = correct_colours(photos, classic_chart());
    ASSERT_TRUE(c.neutral_kept);
    for (int row = 0; row < 3; ++row)
        EXPECT_NEAR(c.matrix[0][row] + c.matrix[1][row] + c.matrix[2][row], 1, 1e-9);
    EXPECT_EQ(c.white_balance.g, 1);
    const ColourCorrection open = correct_colours(photos, classic_chart(), {.neutral_cost = 0});
    EXPECT_NEAR(luminance(Rgb(open.matrix * dvec3(1))), 1, 1e-6);
    EXPECT_THAT(open.warnings, Contains(HasSubstr("greys are not kept exactly grey")));
    EXPECT_TRUE(correct_colours(photos, classic_chart(), {.neutral_cost = 0, .keep_neutral_always = true})
                    .neutral_kept);
    // Brightness does not change what is found.
    std::vector<ChartReading> dark = photos;
    for (ChartReading& photo : dark)
        for (PatchReading& p : photo.patches) p.mean *= 0.25f, p.sigma *= 0.25f;
    const ColourCorrection same = correct_colours(dark, classic_chart());
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(same.total()[i][k], c.total()[i][k], 1e-3);
}

TEST(ChartColour, DoesNotMindUnevenLight) {
    // Twice as bright on one side as on the other.
    const dvec3 light(-5, 2, 9);
    ASSERT_GT(light_of_its_own(6, light) / light_of_its_own(11, light), 2);
    const std::vector<ChartReading> one = {reading_of(classic_chart(), kTestCamera, light)};
    const ColourCorrection c = correct_colours(one, classic_chart());
    EXPECT_EQ(c.light_degree, 2);
    EXPECT_LT(c.after.mean, 0.5);
    EXPECT_LT(c.cross_validated.mean, 0.7);
    EXPECT_GT(correct_colours(one, classic_chart(), {.light_degree = 1}).after.mean, c.after.mean);
    EXPECT_LT(correct_colours(several(), classic_chart()).after.mean, 0.2);
}

TEST(ChartColour, IsMoreCertainFromMorePhotographs) {
    std::vector<double> errors;
    for (const std::size_t count : {1u, 6u}) {
        double sum = 0;
        for (std::uint64_t trial = 0; trial < 5; ++trial) {
            std::vector<ChartReading> photos;
            for (std::uint64_t i = 0; i < count; ++i)
                photos.push_back(
                    reading_of(classic_chart(), kTestCamera, kFarLight, 0.02, 100 * trial + i + 1));
            const ColourCorrection c = correct_colours(photos, classic_chart(), {.light_degree = 1});
            EXPECT_GT(c.cross_validated.mean, c.after.mean);
            EXPECT_GT(c.before.mean, c.after.mean);
            sum += c.cross_validated.mean;
        }
        errors.push_back(sum / 5);
    }
    EXPECT_LT(errors[1], 0.6 * errors[0]);
}

TEST(ChartColour, LeavesPatchesInShadowOut) {
    std::vector<ChartReading> photos = several(0.002);
    const ColourCorrection clean = correct_colours(photos, classic_chart());
    for (const std::size_t i : {0, 1, 6, 18}) photos[2].patches[i].mean *= 0.3f;
    photos[4].patches[14].mean += 0.2f;  // a highlight
    const ColourCorrection c = correct_colours(photos, classic_chart());
    for (std::size_t i = 0; i < 24; ++i)
        EXPECT_EQ(c.lights.outliers[2][i], i == 0 || i == 1 || i == 6 || i == 18) << i;
    EXPECT_THAT(c.warnings,
                Contains(HasSubstr("3.png: the chart's patch 1, 2, 7, 19 does not fit the others")));
    EXPECT_THAT(c.warnings, Contains(HasSubstr("5.png: the chart's patch 15 does not fit the others")));
    EXPECT_NEAR(c.after.mean, clean.after.mean, 0.05);
    EXPECT_EQ(c.patches_used, 24);
}

TEST(ChartColour, TakesAReferenceThatIsALittleOffForNoShadow) {
    ChartReference made = classic_chart();
    made.patches[23].linear *= 1.25f;  // a black that is not as black as it should be
    std::vector<ChartReading> photos;
    for (std::uint64_t i = 0; i < 4; ++i)
        photos.push_back(reading_of(made, kTestCamera, kFarLight, 0.002, i + 1));
    const ColourCorrection c = correct_colours(photos, classic_chart());
    EXPECT_THAT(c.warnings, testing::IsEmpty());
    EXPECT_EQ(c.lights.photos[23], 4);
}

TEST(ChartColour, WithTooFewPatchesIsWhiteBalanceOnly) {
    std::vector<ChartReading> photos = {reading_of(classic_chart(), kTestCamera, kFarLight)};
    for (std::size_t i = 0; i < 24; ++i)
        if (i < 16) photos[0].patches[i].state = PatchState::clipped;
    const ColourCorrection c = correct_colours(photos, classic_chart());
    EXPECT_FALSE(c.matrix_solved);
    EXPECT_EQ(c.patches_used, 8);
    EXPECT_EQ(c.matrix, dmat3(1));
    EXPECT_THAT(c.warnings, Contains(HasSubstr("8 patches of the colour chart can be used")));
    const Rgb grey = c.apply(photos[0].patches[20].mean);
    EXPECT_NEAR(grey.r / grey.g, 1, 0.04);
    EXPECT_NEAR(grey.b / grey.g, 1, 0.04);
    EXPECT_LT(c.after.patches[0], 0);
    EXPECT_FALSE(to_json(c, classic_chart()).dump().empty());
}

TEST(ChartColour, WithJustEnoughPatchesHasAMatrixButNoPrediction) {
    std::vector<ChartReading> photos = {reading_of(classic_chart(), kTestCamera, kFarLight)};
    const std::vector<std::size_t> kept = {0, 2, 5, 12, 13, 14, 15, 19, 21};
    for (std::size_t i = 0; i < 24; ++i)
        if (std::find(kept.begin(), kept.end(), i) == kept.end())
            photos[0].patches[i].state = PatchState::clipped;
    const ColourCorrection c = correct_colours(photos, classic_chart());
    EXPECT_TRUE(c.matrix_solved);
    EXPECT_EQ(c.patches_used, 9);
    EXPECT_LT(c.after.mean, 0.05);
    EXPECT_TRUE(std::isnan(c.cross_validated.mean));
    EXPECT_EQ(to_json(c, classic_chart())["delta_e_2000"]["cross_validated"], nullptr);
    // One more is enough for one.
    photos[0].patches[8].state = PatchState::good;
    EXPECT_GE(correct_colours(photos, classic_chart()).cross_validated.mean, 0);
}

TEST(ChartColour, OfAGreyCameraIsWhiteBalanceOnly) {
    const dmat3 grey(0.2, 0.2, 0.2, 0.7, 0.7, 0.7, 0.1, 0.1, 0.1);
    const std::vector<ChartReading> photos = {reading_of(classic_chart(), grey, kFarLight, 0.005)};
    const ColourCorrection c = correct_colours(photos, classic_chart());
    EXPECT_FALSE(c.matrix_solved);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("only white balance was solved")));
}

TEST(ChartColour, WithoutAnyPatchIsAnError) {
    std::vector<ChartReading> photos = {reading_of(classic_chart(), kTestCamera, kFarLight)};
    for (PatchReading& p : photos[0].patches) p.state = PatchState::outside;
    EXPECT_THAT(error_of([&] { correct_colours(photos, classic_chart()); }),
                HasSubstr("no patch of the colour chart"));
    EXPECT_THAT(error_of([] { correct_colours({}, classic_chart()); }), HasSubstr("no photograph"));
    EXPECT_THAT(error_of([&] { correct_colours(photos, classic_chart(), {.light_degree = 3}); }),
                HasSubstr("chart_colour.light_degree = 3 is outside [0, 2]"));
}

TEST(ChartColour, OfAPhotographWithFewPatchesIsLeftOut) {
    std::vector<ChartReading> photos = several();
    for (std::size_t i = 3; i < 24; ++i) photos[1].patches[i].state = PatchState::outside;
    const ColourCorrection c = correct_colours(photos, classic_chart());
    EXPECT_FALSE(c.lights.lights[1].known);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("2.png: only 3 patches of the chart can be used; rejected")));
    EXPECT_EQ(c.lights.photos[10], 5);
}

TEST(ChartColour, OfAPhotographWhoseLightFailedIsLeftOut) {
    std::vector<ChartReading> photos = several(0.003);
    const ColourCorrection without =
        correct_colours(std::vector(photos.begin() + 1, photos.end()), classic_chart());
    for (PatchReading& patch : photos[0].patches) patch.mean = Rgb(0), patch.sigma = Rgb(0);
    const ColourCorrection c = correct_colours(photos, classic_chart());
    EXPECT_FALSE(c.lights.lights[0].known);
    EXPECT_THAT(c.warnings, ElementsAre(HasSubstr("1.png: the chart is black in it")));
    EXPECT_NEAR(c.after.mean, without.after.mean, 1e-6);
}

TEST(ChartColour, GoesFromPicturesToPictures) {
    // The whole way: two pictures with uneven light, noise and the camera's primaries.
    const ChartReference reference = classic_chart();
    std::vector<ChartReading> photos;
    Image<Rgb> last;
    for (std::uint64_t i = 0; i < 2; ++i) {
        Image<Rgb> picture(420, 320, Rgb(0.1f));
        const ChartCorners corners = turned_corners({210, 160}, 240, 90, 0.1);
        draw_chart(picture, chart_map(corners), reference);
        for (int y = 0; y < 320; ++y)
            for (int x = 0; x < 420; ++x)
                picture(x, y) *= 0.5f + 0.4f * static_cast<float>(i ? x : 420 - x) / 420;
        add_noise(picture, 0.02, 0.001, i + 5);
        const auto chart = find_chart(picture);
        ASSERT_TRUE(chart);
        photos.push_back(read_chart(picture, *chart, "p"));
        last = picture;
    }
    const ColourCorrection c = correct_colours(photos, reference);
    EXPECT_LT(c.after.mean, 0.6);
    const Image<Rgb> result = corrected(last, c);
    EXPECT_LT(glm::length(result(200, 150) - c.apply(last(200, 150))), 1e-6);
    const auto again = find_chart(result);
    ASSERT_TRUE(again);
    EXPECT_LT(correct_colours(std::vector{read_chart(result, *again)}, reference).before.mean, 0.8);
}

TEST(ChartColour, IsToldAsJson) {
    const ColourCorrection c = correct_colours(several(0.01), classic_chart());
    const nlohmann::json j = to_json(c, classic_chart());
    EXPECT_EQ(j["patches"].size(), 24u);
    EXPECT_EQ(j["patches"][18]["name"], "white 9.5");
    EXPECT_EQ(j["delta_e_2000"]["after"]["mean"], c.after.mean);
    EXPECT_EQ(j["matrix"][0][1], c.matrix[1][0]);
    EXPECT_EQ(j.dump().find("nan"), std::string::npos);
}

ColourCorrection with_errors(double neutral, double mean, double maximum, double percentile_90) {
    ColourCorrection c;
    c.neutral_error = neutral;
    c.after = {{}, mean, maximum, percentile_90};
    c.after_flat = c.after;
    return c;
}

std::vector<std::string> levels_of(const ColourCorrection& c) {
    std::vector<std::string> levels;
    for (const ToleranceResult& r : judge_colours(c)) levels.push_back(r.level);
    return levels;
}

TEST(ColourTolerance, TellsTheBestLevelKept) {
    using testing::ElementsAre;
    EXPECT_THAT(levels_of(with_errors(1, 1, 3, 2)), ElementsAre("4 stars", "Full", "A"));
    EXPECT_THAT(levels_of(with_errors(3, 3, 7, 6)), ElementsAre("3 stars", "Full", "A"));
    EXPECT_THAT(levels_of(with_errors(3, 4, 10, 6)), ElementsAre("2 stars", "Light", "A"));
    EXPECT_THAT(levels_of(with_errors(5, 5, 15, 6)), ElementsAre("1 star", "Extra Light", "C"));
    EXPECT_THAT(levels_of(with_errors(20, 20, 40, 30)), ElementsAre("", "", ""));
}

TEST(ColourTolerance, AtTheLimitIsWithinWhereItSaysAtMost) {
    // FADGI says less than, the others at most.
    EXPECT_EQ(judge_colours(with_errors(1, 2, 3, 2))[0].level, "3 stars");
    EXPECT_EQ(judge_colours(with_errors(3, 3, 7, 2))[1].level, "Full");
    EXPECT_EQ(judge_colours(with_errors(3, 4, 10, 2))[2].level, "A");
    const ToleranceResult missed = judge_colours(with_errors(1, 2, 3, 2))[0];
    EXPECT_EQ(missed.next_level, "4 stars");
    ASSERT_EQ(missed.missed.size(), 3u);
    EXPECT_EQ(missed.missed[1].quantity, "mean");
    EXPECT_FALSE(missed.missed[1].kept());
    const nlohmann::json j = to_json(judge_colours(with_errors(1, 2, 3, 2)));
    EXPECT_EQ(j[0]["missed"][1]["limit"], 2);
    EXPECT_EQ(to_json(judge_colours(with_errors(20, 20, 40, 30)))[0]["level"], nullptr);
}

std::vector<ChartReading> handheld_readings(const std::filesystem::path& folder, std::size_t count) {
    std::vector<ChartReading> photos;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name = fmt::format("img_{:03}.png", i);
        const Image<Rgb> picture = read_picture(folder / "png16" / name);
        const auto chart = find_chart(picture);
        if (chart) photos.push_back(read_chart(picture, *chart, name));
    }
    return photos;
}

TEST(DataChartColour, IsGoodOnHandheld) {
    TP_DATA(folder, "handheld");
    const ChartReference reference = read_chart_reference(folder / "chart_reference.json");
    const std::vector<ChartReading> photos = handheld_readings(folder, 24);
    ASSERT_EQ(photos.size(), 24u);
    const ColourCorrection c = correct_colours(photos, reference);
    RecordProperty("mean", fmt::format("{:.3f}", c.after.mean));
    EXPECT_GT(c.before.mean, 4);
    EXPECT_LT(c.after.mean, 0.05);
    EXPECT_LT(c.after.maximum, 0.2);
    EXPECT_LT(c.cross_validated.mean, 0.06);
    EXPECT_THAT(levels_of(c), testing::ElementsAre("4 stars", "Full", "A"));
    fmt::print(
        "handheld, 24 photographs: before {:.2f} (max {:.2f}), after {:.3f} (max {:.3f}, 90th {:.3f}), left "
        "out "
        "{:.3f}, neutral {:.2f}, free matrix better by {:.3f}, light of degree {}, residual {:.4f}\n",
        c.before.mean, c.before.maximum, c.after.mean, c.after.maximum, c.after.percentile_90,
        c.cross_validated.mean, c.neutral_error, c.neutral_gain, c.light_degree, c.lights.residual);
    // Against the classic values, which differ from those rendered by 1.2 in the mean.
    const ColourCorrection classic = correct_colours(photos, classic_chart());
    fmt::print("against the classic values: after {:.3f}, rejected {:.3f}\n", classic.after.mean,
               classic.cross_validated.mean);
    EXPECT_LT(classic.after.mean, 1.2);
}

TEST(DataChartColour, IsGoodOnAnyOneOfHandheld) {
    TP_DATA(folder, "handheld");
    const ChartReference reference = read_chart_reference(folder / "chart_reference.json");
    double worst = 0, sum = 0, worst_validation = 0;
    const std::vector<ChartReading> photos = handheld_readings(folder, 24);
    for (const ChartReading& photo : photos) {
        const ColourCorrection c = correct_colours({&photo, 1}, reference);
        worst = std::max(worst, c.after.mean);
        worst_validation = std::max(worst_validation, c.cross_validated.mean);
        sum += c.after.mean / static_cast<double>(photos.size());
    }
    fmt::print(
        "handheld, one photograph: after {:.3f} on average, {:.3f} at worst, rejected {:.3f} at worst\n", sum,
        worst, worst_validation);
    EXPECT_LT(worst, 0.3);
    EXPECT_LT(worst_validation, 0.4);
}

}  // namespace
}  // namespace tangi
