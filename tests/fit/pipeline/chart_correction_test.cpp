// chart_correction_test.cpp: a camera that is a matrix, a chart in its photographs, and what the fit makes
// of it.
#include "fit/pipeline/chart_correction.h"

#include <gmock/gmock.h>

#include <glm/matrix.hpp>

#include "fit/evaluate/compare.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr int kChartPhotoWidth = 66, kChartPhotoHeight = 60, kChartTop = 32;
constexpr double kPitch = 7, kWhiteLevel = 0.55;

// Overlapping primaries, weak in blue; with a luminance of 1 for white in green.
glm::dmat3 camera() {
    const glm::dmat3 m(0.62, 0.22, 0.04, 0.30, 0.66, 0.16, 0.08, 0.12, 0.50);
    return m / (m * glm::dvec3(1)).g;
}

// Waves in many colours with gloss above, a matt chart below.
Surface truth() {
    Surface s(kChartPhotoWidth, kChartPhotoHeight);
    const ChartReference chart = classic_chart();
    for (int y = 0; y < kChartPhotoHeight; ++y)
        for (int x = 0; x < kChartPhotoWidth; ++x) {
            s.confidence(x, y) = 1;
            s.roughness(x, y) = 0.15f;
            if (y < kChartTop - 2) {
                const float u = 0.35f * static_cast<float>(x), v = 0.3f * static_cast<float>(y);
                s.normal(x, y) = normal_of({0.25f * std::sin(u), 0.25f * std::cos(v)});
                s.diffuse(x, y) = {0.4f + 0.3f * std::sin(v), 0.35f + 0.2f * std::cos(u),
                                   0.3f + 0.2f * std::sin(u + v)};
                s.specular(x, y) = 0.05f;
            } else {
                const int column = static_cast<int>(x / kPitch),
                          row = static_cast<int>((y - kChartTop) / kPitch);
                const bool on = column < 6 && row >= 0 && row < 4 && y >= kChartTop;
                s.diffuse(x, y) =
                    on ? chart.patches[static_cast<std::size_t>(6 * row + column)].linear : Rgb(0.05f);
            }
        }
    return s;
}

json capture_of(const glm::dmat3& to_camera) {
    const glm::dvec3 light = to_camera * glm::dvec3(1);
    const glm::dmat3 matrix =
        glm::inverse(to_camera) * glm::dmat3(light.r, 0, 0, 0, light.g, 0, 0, 0, light.b);
    json rows = json::array(), patches = json::array();
    for (int r = 0; r < 3; ++r) rows.push_back({matrix[0][r], matrix[1][r], matrix[2][r]});
    for (const auto& patch : classic_chart().patches)
        patches.push_back({{"reference", {patch.linear.r, patch.linear.g, patch.linear.b}}});
    return {{"format", "tangipaint capture 1"},
            {"photographs", {{"width", kChartPhotoWidth}, {"height", kChartPhotoHeight}}},
            {"camera", {{"position_mm", nullptr}, {"mm_per_pixel", nullptr}}},
            {"frame", {{"origin_px", {(kChartPhotoWidth - 1) / 2.0, (kChartPhotoHeight - 1) / 2.0}}}},
            {"lights", json::array()},
            {"colour",
             {{"chart", {{"chart_to_picture", {{kPitch, 0, -0.5}, {0, kPitch, kChartTop - 0.5}, {0, 0, 1}}}}},
              {"transfer", {{"name", "linear"}}},
              {"correction",
               {{"white_balance", {1 / light.r, 1 / light.g, 1 / light.b}},
                {"matrix", rows},
                {"patches", patches},
                {"delta_e_2000", {{"cross_validated", {{"mean", 0.5}}}}}}}}}};
}

struct Photographed {
    TestDir dir;
    Surface painted = truth();
    Photographed() {
        const std::vector<Light> lights = dome_lights(14, 25);
        const glm::mat3 to_camera(kWhiteLevel * camera());
        for (const Light& light : lights) {
            Image<Rgb> photo = relight(painted, {&light, 1});
            for (Rgb& value : photo.pixels()) value = to_camera * value;
            write_picture(dir / light.name, photo, Transfer{});
        }
        write_lights(dir / "lights.lp", lights);
        write_bytes(dir / "capture.json", capture_of(camera()).dump());
    }
    Stack open(bool with_chart) const {
        StackOptions options{.transfer = Transfer{}};
        if (with_chart) options.capture_file = dir / "capture.json";
        return open_stack(dir.path(), options);
    }
};

