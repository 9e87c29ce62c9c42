// visibility_test.cpp: cast shadows of relight.h: how long, how soft, and never NaN.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "surface/render/cast_shadows.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A wall `height_mm` high from column `edge` on, on flat ground.
Surface with_wall(int width, int edge, float height_mm, double mm_per_pixel) {
    Surface s(width, 5);
    s.mm_per_pixel = mm_per_pixel;
    for (int y = 0; y < s.height(); ++y)
        for (int x = edge; x < width; ++x) s.height_mm(x, y) = height_mm;
    return s;
}

Light from_the_right(double elevation_deg) {
    return distant_light(
        Vec3(glm::dvec3(std::cos(elevation_deg * kDegree), 0, std::sin(elevation_deg * kDegree))));
}

TEST(Visibility, OfAFlatSurfaceIsComplete) {
    for (const double elevation : {5.0, 45.0, 89.9, 90.0})
        EXPECT_TRUE(
            images_near(visibility(Surface(9, 9), from_the_right(elevation), 1), Image<float>(9, 9, 1), 0));
}

TEST(Visibility, GivesAWallAShadowOfHeightOverTheTangentOfTheElevation) {
    for (const double mm_per_pixel : {1.0, 0.1})
        for (const double elevation : {11.0, 20.0, 33.0, 60.0}) {
            constexpr int edge = 70;
            const float height_mm = static_cast<float>(12 * mm_per_pixel);
            const Image<float> visible =
                visibility(with_wall(100, edge, height_mm, mm_per_pixel), from_the_right(elevation), 0);
            // What lies less than 12 / tan(elevation) pixels before the wall is dark, and the wall's top is
            // lit; where the edge runs through a pixel, its part is.
            const double length = 12 / std::tan(elevation * kDegree);
            double dark = 0;
            for (int x = 0; x < 100; ++x) {
                const double shadow = x < edge ? std::clamp(length - (edge - x) + 0.5, 0.0, 1.0) : 0.0;
                EXPECT_NEAR(visible(x, 2), 1 - shadow, 0.06)
                    << "elevation " << elevation << ", column " << x << ", " << mm_per_pixel << " mm/px";
                dark += 1 - visible(x, 2);
            }
            EXPECT_NEAR(dark, length - 0.5, 0.07);  // the pixel before the wall begins half a pixel before it
        }
}

TEST(Visibility, ThrowsTheShadowAwayFromTheLight) {
    // A post in the middle: under light from the top of the picture its shadow falls below it, and only
    // there.
    Surface s(21, 21);
    s.height_mm(10, 10) = 2.5f;
    const Image<float> visible = visibility(s, distant_light({0, 1, 1}), 0);
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 21; ++x)
            EXPECT_NEAR(visible(x, y), x == 10 && (y == 11 || y == 12) ? 0 : 1, 0.04) << x << ", " << y;
}

// Shadows of a point are as smooth as a pixel is wide, near and far.
TEST(Visibility, MovesSteadilyWithTheLight) {
    for (const float height_mm : {4.0f, 40.0f}) {
        const Surface s = with_wall(160, 150, height_mm, 1);
        double before = 0;
        for (double length = 10; length < 13; length += 0.1) {
            const Image<float> visible =
                visibility(s, from_the_right(std::atan(height_mm / length) / kDegree), 0);
            double dark = 0;
            for (int x = 0; x < 150; ++x) dark += 1 - visible(x, 2);
            if (before > 0) {
                EXPECT_NEAR(dark - before, 0.1, 0.05) << height_mm << ", " << length;
            }
            before = dark;
        }
    }
}

TEST(Visibility, FadesSteadilyThroughThePenumbra) {
    constexpr int edge = 150;
    const Image<float> visible = visibility(with_wall(160, edge, 30, 1), from_the_right(25), 8);
    int partly = 0;
    for (int x = edge - 1; x > 0; --x) {  // away from the wall
        EXPECT_GE(visible(x - 1, 2), visible(x, 2)) << x;
        partly += visible(x, 2) > 0 && visible(x, 2) < 1;
    }
    EXPECT_EQ(visible(edge - 1, 2), 0);
    EXPECT_EQ(visible(0, 2), 1);
    // From 30 / tan(33 deg) = 46 to 30 / tan(17 deg) = 98 pixels before the wall.
    EXPECT_NEAR(partly, 52, 1);
}

