#include "fit/residual/residual_fit.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <iostream>

#include "fit/evaluate/compare.h"
#include "fit/residual/residual_kernel.h"
#include "surface/base/parallel.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

// A wavy painting and 40 photographs of it, 16 bit, linear, every 8th from the 5th held out; `extra` of pixel
// and light is what they show beyond it.
struct Scene {
    TestDir folder;
    Surface surface{30, 24};
    Stack stack;

    template <class Extra>
    explicit Scene(const Extra& extra) {
        Surface& s = surface;
        for (int y = 0; y < s.height(); ++y)
            for (int x = 0; x < s.width(); ++x) {
                s.height_mm(x, y) = 0.3f * std::sin(0.5f * static_cast<float>(x + y));
                s.diffuse(x, y) = Rgb(0.5f, 0.3f + 0.01f * static_cast<float>(x), 0.3f);
                s.confidence(x, y) = 1;
                s.roughness(x, y) = 0.3f;
                s.specular(x, y) = 0.02f;
            }
        s.normal = normals_of(s.height_mm, 1);
        s.photography.white_level = 0.6;
        std::vector<Light> lights = dome_lights(40);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            lights[i].gain = Rgb(0.8f + 0.4f * static_cast<float>(i % 3) / 2);
            s.photography.photos.push_back({lights[i], i % 8 != 4});
            Image<Rgb> picture = relight(s, {&lights[i], 1}, {.cast_shadows = true});
            for (int y = 0; y < s.height(); ++y)
                for (int x = 0; x < s.width(); ++x)
                    picture(x, y) =
                        0.6f * (picture(x, y) + lights[i].gain * extra(x, y, lights[i].direction, i));
            write_picture(folder / lights[i].name, picture, Transfer{});
        }
        write_lights(folder / "lights.lp", lights);
        stack = open_stack(folder.path());
        hold_out(stack, "4:8");
    }
};

// What interreflection might add: smooth over the light, different in each pixel, some of it coloured.
Rgb smooth_extra(int x, int y, const Vec3& l, std::size_t) {
    const float swing = 0.08f * (1 + std::sin(0.9f * static_cast<float>(x)) * l.x +
                                 std::cos(0.7f * static_cast<float>(y)) * l.y * l.y);
    return swing * Rgb(0.5f, 0.35f, 0.3f) + 0.02f * l.x * Rgb(1, -0.5f, 0.2f);
}

TEST(ResidualFit, WhatIsSmoothOverTheLightIsPredictedAtLightsItNeverSaw) {
    const Scene scene(smooth_extra);
    const ResidualFit fit = fit_residual(scene.surface, scene.stack, {.residual_samples = 200});
    EXPECT_TRUE(fit.report.used);
    EXPECT_GT(fit.report.cv_psnr_db, fit.report.surface_db + 6);
    EXPECT_LE(fit.report.terms, 24);
    const CompareReport report = compare(scene.surface, scene.stack, {}, {}, {}, fit.residual);
    ASSERT_TRUE(report.held_out.residual_psnr_db.has_value());
    EXPECT_GT(*report.held_out.residual_psnr_db, report.held_out.psnr_db + 6);
    EXPECT_GT(*report.fitted.residual_psnr_db, report.fitted.psnr_db + 6);
    for (const PhotoComparison& photo : report.photos) EXPECT_TRUE(photo.residual_psnr_db.has_value());
    EXPECT_TRUE(to_json(report)["mean"]["held_out"].contains("residual_psnr_db"));
    EXPECT_FALSE(
        to_json(compare(scene.surface, scene.stack))["mean"]["held_out"].contains("residual_psnr_db"));
}

