// hand_test.cpp: what a hand's events make of a stroke: its points are the pen's alone, and the brush
// is held by the hand however the painting is turned.
#include "viewer/app/input_controller.h"

#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include "tests/support/viewer/painter_support.h"

namespace tangi {
namespace {

using Kind = InputEvent::Kind;
using Source = InputEvent::Source;

constexpr Extent kScreen{600, 450};

class InputControllerTest : public PainterTest {
protected:
    void SetUp() override {
        write_painting(file_, *flat_surface(200, 150));
        open();
        state_.painting = {200, 150};
        state_.mm_per_pixel = state_.stroke_mm_per_pixel = painter_->mm_per_pixel();
        state_.view = fitted(state_.painting, kScreen);
        state_.tool = Tool::paint;
        state_.use_brush("round");
        state_.brush.thickness = 0.3;
        hand_.emplace(state_, *painter_);
    }
    void take(Kind kind, double x, double y, Source source, std::optional<PenSample> pen = {}, int mods = 0) {
        now_s_ += 0.01;
        hand_->take({.kind = kind,
                     .time_s = now_s_,
                     .at = {x, y},
                     .code = GLFW_MOUSE_BUTTON_LEFT,
                     .mods = mods,
                     .pen = pen,
                     .source = source},
                    kScreen, 0, false, false);
    }
    // Of the strokes that were recorded.
    std::vector<StrokePoint> points() {
        settle();
        std::vector<StrokePoint> all;
        if (!fs::exists(folder_ / "a.unsaved.jsonl")) return all;
        for (const Journal::Entry& entry : read_journal(folder_ / "a.unsaved.jsonl").entries)
            if (const auto* point = std::get_if<PointEvent>(&entry.event)) all.push_back(point->point);
        return all;
    }

    WindowState state_;
    std::optional<InputController> hand_;
    double now_s_ = 10;
};

TEST_F(InputControllerTest, AnotherDevicesEventsDoNotJoinAStroke) {
    const PenSample pen{.pressure = 0.4};
    take(Kind::move, 300, 225, Source::pen, pen);
    take(Kind::press, 300, 225, Source::pen, pen);
    for (int i = 1; i <= 5; ++i) {
        take(Kind::move, 300 + i, 225, Source::pen, pen);
        take(Kind::move, 500, 400, Source::mouse);
        take(Kind::press, 100, 50, Source::finger);
        take(Kind::move, 120, 60, Source::finger);
        take(Kind::release, 500, 400, Source::mouse);
        take(Kind::lost, 120, 60, Source::finger);
    }
    EXPECT_TRUE(hand_->holds()) << "it goes on";
    take(Kind::release, 305, 225, Source::pen, PenSample{});
    EXPECT_FALSE(hand_->holds());
    const std::vector<StrokePoint> all = points();
    ASSERT_EQ(all.size(), 6u);
    for (const StrokePoint& point : all) {
        EXPECT_NEAR(point.y_mm, all[0].y_mm, 1e-9);
        EXPECT_LT(std::abs(point.x_mm - all[0].x_mm), 3);
        EXPECT_DOUBLE_EQ(point.pressure, 0.4) << "the pen's, not the slider's";
    }
    take(Kind::press, 300, 225, Source::mouse);
    EXPECT_TRUE(hand_->holds()) << "the mouse's turn";
    take(Kind::release, 300, 225, Source::mouse);
}

TEST_F(InputControllerTest, TheBrushIsHeldByTheHandHoweverThePaintingIsTurned) {
    const PenSample pen{.pressure = 0.5, .tilt_x = 0.5, .tilt_y = 0, .rotation_deg = 30};
    for (const double turn_deg : {0.0, 90.0}) {
        state_.view = fitted(state_.painting, kScreen, turn_deg);
        take(Kind::press, 300, 225, Source::pen, pen);
        take(Kind::move, 310, 225, Source::pen, pen);
        take(Kind::release, 310, 225, Source::pen, pen);
    }
    const std::vector<StrokePoint> all = points();
    ASSERT_EQ(all.size(), 4u);
    EXPECT_NEAR(all[0].tilt_x, 0.5, 1e-9);
    EXPECT_NEAR(all[0].rotation_deg, 30, 1e-9);
    // To the right on the screen is down on a painting that was turned counter-clockwise by 90 degrees.
    EXPECT_LT(all[3].y_mm, all[2].y_mm);
    EXPECT_NEAR(all[3].x_mm, all[2].x_mm, 1e-6);
    EXPECT_NEAR(all[2].tilt_x, 0, 1e-9);
    EXPECT_NEAR(all[2].tilt_y, -0.5, 1e-9) << "the handle leans to where the stroke goes, as before";
    EXPECT_NEAR(all[2].rotation_deg, -60, 1e-9);
    state_.use_brush("flat");  // which follows the stroke
    take(Kind::press, 300, 225, Source::pen, pen);
    take(Kind::release, 300, 225, Source::pen, pen);
    EXPECT_NEAR(points().back().rotation_deg, 30, 1e-9);
    state_.use_brush("round");
    take(Kind::press, 300, 225, Source::mouse);
    take(Kind::release, 300, 225, Source::mouse);
    EXPECT_NEAR(points().back().rotation_deg, -90, 1e-9) << "the mouse, too";
}

TEST_F(InputControllerTest, TheWheelDoesNotMoveWhatIsPaintedOn) {
    take(Kind::press, 300, 225, Source::pen, PenSample{.pressure = 0.5});
    const double zoom = state_.view.zoom;
    take(Kind::wheel, 0, 1, Source::mouse);
    EXPECT_EQ(state_.view.zoom, zoom);
    take(Kind::release, 300, 225, Source::pen, PenSample{});
    take(Kind::wheel, 0, 1, Source::mouse);
    EXPECT_GT(state_.view.zoom, zoom);
}

TEST_F(InputControllerTest, CtrlClickPicksAndPaintsNothing) {
    for (const int modifier : {GLFW_MOD_CONTROL, GLFW_MOD_ALT}) {
        take(Kind::press, 300, 225, Source::mouse, {}, modifier);
        take(Kind::release, 300, 225, Source::mouse, {}, modifier);
        painter_->wait();
        EXPECT_TRUE(painter_->fetch().picked) << modifier;
    }
    EXPECT_TRUE(points().empty());
}

TEST_F(InputControllerTest, NothingIsLitWhilePhotographsAreHeldAgainstIt) {
    const Angles before = state_.lights[0].angles;
    const auto key = [&](int code) {
        hand_->take({.kind = Kind::key, .time_s = now_s_, .code = code}, kScreen, 0, false, false);
    };
    state_.comparing.loaded = state_.comparing.on = true;
    key(GLFW_KEY_LEFT);
    EXPECT_EQ(state_.lights[0].angles.azimuth_deg, before.azimuth_deg);
    EXPECT_THAT(state_.message, testing::HasSubstr("lit as the photograph"));
    state_.comparing.on = false;
    key(GLFW_KEY_LEFT);
    EXPECT_NE(state_.lights[0].angles.azimuth_deg, before.azimuth_deg);
}

}  // namespace
}  // namespace tangi