TEST(Visibility, IsHalfWhereTheHorizonCutsTheLightsCentre) {
    // 30 / tan(25 deg) = 64.34: the horizon passes the light's centre between pixels 64 and 65 before the
    // wall.
    const Image<float> visible = visibility(with_wall(160, 150, 30, 1), from_the_right(25), 8);
    EXPECT_LT(visible(150 - 64, 2), 0.5);
    EXPECT_GT(visible(150 - 65, 2), 0.5);
}

TEST(Visibility, IsSharpenedByASmallerLight) {
    const auto partly = [](double radius) {
        const Image<float> visible = visibility(with_wall(160, 150, 30, 1), from_the_right(25), radius);
        return std::count_if(visible.pixels().begin(), visible.pixels().end(),
                             [](float v) { return v > 0 && v < 1; });
    };
    EXPECT_LE(partly(0), 2 * 5);  // two of each row: the edge of a shadow
    EXPECT_LT(partly(1), partly(4));
    EXPECT_LT(partly(4), partly(10));
}

TEST(Visibility, OfANearLightDependsOnThePlace) {
    // A light 20 mm above the centre, two posts: one far to the left, one far to the right; shadows point
    // outwards.
    Surface s(61, 3);
    s.height_mm(10, 1) = s.height_mm(50, 1) = 5;
    const Image<float> visible = visibility(s, near_light({0, 0, 20}), 0);
    EXPECT_EQ(visible(8, 1), 0);
    EXPECT_EQ(visible(52, 1), 0);
    EXPECT_EQ(visible(12, 1), 1);
    EXPECT_EQ(visible(48, 1), 1);
}

TEST(Visibility, IsBetweenZeroAndOneWhereTheHorizonTouchesTheLightsRim) {
    // Ramps that rise just as steeply as the light's lower rim stands: rounding decides there, and must not
    // give NaN.
    for (const double radius : {1e-9, 1e-6, 1e-3, 0.25, 5.0, 20.0})
        for (int i = 1; i < 60; ++i) {
            const double elevation = 1 + 1.3 * i;
            Surface s(12, 3);
            for (int y = 0; y < 3; ++y)
                for (int x = 0; x < 12; ++x)
                    s.height_mm(x, y) = static_cast<float>(x * std::tan((elevation - radius) * kDegree));
            const Image<float> visible = visibility(s, from_the_right(elevation), radius);
            for (const float v : visible.pixels())
                ASSERT_TRUE(v >= 0 && v <= 1) << v << " at elevation " << elevation << ", radius " << radius;
        }
}

// Hills of many sizes and a needle, so that stretches of all lengths can be skipped and must not be.
Image<float> hills(int width, int height) {
    Random random(3);
    Image<float> z(width, height);
    for (float size = 2; size < 100; size *= 2.3f) {
        const double a = random.uniform(0, 6), b = random.uniform(0, 6);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                z(x, y) += static_cast<float>(0.12 * size * std::sin(x / size + a) * std::cos(y / size + b));
    }
    z(width / 3, height / 2) += 40;
    return z;
}

constexpr double kBeyond = -1e30;  // the border of the picture

// visible_part() as cast_shadows.h defines it, step by step and in doubles.
double marched(const Image<float>& z, int x, int y, const glm::dvec3& l, double mm_per_pixel, double radius) {
    const double cosine = std::hypot(l.x, l.y), sine = l.z;
    const auto rise = [&](double t) {
        const double px = x + t * l.x / cosine, py = y - t * l.y / cosine;
        if (!(px >= 0 && py >= 0 && px <= z.width() - 1 && py <= z.height() - 1)) return kBeyond;
        const int x0 = std::min(static_cast<int>(px), z.width() - 2);
        const int y0 = std::min(static_cast<int>(py), z.height() - 2);
        const double fx = px - x0, fy = py - y0;
        const double there = (1 - fy) * ((1 - fx) * z(x0, y0) + fx * z(x0 + 1, y0)) +
                             fy * ((1 - fx) * z(x0, y0 + 1) + fx * z(x0 + 1, y0 + 1));
        return (there - z(x, y)) / mm_per_pixel;
    };
    if (rise(1) == kBeyond) return 1;
    const double before = std::max(sine - rise(1) * cosine, 0.0);
    const double behind = rise(-1) == kBeyond ? before : std::max(sine + rise(-1) * cosine, 0.0);
    double covered = -1;
    for (double t = 1; rise(t) != kBeyond; t += 1) {
        const double p = rise(t) * cosine - t * sine, q = std::max(rise(t) * sine + t * cosine, 0.0);
        const double width = std::hypot(q * std::tan(radius), (p < 0 ? before : behind) / 2);
        covered = std::max(covered, p / std::max(width, 1e-6));
    }
    covered = std::min(covered, 1.0);
    return (std::acos(covered) - covered * std::sqrt(1 - covered * covered)) / std::numbers::pi;
}

