// brackets_test.cpp: exposures of one light become one value, as good as their noise allows.
#include "capture/photo/brackets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "capture/photo/exposure_merge.h"
#include "capture/radiometry/develop_stack.h"
#include "tests/support/capture/dng_writer.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

TEST(ExposureMerge, KeepsTheTrueValue) {
    for (const float x : {0.0f, 0.001f, 0.1f, 0.9f}) {
        const float t[] = {0.25f, 1, 4}, v[] = {0.25f * x, x, 4 * x};
        EXPECT_NEAR(merge_exposures(v, t), x, 1e-6f);
    }
}

TEST(ExposureMerge, LeavesClippedExposuresOut) {
    const float t[] = {0.25f, 1, 4};
    const float one_clipped[] = {0.1f, 0.4f, kNaN}, two_clipped[] = {0.1f, kNaN, kNaN},
                all[] = {kNaN, kNaN, kNaN};
    EXPECT_NEAR(merge_exposures(one_clipped, t), 0.4f, 1e-6f);
    EXPECT_NEAR(merge_exposures(two_clipped, t), 0.4f, 1e-6f);
    EXPECT_TRUE(std::isnan(merge_exposures(all, t)));
}

TEST(ExposureMerge, IsUnbiasedAndReachesTheCramerRaoBound) {
    const SensorNoise noise;
    const float t[] = {0.25f, 1, 4};
    for (const double x : {0.002, 0.02, 0.2}) {
        Random random(7);
        double sum = 0, squares = 0, information = 0;
        for (const float exposure : t)
            information +=
                double(exposure * exposure) / (noise.shot * x * double(exposure) + noise.read * noise.read);
        const int trials = 20000;
        for (int i = 0; i < trials; ++i) {
            float v[3];
            for (int k = 0; k < 3; ++k) {
                const double mean = x * double(t[k]);
                v[k] = static_cast<float>(mean + random.normal() *
                                                     std::sqrt(noise.shot * mean + noise.read * noise.read));
            }
            const double error = double(merge_exposures(v, t)) - x;
            sum += error;
            squares += error * error;
        }
        const double bound = std::sqrt(1 / information), rms = std::sqrt(squares / trials);
        EXPECT_NEAR(rms / bound, 1, 0.03) << x;
        EXPECT_LT(std::abs(sum / trials), 0.04 * bound) << x;
    }
}

TEST(ExposureMerge, RefinesRoundedExposures) {
    const double truth[] = {0.25, 1.0667, 3.9}, given[] = {0.25, 1, 4};
    Random random(3);
    std::vector<ExposurePair> pairs;
    for (int light = 0; light < 3; ++light)
        for (std::size_t k = 1; k < 3; ++k) {
            ExposurePair pair{k, k - 1, {}, {}};
            for (int i = 0; i < 2000; ++i) {
                const double x = random.uniform(0, 0.5);
                const auto seen = [&](double t) {
                    const double v = x * t + random.normal() * 0.002;
                    return v >= 0.99 ? kNaN : static_cast<float>(v);
                };
                pair.longer_values.push_back(seen(truth[k]));
                pair.shorter_values.push_back(seen(truth[k - 1]));
            }
            pairs.push_back(pair);
        }
    const RefinedExposures refined = refine_exposures(given, pairs);
    for (std::size_t k = 1; k < 3; ++k) {
        EXPECT_NEAR(refined.relative[k] / refined.relative[k - 1] / (truth[k] / truth[k - 1]), 1, 0.002);
        EXPECT_TRUE(refined.refined[k]);
        EXPECT_LT(refined.scatter[k], 0.005);
    }
    const double product = refined.relative[0] * refined.relative[1] * refined.relative[2];
    EXPECT_NEAR(product, 1, 1e-9);  // the geometric mean stays

    const RefinedExposures alone = refine_exposures(given, {});
    EXPECT_THAT(alone.relative, testing::ElementsAre(0.25, 1, 4));
    EXPECT_FALSE(alone.refined[1]);
}

// A stack of which every light was taken with three exposures; the middle one is 1.06 times what EXIF says.
constexpr int kBracketSide = 64;
float truth(int light, int x, int y) {
    return 0.01f + 0.004f * static_cast<float>(x * (y + 8 * light)) / kBracketSide;
}

struct BracketStack {
    TestDir dir;
    std::vector<Light> lights = dome_lights(4);

    BracketStack() {
        const double nominal[] = {0.005, 0.02, 0.08}, actual[] = {0.25, 1.06, 4};
        for (int i = 0; i < 4; ++i) {
            lights[static_cast<std::size_t>(i)].name = fmt::format("light {}", i);
            for (int k = 0; k < 3; ++k) {
                Image<Rgb> picture(kBracketSide, kBracketSide);
                for (int y = 0; y < kBracketSide; ++y)
                    for (int x = 0; x < kBracketSide; ++x)
                        picture(x, y) = Rgb(3 * truth(i, x, y) * static_cast<float>(actual[k]));
                write_dng(dir / fmt::format("light {}_{}.dng", i, k + 1), picture,
                          {.exposure_s = nominal[k]});
            }
        }
        std::string text = "4\n";
        for (const Light& l : lights)
            text += fmt::format("\"{}\" {} {} {}\n", l.name, l.direction.x, l.direction.y, l.direction.z);
        write_lights(dir / "lights.lp", lights);
    }
};

