// pointer_stream.cpp: which device the pointer's events are of.
#include <GLFW/glfw3.h>

#include <algorithm>

#include "viewer/devices/input.h"

namespace tangi {

namespace {

using Kind = InputEvent::Kind;

// X numbers the middle button 2 and the right one 3, and has wheels from 4 to 7.
int x_button(int code) {
    if (code == GLFW_MOUSE_BUTTON_LEFT) return 1;
    if (code == GLFW_MOUSE_BUTTON_MIDDLE) return 2;
    if (code == GLFW_MOUSE_BUTTON_RIGHT) return 3;
    return code + 5;
}

}  // namespace

std::size_t step_of(std::size_t i, std::size_t moves, std::size_t steps) {
    const std::size_t last = (i + 1) * steps / moves;
    return std::clamp<std::size_t>(last, 1, steps) - 1;
}

void PointerStream::give(InputEvent& event, const DeviceStep& step, double now_s) {
    last_ = step;
    event.source = step.pen ? InputEvent::Source::pen : InputEvent::Source::mouse;
    event.pen = step.pen;
    if (step.pen) pen_s_ = now_s;
}

// These movements are of the steps before the `until`-th, which are used up.
void PointerStream::sort_moves(const std::vector<InputEvent*>& moves, std::size_t until, double now_s) {
    std::vector<DeviceStep> steps;
    for (std::size_t i = 0; i < until; ++i)
        if (steps_[i].step.kind == DeviceStep::Kind::move) steps.push_back(steps_[i].step);
    for (std::size_t i = 0; i < moves.size(); ++i)
        give(*moves[i], steps.empty() ? last_ : steps[step_of(i, moves.size(), steps.size())], now_s);
    steps_.erase(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(until));
}

// A button of the mouse that went down before the pen came goes up again, whatever is near.
bool PointerStream::takes(const InputEvent& event, double now_s) {
    const bool button = event.kind == Kind::press || event.kind == Kind::release;
    if ((!button && event.kind != Kind::move) || event.source != InputEvent::Source::mouse) return true;
    const unsigned bit = button && event.code >= 0 && event.code < 32 ? 1u << event.code : 0;
    const bool was_held = (held_ & bit) != 0;
    const bool taken = !pen_is_near(now_s) || (event.kind == Kind::release && was_held);
    if (event.kind == Kind::press && taken) held_ |= bit;
    if (event.kind == Kind::release) held_ &= ~bit;
    return taken;
}

void PointerStream::sort(std::deque<InputEvent>& events, const PenNews& news, double now_s) {
    pen_down_ = news.down;
    std::erase_if(steps_, [](const Step& step) { return step.carried; });
    for (Step& step : steps_) step.carried = true;
    for (const DeviceStep& step : news.steps) {
        steps_.push_back({step});
        if (step.pen) pen_s_ = now_s;
    }
    std::vector<InputEvent*> moves;
    for (InputEvent& event : events) {
        if (event.kind == Kind::move) moves.push_back(&event);
        if (event.kind != Kind::press && event.kind != Kind::release) continue;
        const auto kind = event.kind == Kind::press ? DeviceStep::Kind::press : DeviceStep::Kind::release;
        const auto found = std::ranges::find_if(steps_, [&](const Step& step) {
            return step.step.kind == kind && step.step.button == x_button(event.code);
        });
        const bool known = found != steps_.end();
        sort_moves(moves, known ? static_cast<std::size_t>(found - steps_.begin()) : 0, now_s);
        moves.clear();
        give(event, known ? steps_.front().step : last_, now_s);
        if (known) steps_.pop_front();
    }
    // Up to a button that GLFW has not told of yet.
    const auto next = std::ranges::find_if(
        steps_, [](const Step& step) { return step.step.kind != DeviceStep::Kind::move; });
    if (!moves.empty()) sort_moves(moves, static_cast<std::size_t>(next - steps_.begin()), now_s);
    std::erase_if(events, [&](const InputEvent& event) { return !takes(event, now_s); });
}

}  // namespace tangi