TEST(CastShadows, AreThoseOfAMarchOverEveryPixel) {
    Random random(8);
    for (const auto& [width, height] : {std::pair{150, 97}, {64, 64}, {5, 30}, {2, 2}}) {
        const Image<float> z = hills(width, height);
        const double mm_per_pixel = 0.7, radius_deg = 1.5;
        const CastShadows shadows(z, mm_per_pixel, radius_deg);
        int partly = 0, dark = 0, clear_at_sight = 0;
        for (int i = 0; i < 20000; ++i) {
            const int x = std::min(static_cast<int>(random.uniform(0, width)), width - 1);
            const int y = std::min(static_cast<int>(random.uniform(0, height)), height - 1);
            const double azimuth = random.uniform(0, 2 * std::numbers::pi);
            const double elevation = random.uniform(0, 80) * kDegree;
            const glm::dvec3 l(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
            const double expected = marched(z, x, y, l, mm_per_pixel, radius_deg * kDegree);
            // Floats know a height of 40 mm to 4e-6 mm, which is 1e-4 of the penumbra next to it.
            ASSERT_NEAR(shadows.visible_part(x, y, Vec3(l)), expected, 1e-3)
                << x << ", " << y << " of " << width << " x " << height;
            const float across = static_cast<float>(std::cos(elevation));
            if (shadows.clears(shadows.steepest_horizon(x, y), across, static_cast<float>(l.z))) {
                ++clear_at_sight;
                ASSERT_EQ(shadows.visible_part(x, y, Vec3(l)), 1);
            }
            partly += expected > 0.01 && expected < 0.99;
            dark += expected < 0.01;
        }
        if (width < 10) continue;
        EXPECT_GT(partly, 30);
        EXPECT_GT(dark, 150);
        EXPECT_GT(clear_at_sight, 30);
    }
}

// Large lights, points, lights below the horizon and near the zenith; pits and cliffs many pixels deep.
TEST(CastShadows, AreThoseOfAMarchWhateverTheLight) {
    Random random(9);
    Image<float> z = hills(60, 50);
    for (int y = 10; y < 20; ++y)
        for (int x = 30; x < 34; ++x) z(x, y) -= 25;
    for (int y = 0; y < 50; ++y)
        for (int x = 45; x < 60; ++x) z(x, y) += 15;
    for (const double radius_deg : {0.0, 0.25, 8.0, 45.0}) {
        const CastShadows shadows(z, 0.7, radius_deg);
        int clear_at_sight = 0;
        for (int i = 0; i < 4000; ++i) {
            const int x = random.below(60), y = random.below(50);
            const double azimuth = random.uniform(0, 2 * std::numbers::pi);
            const double elevation = random.uniform(-60, 89.9) * kDegree;
            const glm::dvec3 l(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
            const double expected = marched(z, x, y, l, 0.7, radius_deg * kDegree);
            const float part = shadows.visible_part(x, y, Vec3(l));
            // Where a point just meets an edge, rounding decides.
            if (radius_deg > 0 || (expected > 0 && expected < 1)) {
                ASSERT_NEAR(part, expected, 3e-3)
                    << x << ", " << y << " radius " << radius_deg << " elevation " << elevation / kDegree;
            }
            if (shadows.clears(shadows.steepest_horizon(x, y), static_cast<float>(std::cos(elevation)),
                               static_cast<float>(l.z))) {
                ++clear_at_sight;
                ASSERT_EQ(part, 1) << x << ", " << y << " radius " << radius_deg;
            }
        }
        EXPECT_GT(clear_at_sight, radius_deg < 10 ? 10 : -1) << radius_deg;
    }
}

// A light for all pixels, a near one, and lights from everywhere; of some of the pixels, up to the border and
// beyond it.
TEST(CastShadows, AreTheSameOfPixelsSideBySide) {
    Random random(10);
    for (const auto& [width, height] : {std::pair{150, 97}, {40, 30}, {5, 30}, {2, 2}}) {
        const Image<float> z = hills(width, height);
        for (const double radius_deg : {0.25, 3.0}) {
            const CastShadows shadows(z, 0.7, radius_deg);
            int partly = 0;
            for (int i = 0; i < 3000; ++i) {
                const int x0 = random.below(width), y = random.below(height);
                const auto which = static_cast<std::uint32_t>(random.below(1 << kMarchLanes));
                std::array<glm::dvec3, kMarchLanes> l;
                const glm::dvec3 light(random.uniform(-90, 90), random.uniform(-90, 90),
                                       random.uniform(0, 60));
                for (int lane = 0; lane < kMarchLanes; ++lane) {
                    const glm::dvec3 from = i % 3 == 0 ? glm::dvec3(0) : glm::dvec3(0.4 * lane, 0, 0);
                    l[static_cast<std::size_t>(lane)] = glm::normalize(light - from);
                    if (i % 3 == 2)
                        l[static_cast<std::size_t>(lane)] = glm::normalize(
                            glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1)));
                }
                std::array<float, kMarchLanes> lx, ly, lz, parts;
                for (std::size_t lane = 0; lane < kMarchLanes; ++lane) {
                    lx[lane] = static_cast<float>(l[lane].x), ly[lane] = static_cast<float>(l[lane].y);
                    lz[lane] = static_cast<float>(l[lane].z);
                }
                parts.fill(7);
                shadows.visible_parts(x0, y, {lx.data(), ly.data(), lz.data()}, which, parts.data());
                for (int lane = 0; lane < kMarchLanes; ++lane) {
                    const auto at = static_cast<std::size_t>(lane);
                    if (!(which >> lane & 1)) {
                        ASSERT_EQ(parts[at], 7);
                        continue;
                    }
                    if (x0 + lane >= width) continue;
                    const double expected = marched(z, x0 + lane, y, l[at], 0.7, radius_deg * kDegree);
                    ASSERT_NEAR(parts[at], expected, 3e-3)
                        << x0 << " + " << lane << ", " << y << " of " << width << " x " << height;
                    partly += expected > 0.01 && expected < 0.99;
                }
            }
            EXPECT_GT(partly, width < 10 ? -1 : 100);
        }
    }
}