TEST(ResidualFit, HeldOutPhotographsHaveNoPartAndThreadsChangeNothing) {
    const Scene scene(smooth_extra);
    const ResidualFit first = fit_residual(scene.surface, scene.stack, {.residual_samples = 200});
    for (const StackPhoto& photo : scene.stack.held_out)
        write_picture(photo.path, Image<Rgb>(30, 24, Rgb(0.9f)), Transfer{});
    set_thread_count(1);
    const ResidualFit second = fit_residual(scene.surface, scene.stack, {.residual_samples = 200});
    set_thread_count(0);
    ASSERT_EQ(first.residual.brightness.size(), second.residual.brightness.size());
    EXPECT_EQ(first.residual.brightness_weights, second.residual.brightness_weights);
    for (std::size_t t = 0; t < first.residual.brightness.size(); ++t)
        EXPECT_TRUE(images_identical(first.residual.brightness[t], second.residual.brightness[t]));
}

TEST(ResidualFit, NoiseIsNoResidual) {
    Random random(5);
    const Scene scene([&](int, int, const Vec3&, std::size_t) {
        return Rgb(random.real(-0.03, 0.03), random.real(-0.03, 0.03), random.real(-0.03, 0.03));
    });
    const ResidualFit fit = fit_residual(scene.surface, scene.stack, {.residual_samples = 200});
    EXPECT_FALSE(fit.report.used);
    EXPECT_TRUE(fit.residual.empty());
    EXPECT_THAT(fit.report.why, HasSubstr("no better than the surface"));
}

// Residuals that change within the step between lights: validation photographs tell hardly anything of them,
// and nothing of how near a photograph one may go by it.
TEST(ResidualFit, OfKernelsThatGainAsMuchTheMostCarefulOneIsTaken) {
    using namespace residual_kernel;
    constexpr int kSamples = 400;
    std::vector<Vec3> directions;
    for (int i = 0; i < 24; ++i) {
        const float azimuth = 0.4833f * static_cast<float>(i), up = i < 13 ? 0.26f : 0.83f;
        directions.emplace_back(std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth),
                                std::sin(up));
    }
    const Matrix kernel = kernel_matrix(directions, Kernel::gaussian, 0.25);
    const Matrix root = kernel.llt().matrixL();
    Random random(8);
    Samples samples;
    samples.residual.resize(24, 3 * kSamples);
    for (double& v : samples.residual.reshaped()) v = 0.02 * random.normal();
    samples.residual = root * samples.residual;
    samples.to_rgb.assign(kSamples, glm::mat3(1));
    for (int i = 0; i < 24; ++i) {
        Sampled& photo = samples.photos.emplace_back();
        photo.irradiance.assign(kSamples, Rgb(1));
        photo.relit.assign(kSamples, Rgb(0.4f));
        for (int j = 0; j < kSamples; ++j)
            photo.stored.push_back(Rgb(0.4f) +
                                   Rgb(Vec3(samples.residual(i, 3 * j), samples.residual(i, 3 * j + 1),
                                            samples.residual(i, 3 * j + 2))));
    }
    const Choice choice = choose_kernel(samples, {}, directions, {});
    const double alone = psnr_with(samples, {}, 0, [](std::size_t) { return Vec3(0); });
    EXPECT_LT(choice.mean_db, alone + 1.5) << "hardly anything is told";
    EXPECT_GE(choice.ridge, 0.3);
}

TEST(ResidualFit, FewPhotographsHaveNoneAndOtherSizesAreErrors) {
    Scene scene(smooth_extra);
    Stack few = scene.stack;
    few.photos.resize(7);
    const ResidualFit none = fit_residual(scene.surface, few);
    EXPECT_FALSE(none.report.used);
    EXPECT_TRUE(none.residual.empty());
    EXPECT_THAT(none.report.why, HasSubstr("7 photographs are too few"));
    EXPECT_EQ(to_json(none.report)["used"], false);
    const Surface small(8, 8);
    EXPECT_THAT(error_of([&] { fit_residual(small, scene.stack); }), HasSubstr("the painting is 8 x 8"));
    EXPECT_THROW(fit_residual(scene.surface, scene.stack, {}, [](auto, double) { return false; }), Cancelled);
}

}  // namespace
}  // namespace tangi
