// pen.h: a pen on a tablet: how hard it is pressed, how it is held, which end is down.
//
// GLFW 3.3 knows a pen only as a pointer. On X11, XInput 2 tells the rest: PenDevices listens beside GLFW, on
// a connection of its own, and Input puts both together (input.h).
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tangi {

// One moment of a pen.
struct PenSample {
    double pressure = 0;            // [1] 0..1
    double tilt_x = 0, tilt_y = 0;  // [1] sine of the handle's tilt to the right and up; length <= 1
    double rotation_deg = 0;        // of the barrel, counter-clockwise
    bool eraser = false;            // the other end
};

// A valuator of an input device, as XInput 2 describes it.
struct PenAxis {
    int number = 0;
    std::string
        label;  // "Abs Pressure", "Abs Tilt X", "Abs Tilt Y", "Abs Rotary Z", "Abs Wheel"; others are ignored
    double lowest = 0, highest = 1;
    double value = 0;
};

// True for a device that presses: pens, and not mice, touch screens or touchpads.
bool is_pen(const std::vector<PenAxis>& axes);

// "… eraser": drivers make a device of each end of a pen.
bool is_eraser(std::string_view device_name);

// Pressure is the part of its range. Tilts are degrees where the range of the axis lies within +-90, as
// drivers have it; else the range stands for +-60 degrees. The whole range of a rotation is a turn. An axis
// without a range, and values that are not numbers, count as 0; values beyond the range as its end.
PenSample pen_sample(const std::vector<PenAxis>& axes, bool eraser);

// A brush over a painting that lies turned, in the painting's frame.
struct HeldBrush {
    glm::dvec2 tilt{0};       // [1] sine of the handle's tilt towards x and y
    double rotation_deg = 0;  // counter-clockwise; of a brush that follows the stroke, against that
};
// `turn_deg`: of the painting on the screen, counter-clockwise. Without a pen the brush is held upright.
HeldBrush held_over(const std::optional<PenSample>& pen, double turn_deg, bool follows);

// The number of an axis, and its value.
using ToldAxes = std::vector<std::pair<int, double>>;

// A pen, moment by moment: drivers tell only the axes that changed.
//
// What was pressed is over once the tip is up, though drivers may not tell that it is 0: a new stroke begins
// with the pressure that comes with its press, or with the movement just before, else with none.
class Pen {
public:
    Pen(std::vector<PenAxis> axes, bool eraser) : axes_(std::move(axes)), eraser_(eraser) {}

    PenSample move(const ToldAxes& told);
    PenSample press(const ToldAxes& told);
    PenSample release(const ToldAxes& told);
    bool down() const { return down_; }

private:
    bool tell(const ToldAxes& told);  // true where pressure is among it
    void forget_pressure();

    std::vector<PenAxis> axes_;
    bool eraser_ = false, down_ = false;
    bool fresh_ = false;  // the last movement told the pressure
};

// One thing that a pointing device did.
struct DeviceStep {
    enum class Kind { move, press, release } kind = Kind::move;
    int button = 0;                  // as X numbers them: 1 left, 2 middle, 3 right
    std::optional<PenSample> pen{};  // empty: of a mouse
};

// What pointing devices did since the last time.
struct PenNews {
    std::vector<DeviceStep> steps;  // of all of them, in order; none where there is no pen
    bool down = false;              // a pen's tip (or eraser) is on the tablet now
    bool lost = false;              // a pen that was down is gone: unplugged, or its receiver
};

// Pens come and go while it listens. Where there is no X server or no XInput 2.2, there are never any.
class PenDevices {
public:
    PenDevices();
    ~PenDevices();
    PenDevices(const PenDevices&) = delete;
    PenDevices& operator=(const PenDevices&) = delete;

    // All that happened before what GLFW has told by now is among it.
    PenNews take();
    std::vector<std::string> names() const;  // of the pens that are there

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
