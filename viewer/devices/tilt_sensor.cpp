#include "viewer/devices/tilt_sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <glm/geometric.hpp>
#include <mutex>
#include <numbers>
#include <thread>
#include <vector>

#include "surface/base/error.h"
#include "surface/file/error_message.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Numbers of a file of sysfs, whatever stands between them.
std::vector<double> numbers_in(const fs::path& file) {
    std::ifstream stream(file);
    std::string text((std::istreambuf_iterator<char>(stream)), {});
    for (char& c : text)
        if (c == ',' || c == ';') c = ' ';
    std::istringstream words(text);
    words.imbue(std::locale::classic());
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    return numbers;
}

constexpr std::array<char, 3> kAxes = {'x', 'y', 'z'};

}  // namespace

std::optional<Accelerometer> Accelerometer::find(const fs::path& root) {
    std::vector<fs::path> folders;
    std::error_code none;
    for (fs::directory_iterator entry(root, none), end; !none && entry != end; entry.increment(none))
        folders.push_back(entry->path());
    std::sort(folders.begin(), folders.end());
    for (const fs::path& folder : folders) {
        Accelerometer found;
        found.folder_ = folder;
        const std::vector<double> shared = numbers_in(folder / "in_accel_scale");
        bool whole = true;
        for (int axis = 0; axis < 3; ++axis) {
            const char letter = kAxes[static_cast<std::size_t>(axis)];
            whole &= !numbers_in(folder / fmt::format("in_accel_{}_raw", letter)).empty();
            const std::vector<double> own = numbers_in(folder / fmt::format("in_accel_{}_scale", letter));
            if (!shared.empty()) found.scale_[axis] = shared.front();
            if (!own.empty()) found.scale_[axis] = own.front();
        }
        if (!whole) continue;
        for (const char* name : {"in_accel_mount_matrix", "in_mount_matrix", "mount_matrix"}) {
            const std::vector<double> rows = numbers_in(folder / name);
            if (rows.size() != 9) continue;
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column)
                    found.mount_[column][row] = rows[static_cast<std::size_t>(3 * row + column)];
            break;
        }
        std::ifstream name(folder / "name");
        if (!std::getline(name, found.name_) || found.name_.empty()) found.name_ = folder.filename().string();
        return found;
    }
    return {};
}

glm::dvec3 Accelerometer::read() const {
    glm::dvec3 value(0);
    for (int axis = 0; axis < 3; ++axis) {
        const std::vector<double> raw =
            numbers_in(folder_ / fmt::format("in_accel_{}_raw", kAxes[static_cast<std::size_t>(axis)]));
        if (raw.empty()) fail("the tilt sensor {} cannot be read any more", name_);
        value[axis] = raw.front() * scale_[axis];
    }
    return mount_ * value;
}

std::optional<glm::dvec2> tilt_between_deg(const glm::dvec3& neutral, const glm::dvec3& now) {
    const double before = glm::length(neutral), after = glm::length(now);
    if (!(before > 0) || !(after > 2.0 / 3 * before) || !(after < 4.0 / 3 * before)) return {};
    // The smallest turn that takes what gravity is on the screen now to what it was: the screen's own.
    const glm::dvec3 a = now / after, b = neutral / before, axis = glm::cross(a, b);
    const double cosine = glm::dot(a, b);
    if (cosine < -0.999) return {};  // upside down: any axis would do
    // Where the screen's normal points (Rodrigues' formula), and with R = Rx Ry its angles.
    const glm::dvec3 z(0, 0, 1);
    const glm::dvec3 normal = z * cosine + glm::cross(axis, z) + axis * glm::dot(axis, z) / (1 + cosine);
    constexpr double kDegree = std::numbers::pi / 180;
    return glm::dvec2(std::atan2(-normal.y, normal.z), std::asin(std::clamp(normal.x, -1.0, 1.0))) / kDegree;
}

struct TiltSensor::Impl {
    Accelerometer accelerometer;
    mutable std::mutex mutex;
    std::condition_variable ends;
    bool over = false;
    News news;
    std::thread thread;

    explicit Impl(Accelerometer found) : accelerometer(std::move(found)), thread([this] { run(); }) {}
    ~Impl() {
        {
            const std::lock_guard lock(mutex);
            over = true;
        }
        ends.notify_all();
        thread.join();
    }
    void run() {
        std::unique_lock lock(mutex);
        while (!over) {
            lock.unlock();
            News next;
            try {
                next.acceleration = accelerometer.read();
            } catch (const std::exception& error) {
                next.lost = message_of(error);
            }
            lock.lock();
            news = next;
            if (!news.lost.empty()) return;
            ends.wait_for(lock, std::chrono::milliseconds(20), [this] { return over; });
        }
    }
};

TiltSensor::TiltSensor(const fs::path& root) {
    std::optional<Accelerometer> found = Accelerometer::find(root);
    if (!found) fail("{}: no accelerometer: this machine tells nobody how it is held", root.string());
    impl_ = std::make_unique<Impl>(std::move(*found));
}
TiltSensor::~TiltSensor() = default;

TiltSensor::News TiltSensor::fetch() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->news;
}

}  // namespace tangi
