// input.h: what the window hears from GLFW, in order and with its time: nothing is lost between two frames.
#pragma once

#include <deque>

#include "viewer/view.h"

struct GLFWwindow;

namespace tangi {

struct InputEvent {
    enum class Kind { move, press, release, wheel, key } kind = Kind::move;
    double time_s = 0;
    glm::dvec2 at{0};  // [pixels of the window]; wheel: how far
    int code = 0;      // button or key, as GLFW numbers them
    int mods = 0;
};

// Listens to a window. There is one at most; panels (Dear ImGui) may be set up after it and hear the same.
class Input {
public:
    explicit Input(GLFWwindow* window);
    ~Input();
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;

    std::deque<InputEvent> take();
    bool woken() const { return woken_; }  // anything at all since take()

    void put(InputEvent event);

private:
    GLFWwindow* window_;
    std::deque<InputEvent> events_;
    bool woken_ = true;
};

}  // namespace tangi