TEST(CastShadows, OfWhatIsNotANumberAreNone) {
    Image<float> z(40, 40);
    z(20, 20) = std::numeric_limits<float>::quiet_NaN();
    z(30, 20) = 5;
    const CastShadows shadows(z, 1, 0);
    EXPECT_EQ(shadows.visible_part(20, 20, glm::normalize(Vec3(1, 0, 0.1f))), 1);
    EXPECT_EQ(shadows.visible_part(15, 20, glm::normalize(Vec3(1, 0, 0.5f))), 1);
    EXPECT_EQ(shadows.visible_part(25, 20, glm::normalize(Vec3(1, 0, 0.5f))), 0);
    z(24, 20) = z(20, 20);  // behind a pixel
    EXPECT_EQ(shadows.visible_part(25, 20, glm::normalize(Vec3(1, 0, 0.5f))), 0);
    EXPECT_FALSE(shadows.clears(shadows.steepest_horizon(20, 20), 0.1f, 0.9f));
}

TEST(Visibility, OfAPictureOfOneRowIsComplete) {
    Surface s(9, 1);
    s.height_mm(5, 0) = 9;
    EXPECT_TRUE(images_near(visibility(s, from_the_right(10), 1), Image<float>(9, 1, 1), 0));
}

}  // namespace
}  // namespace tangi
