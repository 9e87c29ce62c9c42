#include "viewer/devices/pen.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

namespace tangi {

namespace {

constexpr std::string_view kPressure = "Abs Pressure";

const PenAxis* axis_of(const std::vector<PenAxis>& axes, std::string_view label) {
    for (const PenAxis& axis : axes)
        if (axis.label == label && axis.highest > axis.lowest) return &axis;
    return nullptr;
}

// [1] 0..1 of the axis's range.
double part_of_range(const PenAxis& axis) {
    const double value = std::isfinite(axis.value) ? axis.value : 0;
    return std::clamp((value - axis.lowest) / (axis.highest - axis.lowest), 0.0, 1.0);
}

double tangent_of_tilt(const PenAxis* axis) {
    if (!axis) return 0;
    constexpr double kOtherwise_deg = 60, kMost_deg = 89;
    double angle_deg = kOtherwise_deg * (2 * part_of_range(*axis) - 1);
    if (axis->lowest >= -90 && axis->highest <= 90 && axis->lowest < 0)
        angle_deg = std::isfinite(axis->value) ? std::clamp(axis->value, axis->lowest, axis->highest) : 0;
    return std::tan(std::clamp(angle_deg, -kMost_deg, kMost_deg) * std::numbers::pi / 180);
}

}  // namespace

bool is_pen(const std::vector<PenAxis>& axes) {
    return axis_of(axes, kPressure) && axis_of(axes, "Abs X") && axis_of(axes, "Abs Y");
}

bool is_eraser(std::string_view device_name) {
    std::string lower;
    for (const char c : device_name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return lower.find("eraser") != std::string::npos;
}

PenSample pen_sample(const std::vector<PenAxis>& axes, bool eraser) {
    PenSample sample;
    sample.eraser = eraser;
    if (const PenAxis* pressure = axis_of(axes, kPressure)) sample.pressure = part_of_range(*pressure);
    // The two angles are those of the handle's shadows on the planes xz and yz; y of the tablet runs down.
    const double x = tangent_of_tilt(axis_of(axes, "Abs Tilt X"));
    const double y = -tangent_of_tilt(axis_of(axes, "Abs Tilt Y"));
    const double length = std::sqrt(1 + x * x + y * y);
    sample.tilt_x = x / length;
    sample.tilt_y = y / length;
    const PenAxis* rotation = axis_of(axes, "Abs Rotary Z");
    if (!rotation) rotation = axis_of(axes, "Abs Wheel");
    if (rotation) sample.rotation_deg = -360 * (part_of_range(*rotation) - 0.5);
    return sample;
}

HeldBrush held_over(const std::optional<PenSample>& pen, double turn_deg, bool follows) {
    const PenSample hand = pen.value_or(PenSample{});
    const double a = turn_deg * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
    HeldBrush held;
    held.tilt = {c * hand.tilt_x + s * hand.tilt_y, c * hand.tilt_y - s * hand.tilt_x};
    held.rotation_deg = follows ? hand.rotation_deg : std::remainder(hand.rotation_deg - turn_deg, 360.0);
    return held;
}

bool Pen::tell(const ToldAxes& told) {
    bool pressure = false;
    for (const auto& [number, value] : told)
        for (PenAxis& axis : axes_)
            if (axis.number == number) {
                axis.value = value;
                pressure = pressure || axis.label == kPressure;
            }
    return pressure;
}

void Pen::forget_pressure() {
    for (PenAxis& axis : axes_)
        if (axis.label == kPressure) axis.value = axis.lowest;
}

PenSample Pen::move(const ToldAxes& told) {
    fresh_ = tell(told);
    return pen_sample(axes_, eraser_);
}

PenSample Pen::press(const ToldAxes& told) {
    if (!tell(told) && !fresh_) forget_pressure();
    down_ = true;
    return pen_sample(axes_, eraser_);
}

PenSample Pen::release(const ToldAxes& told) {
    tell(told);
    forget_pressure();
    down_ = fresh_ = false;
    return pen_sample(axes_, eraser_);
}

}  // namespace tangi
