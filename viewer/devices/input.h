// input.h: what the window hears from GLFW, in order and with its time: nothing is lost between two frames.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "viewer/devices/pen.h"
#include "viewer/devices/touch.h"
#include "viewer/render/view.h"

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
    std::optional<PenSample> pen{};                                   // where a pen moved the pointer
    enum class Source { mouse, pen, finger } source = Source::mouse;  // of the pointer and its buttons
    // Gesture, whose middle is `at`: moved by [pixels], enlarged, turned counter-clockwise.
    glm::dvec2 by{0};
    double factor = 1, turn_deg = 0;
    // Nobody listens while a slow frame is drawn: it happened at most so long before it was heard.
    double late_s = 0;
};

// Finds out which device each event of the pointer is of: GLFW tells what the pointer of all of them did, a
// connection of its own what each did, both in the order in which it happened. No X11.
//
// A pen that is near puts the mouse out of action, and fingers: the hand that holds it rests on the table,
// its palm on the screen. A pen is near while it is told of: its hand is never so still that it were not.
class PointerStream {
public:
    static constexpr double kNear_s = 0.5;

    // Gives events their source and the pen's sample, and takes those out that a pen puts out of action.
    void sort(std::deque<InputEvent>& events, const PenNews& news, double now_s);
    bool pen_is_near(double now_s) const { return pen_down_ || now_s - pen_s_ < kNear_s; }

private:
    struct Step {
        DeviceStep step;
        bool carried = false;  // GLFW had told nothing of it when it was heard
    };
    void give(InputEvent& event, const DeviceStep& step, double now_s);
    bool takes(const InputEvent& event, double now_s);
    void sort_moves(const std::vector<InputEvent*>& moves, std::size_t until, double now_s);

    std::deque<Step> steps_;  // that no event was found for yet
    DeviceStep last_;         // what an event is of that nothing is known about
    double pen_s_ = -1e9;     // when a pen was told of last
    bool pen_down_ = false;
    unsigned held_ = 0;  // buttons of the mouse, as bits, whose press was let through
};

// Of `moves` movements of the pointer and `steps` > 0 of the devices: the step that belongs to the i-th.
std::size_t step_of(std::size_t i, std::size_t moves, std::size_t steps);

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
    PointerStream stream_;
    TouchScreens screens_;
    Fingers fingers_;
    glm::dvec2 at_{0};  // where the pointer was at the last event: when this is handled, it may be elsewhere
    double listens_s_ = 0, heard_s_ = 0;  // when hear() began and ended
    double taken_s_ = 0;                  // take(): fingers are heard there
    bool woken_ = true;
};

}  // namespace tangi