void expect_merged(const Stack& stack) {
    const Band band = StackReader(stack).read(0, kBracketSide, Transfer{});
    // Refining keeps the mean of the exposures, not one of them: the scale is free, the same for all.
    const double scale = double(band.row(0, 1, 32)[32]) / double(truth(0, 32, 32));
    EXPECT_NEAR(scale, 3, 0.1);
    double worst = 0, sum = 0;
    for (int i = 0; i < 4; ++i)
        for (int y = 4; y < kBracketSide - 4; ++y)
            for (int x = 4; x < kBracketSide - 4; ++x) {
                const double off = double(band.row(i, 1, y)[x]) / scale / double(truth(i, x, y)) - 1;
                worst = std::max(worst, std::abs(off));
                sum += std::abs(off);
            }
    EXPECT_LT(worst,
              0.02);  // where the longest exposure begins to clip, demosaicing mixes what is clipped in
    EXPECT_LT(sum / (4 * (kBracketSide - 8) * (kBracketSide - 8)), 0.002);
}

TEST(Brackets, AreFoundByNameAndMergedByWhatExifSays) {
    const BracketStack brackets;
    Stack stack =
        open_stack(brackets.dir.path(), {.develop = {.brackets = "auto", .raw_colour = RawColour::camera}});
    ASSERT_EQ(stack.photos.size(), 4u);
    EXPECT_EQ(stack.photos[0].path.filename(), "light 0_2.dng");  // the reference
    const DevelopReport report = develop_stack(stack);
    EXPECT_THAT(stack.warnings, IsEmpty());
    ASSERT_EQ(report.settings.size(), 3u);
    EXPECT_NEAR(report.settings[0].given, 0.25, 1e-6);
    EXPECT_NEAR(report.settings[1].relative / report.settings[0].relative, 1.06 / 0.25, 0.01);
    EXPECT_NEAR(report.settings[2].relative / report.settings[1].relative, 4 / 1.06, 0.01);
    expect_merged(stack);
}

TEST(Brackets, AreReadFromAFile) {
    const BracketStack brackets;
    std::string text = "{";
    for (int i = 0; i < 4; ++i)
        text +=
            fmt::format(R"({}"light {}": ["light {}_1.dng", {{"file": "light {}_2.dng"}}, "light {}_3.dng"])",
                        i ? "," : "", i, i, i, i);
    write_bytes(brackets.dir / "brackets.json", text + "}");
    Stack stack =
        open_stack(brackets.dir.path(), {.develop = {.brackets = (brackets.dir / "brackets.json").string(),
                                                     .raw_colour = RawColour::camera}});
    develop_stack(stack);
    expect_merged(stack);
}

TEST(Brackets, ThatAreWrongAreErrorsThatNameThem) {
    const BracketStack brackets;
    const fs::path folder = brackets.dir.path(), file = brackets.dir / "b.json";
    const auto trouble = [&](const std::string& text) {
        write_bytes(file, text);
        return error_of([&] { open_stack(folder, {.develop = {.brackets = file.string()}}); });
    };
    EXPECT_THAT(error_of([&] { read_brackets(folder / "none", folder); }), HasSubstr("no such file"));
    EXPECT_THAT(trouble("light 0: a, b"), AllOf(HasSubstr("b.json"), HasSubstr("JSON")));
    EXPECT_THAT(trouble(R"({"light 0": "x.dng"})"), AllOf(HasSubstr("light 0"), HasSubstr("list")));
    EXPECT_THAT(trouble(R"({"light 0": ["x.dng"]})"), AllOf(HasSubstr("light 0"), HasSubstr("x.dng")));
    EXPECT_THAT(trouble(R"({"light 0": [{"file": "light 0_1.dng", "exposure": 0}]})"), HasSubstr("positive"));
    EXPECT_THAT(trouble(R"({"light 0": [3]})"), HasSubstr("3"));
    EXPECT_THAT(trouble(R"({"light 9": ["light 0_1.dng"]})"),
                AllOf(HasSubstr("light 9"), HasSubstr("no light")));
    EXPECT_THAT(trouble(R"({"light 0": ["light 0_1.dng", {"file": "light 0_2.dng", "exposure": 2}]})"),
                AllOf(HasSubstr("light 0_1.dng"), HasSubstr("not known")));
    EXPECT_THAT(trouble(R"({"light 0": ["light 0_1.dng", "light 1_1.dng"]})"), HasSubstr("same exposure"));

    const TestDir plain;
    write_test_stack(plain, dome_lights(4));
    EXPECT_THAT(error_of([&] { open_stack(plain.path(), {.develop = {.brackets = "auto"}}); }),
                AllOf(HasSubstr(plain.path().string()), HasSubstr("NAME_1")));
}

}  // namespace
}  // namespace tangi
