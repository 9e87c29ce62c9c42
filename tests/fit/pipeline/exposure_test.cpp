// exposure_test.cpp: the main job on photographs of floats, of any exposure and white level.
#include <gmock/gmock.h>

#include "capture/formats/lights_file.h"
#include "datasets/generator.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/image_file/image_io.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A matt white has the value 8 in these photographs: much of them is beyond what integers can hold.
TP_LONG TEST(FitExposure, UsesFloatsBeyondOne) {
    const TestDir folder;
    const PaintingTruth truth = painting(kWidth, kHeight);
    const GeneratorOptions bright{
        .lights = 16, .held_out = 0, .white_level = 8, .sensor_noise = false, .format = GeneratorFormat::exr};
    write_stack(folder.path(), truth, bright);
    const Stack stack = open_stack(folder.path(), {.transfer = Transfer{}});
    long beyond = 0, values = 0;
    for (const StackPhoto& photo : stack.photos) {
        const Image<Rgb> picture = read_picture(photo.path);
        for (const Rgb& value : picture.pixels())
            for (int c = 0; c < 3; ++c, ++values) beyond += value[c] > 1;
    }
    ASSERT_GT(beyond, values / 3);

    const FitResult fit = fit_painting(stack, {.white_level = 8});
    EXPECT_GT(fit.report.fitted, 0.97 * kWidth * kHeight);
    EXPECT_LT(mean_normal_error_deg(fit.surface, truth), 1.5);
    double ratio = 0;
    for (std::size_t i = 0; i < truth.diffuse.size(); ++i)
        ratio += luminance(fit.surface.diffuse.pixels()[i]) / luminance(truth.diffuse.pixels()[i]);
    EXPECT_NEAR(ratio / static_cast<double>(truth.diffuse.size()), 1, 0.1);
}

// The same photographs, `scale` times as bright, as files of floats.
void write_scaled(const fs::path& folder, const Stack& stack, float scale) {
    std::vector<Light> lights;
    for (const StackPhoto& photo : stack.photos) {
        Image<Rgb> picture = read_picture(photo.path);
        for (Rgb& pixel : picture.pixels()) pixel *= scale;
        lights.push_back(photo.light);
        lights.back().name = photo.path.stem().string() + ".exr";
        write_picture(folder / lights.back().name, picture, {});
    }
    write_lights(folder / "lights.lp", lights);
}

// [1] Mean distance of the normals that are fitted to the same photographs at two exposures.
double difference_of_exposures(FitOptions options) {
    const SmallStack small;
    std::vector<Surface> surfaces;
    for (const float scale : {1.0f, 0.01f}) {
        const TestDir folder;
        write_scaled(folder.path(), small.open(), scale);
        options.white_level = 0.75 * scale;
        surfaces.push_back(fit_painting(open_stack(folder.path()), options).surface);
    }
    EXPECT_GE(surfaces[1].confidence.pixels()[100], 0.9);
    double mean = 0;
    for (std::size_t i = 0; i < surfaces[0].normal.size(); ++i)
        mean += glm::length(surfaces[0].normal.pixels()[i] - surfaces[1].normal.pixels()[i]) /
                static_cast<double>(surfaces[0].normal.size());
    return mean;
}

TP_LONG TEST(FitExposure, OfFloatsDoesNotDependOnTheExposure) {
    EXPECT_LE(difference_of_exposures({.lights_as_given = true, .refine = false}), 0.003);
    EXPECT_LE(difference_of_exposures({.lights_as_given = true, .solver = Solver::ceres}), 0.003);
    // What differs by rounding in the first pass is magnified by the thresholds of the second.
    EXPECT_LE(difference_of_exposures({.lights_as_given = true}), 0.005);
}

TP_LONG TEST(FitExposure, SaysThatTheWhiteLevelIsTooLow) {
    const SmallStack small;
    const TestDir folder;
    write_scaled(folder.path(), small.open(), 10);
    const FitReport report = fit_painting(open_stack(folder.path())).report;
    EXPECT_THAT(report.warnings, testing::Contains(HasSubstr("--white-level")));
}

}  // namespace
}  // namespace tangi
