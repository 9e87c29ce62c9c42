// pen_test.cpp: what the valuators of a pen say: pressure, tilt, rotation, which end.
#include "viewer/devices/pen.h"

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

// Drivers tell the axes that changed, and may not tell that the pressure is 0 when the tip goes up.
TEST(Pen, AStrokeDoesNotBeginWithThePressureOfTheOneBefore) {
    constexpr int kX = 0, kPressure = 2;
    Pen pen(axes(0, 0, 0), false);
    EXPECT_DOUBLE_EQ(pen.press({}).pressure, 0);
    EXPECT_DOUBLE_EQ(pen.move({{kPressure, 1536}}).pressure, 0.75);
    EXPECT_DOUBLE_EQ(pen.move({{kX, 120}}).pressure, 0.75) << "it stays pressed";
    EXPECT_DOUBLE_EQ(pen.release({}).pressure, 0);
    EXPECT_FALSE(pen.down());
    EXPECT_DOUBLE_EQ(pen.move({{kX, 130}}).pressure, 0) << "in the air";
    EXPECT_DOUBLE_EQ(pen.press({}).pressure, 0);
    EXPECT_TRUE(pen.down());
    pen.release({{kPressure, 2048}});
    EXPECT_DOUBLE_EQ(pen.move({}).pressure, 0) << "nor with what was told as it went up";
    // What is told with the press, or just before it, is of this stroke.
    EXPECT_DOUBLE_EQ(pen.press({{kPressure, 512}}).pressure, 0.25);
    pen.release({});
    pen.move({{kPressure, 1024}});
    EXPECT_DOUBLE_EQ(pen.press({}).pressure, 0.5);
    pen.release({});
    pen.move({{kPressure, 1024}});
    pen.move({{kX, 140}});
    EXPECT_DOUBLE_EQ(pen.press({}).pressure, 0) << "told long before";
}

// The same hand over a painting that lies turned: what it does on the screen is the same.
TEST(Pen, IsHeldByTheHandAndNotByThePainting) {
    const double deg = std::numbers::pi / 180;
    const PenSample hand{.pressure = 1, .tilt_x = 0.4, .tilt_y = 0.1, .rotation_deg = 20};
    for (const double turn_deg : {0.0, 30.0, 90.0, -135.0, 180.0}) {
        const HeldBrush held = held_over(hand, turn_deg, false);
        // Back on the screen, which shows the painting turned.
        const double c = std::cos(turn_deg * deg), s = std::sin(turn_deg * deg);
        EXPECT_NEAR(c * held.tilt.x - s * held.tilt.y, 0.4, 1e-12) << turn_deg;
        EXPECT_NEAR(s * held.tilt.x + c * held.tilt.y, 0.1, 1e-12) << turn_deg;
        EXPECT_NEAR(std::remainder(held.rotation_deg + turn_deg - 20, 360.0), 0, 1e-9) << turn_deg;
        EXPECT_NEAR(std::remainder(held_over({}, turn_deg, false).rotation_deg + turn_deg, 360.0), 0, 1e-9)
            << "a mouse is held straight";
        EXPECT_NEAR(held_over(hand, turn_deg, true).rotation_deg, 20, 1e-12)
            << "the stroke turns it, and is turned with the painting";
    }
}

}  // namespace
}  // namespace tangi
