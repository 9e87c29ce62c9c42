// touch_test.cpp: what fingers do, as events of a mouse and gestures of two.
#include "viewer/devices/touch.h"

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "viewer/devices/input.h"

namespace tangi {
namespace {

using Kind = InputEvent::Kind;

class FingersTest : public testing::Test {
protected:
    void down(int finger, double x, double y) { take(TouchEvent::Kind::begin, finger, x, y); }
    void to(int finger, double x, double y) { take(TouchEvent::Kind::move, finger, x, y); }
    void up(int finger, double x, double y) { take(TouchEvent::Kind::end, finger, x, y); }
    void take(TouchEvent::Kind kind, int finger, double x, double y) {
        now_s_ += 0.01;
        fingers_.take({kind, finger, now_s_, {x, y}}, events_);
    }
    std::vector<Kind> kinds() const {
        std::vector<Kind> kinds;
        for (const InputEvent& event : events_) kinds.push_back(event.kind);
        return kinds;
    }
    // All gestures since, one after the other.
    InputEvent sum() const {
        InputEvent sum;
        for (const InputEvent& event : events_) {
            EXPECT_EQ(event.kind, Kind::gesture);
            sum.by += event.by;
            sum.factor *= event.factor;
            sum.turn_deg += event.turn_deg;
        }
        return sum;
    }

    Fingers fingers_;
    std::vector<InputEvent> events_;
    double now_s_ = 10;
};

TEST_F(FingersTest, OneFingerIsTheLeftButton) {
    down(7, 100, 100);
    to(7, 103, 100);
    EXPECT_TRUE(events_.empty()) << "a second one may follow";
    to(7, 120, 100);
    to(7, 140, 110);
    up(7, 150, 110);
    EXPECT_EQ(kinds(), (std::vector{Kind::move, Kind::press, Kind::move, Kind::move, Kind::release}));
    EXPECT_EQ(events_[1].at, glm::dvec2(100, 100)) << "pressed where it came down";
    EXPECT_DOUBLE_EQ(events_[1].time_s, 10.01);
    EXPECT_EQ(events_[1].code, GLFW_MOUSE_BUTTON_LEFT);
    EXPECT_EQ(events_[4].at, glm::dvec2(150, 110));
    EXPECT_FALSE(events_[1].pen) << "it has no pressure";
}

TEST_F(FingersTest, AFingerThatStaysPresses) {
    down(1, 50, 60);
    fingers_.pass(now_s_ + Fingers::kWait_s / 2, events_);
    EXPECT_TRUE(events_.empty());
    fingers_.pass(now_s_ + 2 * Fingers::kWait_s, events_);
    EXPECT_EQ(kinds(), (std::vector{Kind::move, Kind::press}));
    events_.clear();
    take(TouchEvent::Kind::lost, 1, 50, 60);
    EXPECT_EQ(kinds(), std::vector{Kind::lost}) << "taken away by the window system";
}

TEST_F(FingersTest, ATapIsAClick) {
    EXPECT_FALSE(fingers_.pointer()) << "the mouse is the panels'";
    down(1, 50, 60);
    EXPECT_EQ(fingers_.pointer(), glm::dvec2(50, 60)) << "until it is known what it does, it points";
    up(1, 51, 60);
    EXPECT_EQ(kinds(), (std::vector{Kind::move, Kind::press, Kind::move, Kind::release}));
    EXPECT_EQ(fingers_.pointer(), glm::dvec2(51, 60)) << "panels see for a moment that it is up";
    for (int i = 0; i < 5; ++i) (void)fingers_.pointer();
    EXPECT_FALSE(fingers_.pointer()) << "and the mouse has them again";
}

TEST_F(FingersTest, TwoFingersMoveEnlargeAndTurn) {
    down(1, 100, 100);
    down(2, 200, 100);
    const double degree = std::numbers::pi / 180;
    // About a middle that moves by (60, -30); twice as far apart, turned counter-clockwise by 40 degrees.
    for (int i = 1; i <= 100; ++i) {
        const double t = i / 100.0, angle = 40 * t * degree, radius = 50 * (1 + t);
        const glm::dvec2 middle(150 + 60 * t, 100 - 30 * t),
            out(radius * std::cos(angle), -radius * std::sin(angle));
        to(1, middle.x - out.x, middle.y - out.y);
        to(2, middle.x + out.x, middle.y + out.y);
    }
    const InputEvent all = sum();
    EXPECT_NEAR(all.by.x, 60, 1e-9);
    EXPECT_NEAR(all.by.y, -30, 1e-9);
    EXPECT_NEAR(all.factor, 2, 1e-9);
    EXPECT_NEAR(all.turn_deg, 40 - Fingers::kTurn_deg, 1) << "small turns are not meant";
    events_.clear();
    up(1, 0, 0);
    to(2, 400, 400);
    fingers_.pass(now_s_ + 1, events_);
    EXPECT_TRUE(events_.empty()) << "the one that is left does nothing";
    up(2, 400, 400);
    EXPECT_TRUE(events_.empty());
    down(3, 10, 10);
    to(3, 40, 10);
    EXPECT_EQ(events_.size(), 3u) << "until all are up";
}

TEST_F(FingersTest, ASecondFingerDoesNotDisturbAStroke) {
    down(1, 100, 100);
    to(1, 130, 100);
    down(2, 300, 300);
    to(2, 350, 350);
    to(1, 160, 100);
    up(2, 350, 350);
    to(1, 190, 100);
    up(1, 190, 100);
    EXPECT_EQ(kinds(),
              (std::vector{Kind::move, Kind::press, Kind::move, Kind::move, Kind::move, Kind::release}));
}

TEST_F(FingersTest, APalmDoesNothingWhileAPenIsNear) {
    down(1, 100, 100);
    fingers_.give_way(now_s_, events_);
    to(1, 200, 100);
    fingers_.pass(now_s_ + 1, events_);
    down(2, 300, 300);
    fingers_.give_way(now_s_, events_);
    to(2, 400, 300);
    up(1, 200, 100);
    up(2, 400, 300);
    EXPECT_TRUE(events_.empty());
    down(3, 10, 10);
    to(3, 40, 10);
    EXPECT_EQ(events_.size(), 3u) << "once the pen is away and all are up";
    for (const InputEvent& event : events_) EXPECT_EQ(event.source, InputEvent::Source::finger);
    events_.clear();
    fingers_.give_way(now_s_, events_);
    EXPECT_EQ(kinds(), std::vector{Kind::lost}) << "what it had begun ends where the pen comes";
    events_.clear();
    up(3, 60, 10);
    EXPECT_TRUE(events_.empty());
}

TEST_F(FingersTest, FingersThatAreOnEachOtherDoNotEnlarge) {
    down(1, 100, 100);
    down(2, 101, 100);
    to(2, 100, 100);
    to(2, 104, 102);
    for (const InputEvent& event : events_) {
        EXPECT_EQ(event.factor, 1);
        EXPECT_EQ(event.turn_deg, 0);
    }
    to(9, 5, 5);  // never came down
    up(9, 5, 5);
    EXPECT_EQ(events_.size(), 2u);
}

}  // namespace
}  // namespace tangi
