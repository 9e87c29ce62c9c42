// input.h: what the window hears from GLFW, in order and with its time: nothing is lost between two frames.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "viewer/pen.h"
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
        lost
    } kind = Kind::move;  // lost: a pen that was down
    double time_s = 0;
    glm::dvec2 at{0};  // [pixels of the window]; wheel: how far
    int code = 0;      // button or key, as GLFW numbers them
    int mods = 0;
    std::optional<PenSample> pen{};  // where a pen moved the pointer
};

// Listens to a window. There is one at most; panels (Dear ImGui) may be set up after it and hear the same.
class Input {
public:
    explicit Input(GLFWwindow* window);
    ~Input();
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;

    std::deque<InputEvent> take();
    std::vector<std::filesystem::path> take_dropped();  // files and folders dropped on the window
    std::vector<std::string> pens() const { return pens_.names(); }
    bool woken() const { return woken_; }  // anything at all since take()

    void put(InputEvent event);

private:
    GLFWwindow* window_;
    std::deque<InputEvent> events_;
    std::vector<std::filesystem::path> dropped_;
    PenDevices pens_;
    PenSample pen_;     // the last one
    glm::dvec2 at_{0};  // where the pointer was at the last event: when this is handled, it may be elsewhere
    bool woken_ = true;
};

}  // namespace tangi
