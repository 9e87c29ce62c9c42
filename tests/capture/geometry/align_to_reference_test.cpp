// align_to_reference_test.cpp: a painting that was fitted before is found in photographs of a later
// day.
#include "capture/geometry/align_to_reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <iostream>

#include "capture/calibration/plane_calibration.h"
#include "datasets/generator.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::HasSubstr;

constexpr int kWidth = 300, kHeight = 240;

const PaintingTruth& painting(std::uint64_t seed) {
    const auto made = [](std::uint64_t number) {
        return procedural_painting(
            {.seed = number, .width = kWidth, .height = kHeight, .mm_per_pixel = 0.2, .supersampling = 1});
    };
    static const PaintingTruth one = made(5), another = made(6);
    return seed == 5 ? one : another;
}

EarlierPainting earlier(std::uint64_t seed) {
    Surface surface(kWidth, kHeight);
    surface.diffuse = painting(seed).diffuse;
    surface.mm_per_pixel = 0.2;
    surface.scale_known = true;
    return earlier_painting(surface);
}

// Photographs by a camera that was turned and farther away; a third of the painting was retouched since.
std::vector<std::filesystem::path> photographs(const TestDir& dir, const Homography& to_photo) {
    const GeneratorOptions options{.lights = 5, .held_out = 0, .min_elevation_deg = 40};
    std::vector<std::filesystem::path> paths;
    for (const Photography::Photo& record : photography_of(painting(5), options).photos) {
        const Image<Rgb> seen = render_photo(painting(5), record.light, options);
        Image<Rgb> photo(320, 300);
        const Homography back = glm::inverse(to_photo);
        for (int y = 0; y < photo.height(); ++y)
            for (int x = 0; x < photo.width(); ++x) {
                const dvec2 p = mapped(back, {x, y});
                const int ix = static_cast<int>(std::floor(p.x)), iy = static_cast<int>(std::floor(p.y));
                if (ix < 0 || iy < 0 || ix >= kWidth || iy >= kHeight) continue;
                const auto fx = static_cast<float>(p.x - ix), fy = static_cast<float>(p.y - iy);
                photo(x, y) = (1 - fy) * ((1 - fx) * seen(ix, iy) + fx * seen.clamped(ix + 1, iy)) +
                              fy * ((1 - fx) * seen.clamped(ix, iy + 1) + fx * seen.clamped(ix + 1, iy + 1));
                if (p.x < kWidth / 3.0) photo(x, y) *= Rgb(0.4f, 0.7f, 0.5f);
            }
        paths.push_back(dir / fmt::format("after_{}.png", paths.size()));
        write_picture(paths.back(), photo, {Transfer::Kind::srgb});
    }
    return paths;
}

// Turned by 12 degrees counter-clockwise as seen, 0.9 times as large.
Homography moved() {
    const double c = 0.9 * std::cos(glm::radians(12.0)), s = 0.9 * std::sin(glm::radians(12.0));
    return {c, -s, 0, s, c, 0, 3, 62, 1};
}

TEST(EarlierPainting, IsFoundInPhotographsThatAreTurnedAndSmaller) {
    const TestDir dir;
    const PhotoSet photos(photographs(dir, moved()));
    const PlaneCalibration c = calibrate_plane(photos, {.earlier = earlier(5)}, nullptr);
    ASSERT_TRUE(c.earlier && c.geometry);
    EXPECT_EQ(c.rectified_by, "painting");
    EXPECT_EQ(c.geometry->width, kWidth);
    EXPECT_EQ(c.geometry->height, kHeight);
    EXPECT_EQ(c.geometry->mm_per_pixel, 0.2);
    double squares = 0;
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x) {
            const dvec2 at(x * (kWidth - 1) / 4.0, y * (kHeight - 1) / 4.0);
            const dvec2 off = c.geometry->place_in_photo(at) - mapped(moved(), at);
            squares += glm::dot(off, off) / 25;
        }
    std::cout << "[  FIGURE  ] the earlier painting lies within " << std::sqrt(squares)
              << " px rms, standard error " << c.earlier->error_px << " px\n";
    EXPECT_LT(std::sqrt(squares), 0.2);
    EXPECT_LT(std::sqrt(squares), 4 * c.earlier->error_px);
    ASSERT_TRUE(c.scale());
    EXPECT_EQ(c.scale()->method, "painting");
    EXPECT_NEAR(c.scale()->mm_per_pixel, 0.2 / 0.9, 0.002 * 0.2);
    // What points to the right in the painting points 12 degrees up in the photographs.
    const double turn = glm::radians(12.0);
    const glm::dvec3 right = c.geometry->turn * glm::dvec3(std::cos(turn), std::sin(turn), 0);
    EXPECT_NEAR(right.x, 1, 1e-3);
    EXPECT_NEAR(right.y, 0, 2e-3);
}

TEST(EarlierPainting, OfAnotherPictureIsNotFound) {
    const TestDir dir;
    const PhotoSet photos(photographs(dir, moved()));
    EXPECT_THAT(
        error_of([&] { find_painting(photos, earlier(6), {}, {Transfer::Kind::srgb}); }),
        testing::AllOf(HasSubstr(dir.path().string()), HasSubstr("is not found in these photographs")));
}

}  // namespace
}  // namespace tangi
