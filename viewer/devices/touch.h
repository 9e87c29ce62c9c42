// touch.h: fingers on a touch screen: one is the left button of a mouse, two move, enlarge and turn the
// painting.
//
// GLFW 3.3 knows fingers only as the pointer that X makes of the first one. On X11, XInput 2.2 tells of each:
// TouchScreens listens beside GLFW, and who listens to fingers hears no pointer that is made of them.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

struct GLFWwindow;

namespace tangi {

struct InputEvent;

struct TouchEvent {
    enum class Kind { begin, move, end, lost } kind = Kind::begin;  // lost: by the window system
    int finger = 0;                                                 // its number, as long as it is down
    double time_s = 0;
    glm::dvec2 at{0};  // [pixels of the window]
};

// Makes events of a mouse, and gestures, of what fingers do. No X11.
class Fingers {
public:
    // A finger that has just come down may be the first of two: until it moves this far, or stays this long,
    // nothing happens.
    static constexpr double kStill_px = 8, kWait_s = 0.12;
    // Two fingers turn the painting once they have turned this far.
    static constexpr double kTurn_deg = 10;

    void take(const TouchEvent& event, std::vector<InputEvent>& out);
    void pass(double now_s, std::vector<InputEvent>& out);  // time
    // A pen is near: the fingers that are down are of the hand that holds it. None of them does anything any
    // more.
    void give_way(double now_s, std::vector<InputEvent>& out);

    // For the panels: where the finger is that is the pointer, or was in the last calls. Empty where a mouse
    // is.
    std::optional<glm::dvec2> pointer();

private:
    struct Finger {
        int number = 0;
        glm::dvec2 from{0}, at{0};
        double began_s = 0;
    };
    enum class State { none, waits, presses, two, over };  // over: until all fingers are up

    void begin(const TouchEvent& event);
    void move(const TouchEvent& event, std::vector<InputEvent>& out);
    void end(const TouchEvent& event, std::vector<InputEvent>& out);
    void press(double time_s, std::vector<InputEvent>& out);
    void pinch(const Finger& old_first, const Finger& old_second, double time_s,
               std::vector<InputEvent>& out);

    State state_ = State::none;
    std::vector<Finger> fingers_;  // that are down; the first two count
    double turned_deg_ = 0;
    bool turns_ = false;
    int after_ = 0;  // calls of pointer() since the finger was lifted
    glm::dvec2 last_{0};
};

// Touch screens come and go while it listens. Where there is no X server, or none with XInput 2.2, there are
// never any.
class TouchScreens {
public:
    explicit TouchScreens(GLFWwindow* window);
    ~TouchScreens();
    TouchScreens(const TouchScreens&) = delete;
    TouchScreens& operator=(const TouchScreens&) = delete;

    bool any() const;
    std::vector<TouchEvent> take(double now_s);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
