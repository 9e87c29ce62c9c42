// errors_test.cpp: the standard errors of a fit say how far from the truth it is, and are stored with it.
#include "fit/pixel/fit_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fit/pixel/ward_fit.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Paint of all kinds under 40 lights, with noise as large as the samples say and no other error.
struct Coverage {
    int count = 0, slope = 0, diffuse = 0, specular = 0, roughness = 0;  // inside the 95 % interval
};

Coverage coverage(int photos, bool prior_is_right) {
    constexpr double k95 = 1.96;
    Random random(31);
    WardFitOptions options;
    options.model_error = 0;
    WardFitter fitter(options);
    const std::vector<Light> lights = dome_lights(photos);
    Coverage inside;
    for (int pixel = 0; pixel < 400; ++pixel) {
        const double alpha = random.uniform(0.12, 0.4), rho = random.uniform(0.03, 0.15);
        const double theta[kWardCommon] = {0.3 * random.normal(), 0.3 * random.normal(), std::log(alpha),
                                           rho};
        const double diffuse = random.uniform(0.2, 0.8);
        PixelSamples s;
        s.resize(photos, 3);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            s.light[i] = glm::normalize(glm::dvec3(lights[i].direction));
            const WardTerms t = ward_terms(theta, s.light[i], s.view);
            for (std::size_t c = 0; c < 3; ++c) {
                s.irradiance[3 * i + c] = 1;
                s.sigma[3 * i + c] = 0.005;
                s.value[3 * i + c] = diffuse * t.matt + rho * t.lobe + 0.005 * random.normal();
            }
        }
        const WardEstimate e = prior_is_right
                                   ? fitter.fit(s, {.ln_alpha = std::log(alpha) + 0.1 * random.normal(),
                                                    .ln_alpha_sigma = 0.1,
                                                    .specular = rho + 0.01 * random.normal(),
                                                    .specular_sigma = 0.01})
                                   : fitter.fit(s);
        ++inside.count;
        inside.slope += std::abs(e.slope.x - theta[0]) < k95 * e.slope_error;
        inside.diffuse += std::abs(e.diffuse.x - diffuse) < k95 * e.diffuse_error;
        inside.specular += std::abs(e.specular - rho) < k95 * e.specular_error;
        inside.roughness += std::abs(e.roughness - alpha) < k95 * e.roughness_error;
    }
    return inside;
}

// 400 trials: the fraction has a standard error of 1 %, and the slope's error is a mean of both components,
// so it is a little off for each.
void expect_95_percent(const char* what, int inside, int count) {
    const double part = static_cast<double>(inside) / count;
    std::cout << "[  FIGURE  ] " << what << " inside the 95 % interval: " << 100 * part << " %\n";
    EXPECT_GE(part, 0.90) << what;
    EXPECT_LE(part, 0.99) << what;
}

TEST(FitErrors, HoldTheTruthInTheir95PercentInterval) {
    for (const bool prior_is_right : {false, true}) {
        const Coverage c = coverage(40, prior_is_right);
        expect_95_percent("slope", c.slope, c.count);
        expect_95_percent("rho_d", c.diffuse, c.count);
        expect_95_percent("rho_s", c.specular, c.count);
        expect_95_percent("alpha", c.roughness, c.count);
    }
}

TEST(FitErrors, AreStoredWithThePainting) {
    const TestDir dir;
    Surface s(7, 80);
    FitErrors errors(7, 80);
    Random random(3);
    for (Image<HalfError>* map :
         {&errors.slope, &errors.diffuse, &errors.specular, &errors.roughness, &errors.height})
        for (HalfError& value : map->pixels()) value = random.real();
    {
        AtomicFile file(dir / "a.exr");
        const PartToWrite part = part_of(errors);
        write_painting(file, s, {&part, 1});
    }
    const FitErrors back = read_errors(dir / "a.exr");
    EXPECT_TRUE(images_identical(back.slope, errors.slope));
    EXPECT_TRUE(images_identical(back.diffuse, errors.diffuse));
    EXPECT_TRUE(images_identical(back.specular, errors.specular));
    EXPECT_TRUE(images_identical(back.roughness, errors.roughness));
    EXPECT_TRUE(images_identical(back.height, errors.height));
    write_painting(dir / "b.exr", s);
    EXPECT_EQ(
        error_of([&] { read_errors(dir / "b.exr"); }),
        (dir / "b.exr").string() + ": has no part 'errors'; fit the photographs again with: tangipaint fit");
}

}  // namespace
}  // namespace tangi
