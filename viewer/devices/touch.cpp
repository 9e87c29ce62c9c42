#include "viewer/devices/touch.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/devices/input.h"

namespace tangi {

namespace {

// [degrees] Of the line between two fingers, counter-clockwise as seen.
double angle_deg(const glm::dvec2& a, const glm::dvec2& b) {
    return std::atan2(a.y - b.y, b.x - a.x) * 180 / std::numbers::pi;
}

InputEvent mouse(InputEvent::Kind kind, double time_s, const glm::dvec2& at) {
    return {.kind = kind,
            .time_s = time_s,
            .at = at,
            .code = GLFW_MOUSE_BUTTON_LEFT,
            .source = InputEvent::Source::finger};
}

}  // namespace

void Fingers::press(double time_s, std::vector<InputEvent>& out) {
    const Finger& finger = fingers_.front();
    state_ = State::presses;
    // Where and when it came down.
    out.push_back(mouse(InputEvent::Kind::move, finger.began_s, finger.from));
    out.push_back(mouse(InputEvent::Kind::press, finger.began_s, finger.from));
    if (finger.at != finger.from) out.push_back(mouse(InputEvent::Kind::move, time_s, finger.at));
}

void Fingers::begin(const TouchEvent& event) {
    fingers_.push_back({event.finger, event.at, event.at, event.time_s});
    if (fingers_.size() == 1) {
        state_ = State::waits;
        last_ = event.at;
        after_ = 0;
    } else if (fingers_.size() == 2 && state_ == State::waits) {
        state_ = State::two;
        turned_deg_ = 0;
        turns_ = false;
    }
}

void Fingers::pinch(const Finger& old_first, const Finger& old_second, double time_s,
                    std::vector<InputEvent>& out) {
    const glm::dvec2 &a = fingers_[0].at, &b = fingers_[1].at;
    InputEvent event{InputEvent::Kind::gesture, time_s, 0.5 * (a + b), 0, 0};
    event.by = event.at - 0.5 * (old_first.at + old_second.at);
    constexpr double kNear_px = 10;  // fingers on each other say nothing of size and direction
    const double before = glm::length(old_second.at - old_first.at), now = glm::length(b - a);
    if (before > kNear_px && now > kNear_px) {
        event.factor = now / before;
        const double by_deg = std::remainder(angle_deg(a, b) - angle_deg(old_first.at, old_second.at), 360.0);
        turned_deg_ += by_deg;
        if (turns_) event.turn_deg = by_deg;
        turns_ = turns_ || std::abs(turned_deg_) > kTurn_deg;
    }
    out.push_back(event);
}

void Fingers::move(const TouchEvent& event, std::vector<InputEvent>& out) {
    const auto moved = std::find_if(fingers_.begin(), fingers_.end(),
                                    [&](const Finger& finger) { return finger.number == event.finger; });
    if (moved == fingers_.end()) return;
    const std::vector<Finger> before = fingers_;
    moved->at = event.at;
    const bool first = moved == fingers_.begin();
    if (state_ == State::waits && first && glm::length(moved->at - moved->from) > kStill_px)
        press(event.time_s, out);
    else if (state_ == State::presses && first)
        out.push_back(mouse(InputEvent::Kind::move, event.time_s, event.at));
    else if (state_ == State::two && moved - fingers_.begin() < 2)
        pinch(before[0], before[1], event.time_s, out);
    if (first && (state_ == State::waits || state_ == State::presses)) last_ = event.at;
}

void Fingers::end(const TouchEvent& event, std::vector<InputEvent>& out) {
    const auto lifted = std::find_if(fingers_.begin(), fingers_.end(),
                                     [&](const Finger& finger) { return finger.number == event.finger; });
    if (lifted == fingers_.end()) return;
    lifted->at = event.at;
    const bool first = lifted == fingers_.begin(), lost = event.kind == TouchEvent::Kind::lost;
    if (state_ == State::waits && !lost) press(event.time_s, out);
    if (first && state_ == State::presses) {
        out.push_back(
            mouse(lost ? InputEvent::Kind::lost : InputEvent::Kind::release, event.time_s, event.at));
        last_ = event.at;
    }
    if (state_ != State::presses || first) state_ = State::over;
    fingers_.erase(lifted);
    if (fingers_.empty()) state_ = State::none;
}

void Fingers::take(const TouchEvent& event, std::vector<InputEvent>& out) {
    if (event.kind == TouchEvent::Kind::begin)
        begin(event);
    else if (event.kind == TouchEvent::Kind::move)
        move(event, out);
    else
        end(event, out);
}

void Fingers::give_way(double now_s, std::vector<InputEvent>& out) {
    if (state_ == State::presses) out.push_back(mouse(InputEvent::Kind::lost, now_s, last_));
    if (!fingers_.empty()) state_ = State::over;
}

void Fingers::pass(double now_s, std::vector<InputEvent>& out) {
    if (state_ == State::waits && now_s - fingers_.front().began_s > kWait_s) press(now_s, out);
}

std::optional<glm::dvec2> Fingers::pointer() {
    constexpr int kAfterwards = 3;  // panels see that it is up before the mouse is asked again
    if (state_ == State::waits || state_ == State::presses)
        after_ = kAfterwards;
    else if (after_ > 0)
        --after_;
    else
        return {};
    return last_;
}

}  // namespace tangi
