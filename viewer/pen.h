// pen.h: a pen on a tablet: how hard it is pressed, how it is held, which end is down.
//
// GLFW 3.3 knows a pen only as a pointer. On X11, XInput 2 tells the rest: PenDevices listens beside GLFW, on
// a connection of its own, and Input puts both together (input.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
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

// What pens did since the last time.
struct PenNews {
    std::vector<PenSample> samples;  // in order; as many as the pointer moved
    bool down = false;               // its tip (or eraser) is on the tablet now
    bool lost = false;               // a pen that was down is gone: unplugged, or its receiver
};

// Pens come and go while it listens. Where there is no X server or no XInput 2.2, there are never any.
class PenDevices {
public:
    PenDevices();
    ~PenDevices();
    PenDevices(const PenDevices&) = delete;
    PenDevices& operator=(const PenDevices&) = delete;

    PenNews take();
    std::vector<std::string> names() const;  // of the pens that are there

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// The sample of the i-th of `count` movements of the pointer: samples and movements come over different
// connections, in the same order. `count` > 0, and there are samples.
const PenSample& sample_of(const std::vector<PenSample>& samples, std::size_t i, std::size_t count);

}  // namespace tangi