double mean_delta_e(const Image<Rgb>& a, const Image<Rgb>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += delta_e_2000(lab_from_linear(glm::dvec3(a.pixels()[i])),
                            lab_from_linear(glm::dvec3(b.pixels()[i])));
    return sum / static_cast<double>(a.size());
}

TEST(ChartColours, MakeReflectanceColorimetricAndAbsoluteAndRelitPhotographsAsBefore) {
    const Photographed photographed;
    const FitOptions as_given{.lights_as_given = true};
    const FitResult with = fit_painting(photographed.open(true), as_given);
    const FitResult without = fit_painting(photographed.open(false), as_given);
    EXPECT_TRUE(with.report.colour.corrected);
    EXPECT_FALSE(without.report.colour.corrected);
    EXPECT_EQ(with.report.colour.delta_e_2000, 0.5);
    EXPECT_EQ(with.report.colour.patches, 24);
    EXPECT_LT(with.report.colour.patches_delta_e, 0.5);
    EXPECT_TRUE(with.report.colour.white_by_chart);
    EXPECT_NEAR(with.surface.photography.white_level, kWhiteLevel, 0.01 * kWhiteLevel);
    EXPECT_LT(mean_delta_e(with.surface.diffuse, photographed.painted.diffuse), 1);
    EXPECT_GT(mean_delta_e(without.surface.diffuse, photographed.painted.diffuse), 8);
    // Gloss is white under the lights, not in the camera's channels.
    EXPECT_NEAR(with.surface.specular(20, 10), 0.05, 0.01);

    const CompareReport a = compare(with.surface, photographed.open(true));
    const CompareReport b = compare(without.surface, photographed.open(false));
    EXPECT_GT(a.all.psnr_db, 35);
    // The lobe has the lights' colour only where that is known: without a chart it is the worse for it.
    EXPECT_GT(a.all.psnr_db, b.all.psnr_db - 0.05);
    // The way back survives the painting file.
    write_painting(photographed.dir / "p.exr", with.surface);
    const Surface read = read_painting(photographed.dir / "p.exr");
    EXPECT_EQ(compare(read, photographed.open(true)).all.psnr_db, a.all.psnr_db);
    EXPECT_EQ(compare(read, photographed.open(true)).all.delta_e_2000, a.all.delta_e_2000);
}

TEST(ChartColours, OfAMattPaintingArePaidForWithNothing) {
    Photographed photographed;
    for (float& specular : photographed.painted.specular.pixels()) specular = 0;
    const glm::mat3 to_camera(kWhiteLevel * camera());
    Random random(5);
    for (const Light& light : dome_lights(14, 25)) {
        Image<Rgb> photo = relight(photographed.painted, {&light, 1});
        for (Rgb& value : photo.pixels()) {
            value = to_camera * value;
            // As much noise as cameras have: what a clamped cyan costs must not be all that is compared.
            for (int c = 0; c < 3; ++c) value[c] += 0.01f * static_cast<float>(random.normal());
        }
        write_picture(photographed.dir / light.name, photo, Transfer{});
    }
    FitOptions as_given{.lights_as_given = true};
    as_given.ward.by_highlight =
        false;  // finds a little to explain in noise, more where channels are their own
    const double with =
        compare(fit_painting(photographed.open(true), as_given).surface, photographed.open(true)).all.psnr_db;
    const double without =
        compare(fit_painting(photographed.open(false), as_given).surface, photographed.open(false))
            .all.psnr_db;
    EXPECT_NEAR(with, without, 0.05);
}

