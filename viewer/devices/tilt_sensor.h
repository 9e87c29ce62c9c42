// tilt_sensor.h: how the screen is held, from its accelerometer, as Linux's Industrial I/O subsystem (IIO)
// tells it.
//
// Folders /sys/bus/iio/devices/iio:deviceN hold in_accel_{x,y,z}_raw, a scale to m/s^2 and a mount matrix;
// frame after that: x right, y up, z out of the screen.
#pragma once

#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>

namespace tangi {

inline constexpr const char* kIioDevices = "/sys/bus/iio/devices";

class Accelerometer {
public:
    // The first accelerometer under `root`; nothing where there is none.
    static std::optional<Accelerometer> find(const std::filesystem::path& root = kIioDevices);

    // [m/s^2] in the screen's frame; the sign is the driver's. Throws Error where it cannot be read any more.
    glm::dvec3 read() const;
    const std::string& name() const { return name_; }

private:
    std::filesystem::path folder_;
    std::string name_;
    glm::dvec3 scale_{1};
    glm::dmat3 mount_{1};
};

// How far the screen has turned about its x and y since gravity was `neutral` (as Tilt::angle_deg), by the
// smallest turn; a turn about the plumb line is not seen. Nothing where one of them is no gravity (free fall,
// a knock): not within a third of the other's length.
std::optional<glm::dvec2> tilt_between_deg(const glm::dvec3& neutral, const glm::dvec3& now);

// Reads an accelerometer on a thread of its own, since a slow bus must not hold up a frame.
class TiltSensor {
public:
    // Throws Error where there is no accelerometer.
    explicit TiltSensor(const std::filesystem::path& root = kIioDevices);
    ~TiltSensor();
    TiltSensor(const TiltSensor&) = delete;
    TiltSensor& operator=(const TiltSensor&) = delete;

    struct News {
        std::optional<glm::dvec3> acceleration;  // [m/s^2] the last
        std::string lost;                        // why there is no more of it
    };
    News fetch() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
