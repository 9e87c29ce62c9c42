// viewer_pen_test.cpp: what the valuators of a pen say: pressure, tilt, rotation, which end.
#include "viewer/pen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace tangi {
namespace {

// As the drivers for Wacom tablets describe a pen.
std::vector<PenAxis> axes(double pressure, double tilt_x_deg, double tilt_y_deg, double wheel = 0) {
    return {{0, "Abs X", 0, 44704, 100},
            {1, "Abs Y", 0, 27940, 100},
            {2, "Abs Pressure", 0, 2048, pressure},
            {3, "Abs Tilt X", -64, 63, tilt_x_deg},
            {4, "Abs Tilt Y", -64, 63, tilt_y_deg},
            {5, "Abs Wheel", -900, 900, wheel}};
}

TEST(Pen, IsWhatPresses) {
    EXPECT_TRUE(is_pen(axes(0, 0, 0)));
    EXPECT_FALSE(is_pen({{0, "Rel X", -1, -1, 0}, {1, "Rel Y", -1, -1, 0}})) << "a mouse";
    EXPECT_FALSE(is_pen({{0, "Abs MT Position X", 0, 100, 0}, {1, "Abs MT Pressure", 0, 100, 0}}))
        << "a touch screen";
    EXPECT_FALSE(is_pen({{0, "Abs X", 0, 9, 0}, {1, "Abs Y", 0, 9, 0}, {2, "Abs Pressure", 0, 0, 0}}))
        << "an axis without a range";
    EXPECT_TRUE(is_eraser("Wacom Intuos Pro M Pen eraser"));
    EXPECT_TRUE(is_eraser("xwayland-tablet ERASER:12"));
    EXPECT_FALSE(is_eraser("Wacom Intuos Pro M Pen stylus"));
}

TEST(Pen, PressureIsPartOfItsRange) {
    EXPECT_DOUBLE_EQ(pen_sample(axes(0, 0, 0), false).pressure, 0);
    EXPECT_DOUBLE_EQ(pen_sample(axes(512, 0, 0), false).pressure, 0.25);
    EXPECT_DOUBLE_EQ(pen_sample(axes(9999, 0, 0), false).pressure, 1);
    EXPECT_DOUBLE_EQ(pen_sample(axes(-3, 0, 0), false).pressure, 0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_DOUBLE_EQ(pen_sample(axes(nan, nan, nan), false).pressure, 0);
}

// A handle that leans by a towards the azimuth b has the shadows atan(tan a cos b), atan(tan a sin b): the
// sample is the handle's sine towards x and y again.
TEST(Pen, TiltIsTheSineOfTheHandle) {
    const double deg = std::numbers::pi / 180;
    for (const double lean : {0.0, 20.0, 45.0, 60.0})
        for (const double azimuth : {0.0, 30.0, 135.0, 260.0}) {
            const double x = std::atan(std::tan(lean * deg) * std::cos(azimuth * deg)) / deg;
            const double up = std::atan(std::tan(lean * deg) * std::sin(azimuth * deg)) / deg;
            const PenSample sample = pen_sample(axes(1, x, -up), false);  // the tablet's y runs down
            EXPECT_NEAR(sample.tilt_x, std::sin(lean * deg) * std::cos(azimuth * deg), 1e-9);
            EXPECT_NEAR(sample.tilt_y, std::sin(lean * deg) * std::sin(azimuth * deg), 1e-9);
        }
    for (const double x : {-1e9, -64.0, 63.0, 1e9}) {
        const PenSample sample = pen_sample(axes(1, x, x), false);
        EXPECT_LE(std::hypot(sample.tilt_x, sample.tilt_y), 1) << "strokes take no longer one";
    }
}

TEST(Pen, TiltInOtherUnitsIsPartOfSixtyDegrees) {
    std::vector<PenAxis> raw = axes(0, 0, 0);
    raw[3] = {3, "Abs Tilt X", -9000, 9000, 4500};
    EXPECT_NEAR(pen_sample(raw, false).tilt_x, std::sin(30 * std::numbers::pi / 180), 1e-9);
    raw[3] = {3, "Abs Tilt X", 0, 127, 63.5};
    EXPECT_NEAR(pen_sample(raw, false).tilt_x, 0, 1e-9);
}

TEST(Pen, RotationTurnsCounterClockwise) {
    EXPECT_NEAR(pen_sample(axes(0, 0, 0, 0), false).rotation_deg, 0, 1e-9);
    EXPECT_NEAR(pen_sample(axes(0, 0, 0, 450), false).rotation_deg, -90, 1e-9);
    EXPECT_TRUE(pen_sample(axes(0, 0, 0), true).eraser);
}

TEST(Pen, SamplesGoWithMovementsInOrder) {
    std::vector<PenSample> samples(6);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].pressure = 0.1 * static_cast<double>(i);
    for (const std::size_t count : {1u, 2u, 3u, 6u, 7u, 20u}) {
        double last = -1;
        for (std::size_t i = 0; i < count; ++i) {
            const double pressure = sample_of(samples, i, count).pressure;
            EXPECT_GE(pressure, last);
            last = pressure;
        }
        EXPECT_DOUBLE_EQ(last, 0.5) << "the last is the newest";
    }
}

}  // namespace
}  // namespace tangi