// The chart tells the white level where a crop leaves it out, too.
TEST(ChartColours, TheChartNeedNotBeInThePicture) {
    const Photographed photographed;
    StackOptions options{.crop = Region{0, 0, kChartPhotoWidth, kChartTop - 2}, .transfer = Transfer{}};
    options.capture_file = photographed.dir / "capture.json";
    const FitResult fit =
        fit_painting(open_stack(photographed.dir.path(), options), {.lights_as_given = true});
    EXPECT_EQ(fit.report.colour.patches, 0);
    EXPECT_NEAR(fit.surface.photography.white_level, kWhiteLevel, 0.01 * kWhiteLevel);
    EXPECT_NEAR(fit.surface.diffuse(20, 10).g, photographed.painted.diffuse(20, 10).g, 0.02);
}

TEST(ChartColours, AGivenWhiteLevelWins) {
    const Photographed photographed;
    const FitResult fit =
        fit_painting(photographed.open(true), {.white_level = 0.8, .lights_as_given = true});
    EXPECT_EQ(fit.surface.photography.white_level, 0.8);
    EXPECT_FALSE(fit.report.colour.white_by_chart);
    EXPECT_NEAR(fit.surface.diffuse(20, 10).g, photographed.painted.diffuse(20, 10).g * kWhiteLevel / 0.8,
                0.01);
}

TEST(ChartColours, TheChartsCurveIsUsedUnlessOneIsGiven) {
    const Photographed photographed;
    json capture = capture_of(camera());
    capture["colour"]["transfer"]["name"] = "gamma 1.8";
    write_bytes(photographed.dir / "capture.json", capture.dump());
    StackOptions options{.capture_file = photographed.dir / "capture.json"};
    const FitResult fit =
        fit_painting(open_stack(photographed.dir.path(), options), {.lights_as_given = true});
    EXPECT_EQ(fit.report.transfer.transfer.name(), "gamma 1.8");
    EXPECT_EQ(fit.report.transfer.source, "colour chart");
    options.transfer = Transfer{};
    EXPECT_EQ(open_stack(photographed.dir.path(), options).transfer, Transfer{});
}

TEST(ChartColours, AChartThatIsNoneIsNotUsed) {
    const Photographed photographed;
    json capture = capture_of(camera());
    capture["colour"]["correction"]["delta_e_2000"]["after"] = {{"mean", 23.4}};
    write_bytes(photographed.dir / "capture.json", capture.dump());
    const Stack stack = photographed.open(true);
    EXPECT_FALSE(stack.colour);
    EXPECT_THAT(stack.warnings, testing::Contains(HasSubstr("off by 23.4")));
}

// Grey photographs have no colours to correct; frames and raws must have been read alike.
TEST(ChartColours, OfOtherPhotographsAreNotUsedOrWarnedOf) {
    const Photographed photographed;
    json capture = capture_of(camera());
    capture["development"] = {{"dark", {{"files", {"dark.png"}}}}, {"flat", nullptr}};
    write_bytes(photographed.dir / "capture.json", capture.dump());
    EXPECT_THAT(photographed.open(true).warnings, testing::Contains(HasSubstr("was read with --dark")));
    for (const Light& light : dome_lights(14, 25))
        write_map(photographed.dir / light.name, Image<float>(kChartPhotoWidth, kChartPhotoHeight, 0.5f));
    const Stack grey = photographed.open(true);
    EXPECT_FALSE(grey.colour);
    EXPECT_THAT(grey.warnings, testing::Contains(HasSubstr("are grey")));
}

TEST(ChartColours, RefusesAMatrixThatIsNone) {
    const Photographed photographed;
    const auto refusal = [&](const char* pointer, const json& value) {
        json capture = capture_of(camera());
        capture[json::json_pointer(pointer)] = value;
        write_bytes(photographed.dir / "capture.json", capture.dump());
        return error_of([&] { (void)photographed.open(true); });
    };
    EXPECT_THAT(refusal("/colour/correction/white_balance/0", 0), HasSubstr("white_balance is not positive"));
    EXPECT_THAT(refusal("/colour/correction/matrix", {{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}),
                HasSubstr("no inverse"));
    EXPECT_THAT(refusal("/colour/correction/matrix", json::array()), HasSubstr("0 rows"));
    EXPECT_THAT(refusal("/colour/transfer/name", "log"), HasSubstr("'log'"));
    EXPECT_THAT(refusal("/colour/correction/patches", json::array()), HasSubstr("0 entries"));
}

}  // namespace
}  // namespace tangi
