// round_object_test.cpp: objects that are not flat as a whole, under lights of unknown strengths.
#include <gmock/gmock.h>

#include <iostream>

#include "fit/pipeline/fit_painting.h"
#include "surface/render/relight.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

constexpr int kDomeSide = 72;

// A dome that slopes by up to 50 degrees and fills the picture.
Surface dome() {
    Surface s(kDomeSide, kDomeSide);
    const double radius = 0.9 * kDomeSide;
    Random random(3);
    for (int y = 0; y < kDomeSide; ++y)
        for (int x = 0; x < kDomeSide; ++x) {
            const double u = x - (kDomeSide - 1) / 2.0, v = (kDomeSide - 1) / 2.0 - y;
            const double z = std::sqrt(radius * radius - u * u - v * v);
            s.height_mm(x, y) = static_cast<float>(z - radius);
            s.normal(x, y) = Vec3(u, v, z) / static_cast<float>(radius);
            s.diffuse(x, y) = Rgb(random.real(0.3, 0.6), random.real(0.3, 0.6), random.real(0.3, 0.6));
            s.confidence(x, y) = 1;
        }
    return s;
}

TP_LONG TEST(RoundObject, IsNotTakenForFlatWhereTheUserSaysSo) {
    const Surface truth = dome();
    const TestDir folder;
    std::vector<Light> lights = dome_lights(32);
    Random random(11);
    for (Light& light : lights) {
        Light strong = light;
        strong.gain = Rgb(static_cast<float>(std::exp(0.15 * random.normal())));
        write_picture(folder / light.name, relight(truth, {&strong, 1}), Transfer{});
    }
    write_lights(folder / "lights.lp", lights);
    const auto error_deg = [&](bool flat, bool& bent_most) {
        FitOptions options{.white_level = 1, .register_photos = false};
        options.calibration.flat = flat;
        const FitResult fit = fit_painting(open_stack(folder.path(), {.transfer = Transfer{}}), options);
        bent_most = fit.report.lights.bent_most;
        double sum = 0;
        for (std::size_t i = 0; i < truth.normal.size(); ++i)
            sum +=
                std::acos(std::min(glm::dot(fit.surface.normal.pixels()[i], truth.normal.pixels()[i]), 1.0f));
        return sum / static_cast<double>(truth.normal.size()) * 180 / M_PI;
    };
    bool bent_most = false;
    const double flat = error_deg(true, bent_most);
    EXPECT_TRUE(bent_most) << "is told";
    const double relief = error_deg(false, bent_most);
    EXPECT_FALSE(bent_most);
    std::cout << fmt::format("normals off by {:.2f} deg as flat, {:.2f} as relief\n", flat, relief);
    EXPECT_GT(flat, 5);
    EXPECT_LT(relief, 0.8);
}

}  // namespace
}  // namespace tangi
