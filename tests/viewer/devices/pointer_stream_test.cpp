// pointer_stream_test.cpp: which device the pointer's events are of, and what a pen that is near puts
// out of action.
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include "viewer/devices/input.h"

namespace tangi {
namespace {

using Kind = InputEvent::Kind;
using Source = InputEvent::Source;
using StepKind = DeviceStep::Kind;

DeviceStep pen(double pressure, StepKind kind = StepKind::move) {
    return {.kind = kind, .button = kind == StepKind::move ? 0 : 1, .pen = PenSample{.pressure = pressure}};
}
DeviceStep mouse(StepKind kind = StepKind::move, int button = 1) {
    return {.kind = kind, .button = kind == StepKind::move ? 0 : button};
}
InputEvent event(Kind kind, double x = 0, int code = GLFW_MOUSE_BUTTON_LEFT) {
    return {.kind = kind, .at = {x, 0}, .code = code};
}

class PointerStreamTest : public testing::Test {
protected:
    // What is left of these, told at this moment.
    std::deque<InputEvent> sorted(std::deque<InputEvent> events, std::vector<DeviceStep> steps,
                                  bool down = false) {
        now_s_ += 0.016;
        PenNews news;
        news.steps = std::move(steps);
        news.down = down;
        stream_.sort(events, news, now_s_);
        return events;
    }
    static std::vector<double> pressures(const std::deque<InputEvent>& events) {
        std::vector<double> all;
        for (const InputEvent& e : events) all.push_back(e.pen ? e.pen->pressure : -1);
        return all;
    }

    PointerStream stream_;
    double now_s_ = 100;
};

TEST_F(PointerStreamTest, AMouseAloneIsLeftAsItIs) {
    const auto events = sorted({event(Kind::move), event(Kind::press), event(Kind::release)}, {});
    ASSERT_EQ(events.size(), 3u);
    for (const InputEvent& e : events) {
        EXPECT_EQ(e.source, Source::mouse);
        EXPECT_FALSE(e.pen);
    }
}

// The pressure of a press is that of the press, not that of the movement it happened to come with; and what
// comes up to the release is of the pen, though the tip is up by the time it is looked at.
TEST_F(PointerStreamTest, EveryEventOfAStrokeHasItsOwnPressure) {
    const auto events = sorted(
        {event(Kind::move, 1), event(Kind::press, 1), event(Kind::move, 2), event(Kind::move, 3),
         event(Kind::release, 3), event(Kind::move, 4)},
        {pen(0), pen(0.1, StepKind::press), pen(0.4), pen(0.2), pen(0, StepKind::release), pen(0)}, false);
    EXPECT_THAT(pressures(events), testing::ElementsAre(0, 0.1, 0.4, 0.2, 0, 0));
    for (const InputEvent& e : events) EXPECT_EQ(e.source, Source::pen);
}

// The devices' connection may be ahead: what GLFW tells later is still of the pen.
TEST_F(PointerStreamTest, WhatGlfwTellsLaterIsOfThePenToo) {
    sorted({event(Kind::move, 1), event(Kind::press, 1)}, {pen(0), pen(0.1, StepKind::press)}, true);
    const auto first = sorted({event(Kind::move, 2)}, {pen(0.5), pen(0.3, StepKind::release)}, false);
    EXPECT_THAT(pressures(first), testing::ElementsAre(0.5));
    const auto then = sorted({event(Kind::move, 3), event(Kind::release, 3)}, {}, false);
    ASSERT_EQ(then.size(), 2u);
    EXPECT_EQ(then[0].source, Source::pen);
    EXPECT_DOUBLE_EQ(then[0].pen->pressure, 0.5) << "not the slider's";
    EXPECT_EQ(then[1].source, Source::pen);
}

TEST_F(PointerStreamTest, TheMouseIsOutOfActionWhileAPenIsNear) {
    const auto stroke = sorted({event(Kind::move, 1), event(Kind::press, 1), event(Kind::move, 70),
                                event(Kind::press, 70), event(Kind::release, 70), event(Kind::move, 2)},
                               {pen(0), pen(0.1, StepKind::press), mouse(), mouse(StepKind::press),
                                mouse(StepKind::release), pen(0.3)},
                               true);
    std::vector<double> at;
    for (const InputEvent& e : stroke) at.push_back(e.at.x);
    EXPECT_THAT(at, testing::ElementsAre(1, 1, 2)) << "no movement and no click of the mouse";
    EXPECT_THAT(pressures(stroke), testing::ElementsAre(0, 0.1, 0.3));
    sorted({event(Kind::release, 2)}, {pen(0, StepKind::release)});
    EXPECT_TRUE(sorted({event(Kind::press, 70)}, {mouse(StepKind::press)}).empty())
        << "the palm on a touch pad";
    now_s_ += 2 * PointerStream::kNear_s;
    EXPECT_EQ(
        sorted({event(Kind::move, 70), event(Kind::press, 70)}, {mouse(), mouse(StepKind::press)}).size(), 2u)
        << "the pen has been put away";
}

TEST_F(PointerStreamTest, AMouseThatIsDownWhenAPenComesIsLetGo) {
    EXPECT_EQ(sorted({event(Kind::press, 5, GLFW_MOUSE_BUTTON_RIGHT)}, {mouse(StepKind::press, 3)}).size(),
              1u);
    const auto then =
        sorted({event(Kind::move, 9), event(Kind::move, 6), event(Kind::release, 6, GLFW_MOUSE_BUTTON_RIGHT)},
               {pen(0), mouse(), mouse(StepKind::release, 3)});
    ASSERT_EQ(then.size(), 2u);
    EXPECT_EQ(then[0].source, Source::pen);
    EXPECT_EQ(then[1].kind, Kind::release);
    EXPECT_EQ(then[1].source, Source::mouse);
}

// A press beside the window, which GLFW does not tell of.
TEST_F(PointerStreamTest, WhatNobodyToldOfIsForgotten) {
    sorted({}, {mouse(StepKind::press)});
    sorted({}, {});
    const auto events = sorted({event(Kind::press, 3)}, {pen(0.2, StepKind::press)}, true);
    EXPECT_THAT(pressures(events), testing::ElementsAre(0.2));
}

TEST_F(PointerStreamTest, AllOtherEventsPass) {
    const auto events = sorted(
        {event(Kind::key, 0, GLFW_KEY_B), event(Kind::wheel), event(Kind::text, 0, 'x')}, {pen(0.5)}, true);
    EXPECT_EQ(events.size(), 3u);
}

TEST(PointerSteps, GoWithMovementsInOrder) {
    for (const std::size_t moves : {1u, 2u, 3u, 6u, 7u, 20u}) {
        std::size_t last = 0;
        for (std::size_t i = 0; i < moves; ++i) {
            const std::size_t step = step_of(i, moves, 6);
            EXPECT_GE(step, last);
            last = step;
        }
        EXPECT_EQ(last, 5u) << "the last is the newest";
    }
}

}  // namespace
}  // namespace tangi
