// spheres_test.cpp: real photographs of a grey sphere and of a rock, by the lights that a mirror sphere
// shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <iostream>

#include "capture/calibration/calibration_page.h"
#include "fit/evaluate/compare.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Lights of the chrome sphere, found without a hint, for the photographs of another object under the same
// lights, as calibrate writes them: standard errors lie beside.
fs::path lights_of_chrome(const fs::path& spheres, const TestDir& out) {
    std::vector<std::string> warnings;
    const SphereCalibration found = calibrate_from_spheres(pictures_in(spheres / "chrome", warnings), {});
    return write_calibration(out / "lights.lp", {.lights = found}).lights;
}

Stack object_stack(const fs::path& spheres, const std::string& object, const TestDir& out) {
    return open_stack(spheres / object, {.lights_file = lights_of_chrome(spheres, out),
                                         .mask_file = spheres / object / (object + ".mask.tga")});
}

// The sphere is not matt as Lambert's: light by cosine is 20 % more at 80 degrees than below 50, by all
// lights, and the lights are 1.5 degrees from where the chrome sphere showed them. 12 photographs are too few
// for the fit to find out either by those left out; together, within what the chrome sphere leaves open, all
// of them tell both (docs/theory/light-calibration.md).
double error_of_grey_sphere_deg(const std::filesystem::path& folder, const FitOptions& options) {
    const TestDir out;
    Stack stack = object_stack(folder, "gray", out);
    const Image<std::uint8_t> mask = stack.mask;
    const FitResult fit = fit_painting(std::move(stack), options);
    EXPECT_EQ(fit.report.transfer.transfer.name(), "linear");
    int x0 = mask.width(), x1 = 0, y0 = mask.height(), y1 = 0;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask(x, y)) {
                x0 = std::min(x0, x), x1 = std::max(x1, x);
                y0 = std::min(y0, y), y1 = std::max(y1, y);
            }
    const glm::dvec2 centre((x0 + x1) / 2.0, (y0 + y1) / 2.0);
    const double radius = (x1 - x0 + y1 - y0 + 2) / 4.0;
    double sum = 0;
    int count = 0;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const glm::dvec2 at = (glm::dvec2(x, y) - centre) / radius;
            const double square = glm::dot(at, at);
            // Beyond 72 degrees too few of the twelve lights reach.
            if (square > 0.95 * 0.95 || !(fit.surface.confidence(x, y) > 0)) continue;
            const glm::dvec3 truth(at.x, -at.y, std::sqrt(1 - square));
            sum += std::acos(std::min(1.0, glm::dot(truth, glm::dvec3(fit.surface.normal(x, y)))));
            ++count;
        }
    const double degrees = sum / count * 180 / M_PI;
    EXPECT_GT(count, 0.8 * M_PI * 0.95 * 0.95 * radius * radius);
    return degrees;
}

TEST(DataSpheres, NormalsOfTheGreySphereAreWithin4Degrees) {
    TP_DATA(folder, "spheres");
    const double found = error_of_grey_sphere_deg(folder, {});
    const double unregistered = error_of_grey_sphere_deg(folder, {.register_photos = false});
    const double as_listed =
        error_of_grey_sphere_deg(folder, {.register_photos = false, .lights_as_given = true});
    std::cout << fmt::format(
        "[  FIGURE  ] normals of the grey sphere: {:.2f} deg, not registered {:.2f}, with the lights as "
        "given "
        "{:.2f}\n",
        found, unregistered, as_listed);
    EXPECT_LE(found, 4);
    EXPECT_LE(unregistered, 4);
    EXPECT_LE(as_listed, 5.8);
}

TEST(DataSpheres, TheRockFits) {
    TP_DATA(folder, "spheres");
    const TestDir out;
    Stack stack = object_stack(folder, "rock", out);
    // Twelve lights around a grey stone leave the curve open, and that is told; linear is what it is.
    const TransferEstimate guessed = fit_painting(stack).report.transfer;
    EXPECT_THAT(guessed.doubt, HasSubstr("how the photographs are stored is open"));
    EXPECT_THAT(guessed.doubt + guessed.transfer.name(), HasSubstr("linear"));
    stack.transfer = Transfer{Transfer::Kind::linear};
    const FitResult fit = fit_painting(stack);
    const double fitted = static_cast<double>(fit.report.fitted);
    long inside = 0;
    for (const auto m : stack.mask.pixels()) inside += m != 0;
    EXPECT_GT(fitted, 0.99 * static_cast<double>(inside));
    EXPECT_LT(static_cast<double>(fit.report.not_converged), 0.05 * fitted);
    const CompareReport report = compare(fit.surface, stack);
    std::cout << "[  FIGURE  ] rock " << report.fitted.psnr_db << " dB, tilt " << fit.report.support_tilt_deg
              << " deg\n";
    EXPECT_GT(report.fitted.psnr_db, 33);
}

}  // namespace
}  // namespace tangi
