#include "viewer/devices/input.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace tangi {

namespace {

Input* of(GLFWwindow* window) { return static_cast<Input*>(glfwGetWindowUserPointer(window)); }

// GLFW names keys by their place on an American keyboard. Letters are meant as they are printed: Ctrl+Z is
// undo where Y and Z, or Z and W, have changed places.
int as_printed(int key, int scancode) {
    const char* name = glfwGetKeyName(key, scancode);
    if (!name || name[0] == 0 || name[1] != 0) return key;
    const auto letter = static_cast<unsigned char>(name[0]);
    return std::isalpha(letter) ? std::toupper(letter) : key;
}

}  // namespace

Input::Input(GLFWwindow* window) : window_(window), screens_(window) {
    glfwSetWindowUserPointer(window, this);
    glfwGetCursorPos(window, &at_.x, &at_.y);
    // Uncovered, or another size: what is shown must be drawn again.
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w)->woken_ = true; });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { of(w)->woken_ = true; });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        of(w)->at_ = {x, y};
        of(w)->put({InputEvent::Kind::move, glfwGetTime(), {x, y}, 0, 0});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
        of(w)->put({action == GLFW_PRESS ? InputEvent::Kind::press : InputEvent::Kind::release, glfwGetTime(),
                    of(w)->at_, button, mods});
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
        of(w)->put({InputEvent::Kind::wheel, glfwGetTime(), {x, y}, 0, 0});
    });
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
        of(w)->put({action == GLFW_RELEASE ? InputEvent::Kind::key_up : InputEvent::Kind::key, glfwGetTime(),
                    of(w)->at_, as_printed(key, scancode), mods});
    });
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
        of(w)->put({InputEvent::Kind::text, glfwGetTime(), of(w)->at_, static_cast<int>(character), 0});
    });
    // Where it comes back, it moves.
    glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int entered) {
        if (!entered) of(w)->put({InputEvent::Kind::leave, glfwGetTime(), of(w)->at_, 0, 0});
    });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
        of(w)->woken_ = true;
        of(w)->dropped_.insert(of(w)->dropped_.end(), paths, paths + count);
    });
}

void Input::hear(double wait_s) {
    listens_s_ = glfwGetTime();
    if (wait_s > 0)
        glfwWaitEventsTimeout(wait_s);
    else
        glfwPollEvents();
    heard_s_ = glfwGetTime();
}

Input::~Input() { glfwSetWindowUserPointer(window_, nullptr); }

void Input::put(InputEvent event) {
    constexpr double kAtOnce_s = 1e-3;  // what comes later than this came while it listened
    if (event.time_s - listens_s_ < kAtOnce_s) event.late_s = std::max(event.time_s - heard_s_, 0.0);
    woken_ = true;
    events_.push_back(event);
}

std::deque<InputEvent> Input::take() {
    woken_ = false;
    const PenNews pens = pens_.take();
    const double now_s = glfwGetTime();
    stream_.sort(events_, pens, now_s);
    const bool pen_is_near = stream_.pen_is_near(now_s);
    std::vector<InputEvent> touched;
    for (const TouchEvent& event : screens_.take(now_s)) {
        fingers_.take(event, touched);
        if (pen_is_near) fingers_.give_way(now_s, touched);
    }
    if (pen_is_near) fingers_.give_way(now_s, touched);
    fingers_.pass(now_s, touched);
    for (InputEvent& event : touched) event.late_s = now_s - taken_s_;
    taken_s_ = now_s;
    events_.insert(events_.end(), touched.begin(), touched.end());
    if (pens.lost)
        events_.push_back(
            {.kind = InputEvent::Kind::lost, .time_s = now_s, .at = at_, .source = InputEvent::Source::pen});
    return std::exchange(events_, {});
}

std::vector<std::filesystem::path> Input::take_dropped() { return std::exchange(dropped_, {}); }

}  // namespace tangi
