// input.h: what the window hears from GLFW, in order and with its time: nothing is lost between two frames.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "viewer/pen.h"
#include "viewer/touch.h"
#include "viewer/view.h"

struct GLFWwindow;

namespace tangi {

struct InputEvent {
    enum class Kind {
        move,
        press,
        release,
        wheel,
        key,
        key_up,
        text,
        gesture,
        leave,
        lost
    } kind = Kind::move;  // gesture: of two fingers; leave: the window; lost: a pen or finger that was down
    double time_s = 0;    // when it was heard
    glm::dvec2 at{0};     // [pixels of the window]; wheel: how far
    int code = 0;  // button or key, as GLFW numbers them, letters as they are printed; text: a character
    int mods = 0;
    std::optional<PenSample> pen{};  // where a pen moved the pointer
    // Gesture, whose middle is `at`: moved by [pixels], enlarged, turned counter-clockwise.
    glm::dvec2 by{0};
    double factor = 1, turn_deg = 0;
    // Nobody listens while a slow frame is drawn: it happened at most so long before it was heard.
    double late_s = 0;
};

// Listens to a window. There is one at most; panels (Dear ImGui) may be set up after it and hear the same.
class Input {
public:
    explicit Input(GLFWwindow* window);
    ~Input();
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;

    // Lets GLFW hear what has come, or waits for it so long at most.
    void hear(double wait_s = 0);
    std::deque<InputEvent> take();
    std::vector<std::filesystem::path> take_dropped();  // files and folders dropped on the window
    std::vector<std::string> pens() const { return pens_.names(); }
    bool woken() const { return woken_; }  // anything at all since take()
    // Fingers do not wake the window: it has to look for them.
    bool polled() const { return screens_.any(); }
    std::optional<glm::dvec2> finger() { return fingers_.pointer(); }  // for the panels

    void put(InputEvent event);

private:
    GLFWwindow* window_;
    std::deque<InputEvent> events_;
    std::vector<std::filesystem::path> dropped_;
    PenDevices pens_;
    TouchScreens screens_;
    Fingers fingers_;
    PenSample pen_;     // the last one
    glm::dvec2 at_{0};  // where the pointer was at the last event: when this is handled, it may be elsewhere
    double listens_s_ = 0, heard_s_ = 0;  // when hear() began and ended
    double taken_s_ = 0;                  // take(): fingers are heard there
    bool woken_ = true;
};

}  // namespace tangi
