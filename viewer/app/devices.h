// devices.h: gamepad, webcam and tilt sensor: what they do to the window's state from frame to frame.
//
// None has to be there. One that vanishes says so, is switched off, and the window goes on.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "viewer/app/gamepad.h"
#include "viewer/devices/tilt_sensor.h"
#include "viewer/devices/webcam.h"

namespace tangi {

class Devices {
public:
    struct Setup {
        std::string camera = "0";                     // as Camera takes it
        std::filesystem::path sensors = kIioDevices;  // where tilt sensors are
        std::function<void()> wake;                   // from other threads
        std::function<void(const std::string&)> say{};
    };
    Devices(WindowState& state, Setup setup) : state_(state), setup_(std::move(setup)) {}

    // Does what state.follow asks for, and what the devices say: `seconds` since the last frame.
    void step(double now_s, double seconds, Extent screen);

    // A device that nobody tells of: it has to be asked again and again.
    bool polled() const { return sensor_ || before_; }

private:
    void camera();
    void sensor(double now_s);
    void gamepad(double seconds, Extent screen);

    WindowState& state_;
    Setup setup_;
    std::unique_ptr<Camera> camera_;
    std::future<void> put_away_;  // a camera whose last picture is still waited for
    Camera::Wants wants_;
    int seen_ = 0;  // pictures of the camera
    HeadFollower head_;
    OneEuro light_{0.5, 2.0};
    std::unique_ptr<TiltSensor> sensor_;
    std::optional<glm::dvec3> level_;  // gravity when the screen was held straight
    OneEuro turned_{1.5, 0.1};
    bool was_flat_ = false;
    std::optional<GamepadMoment> before_;
};

}  // namespace tangi
