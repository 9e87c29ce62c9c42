#include "viewer/app/devices.h"

#include <utility>

#include "surface/base/error.h"

namespace tangi {

void Devices::step(double now_s, double seconds, Extent screen) {
    if (std::exchange(state_.follow.recentre, false)) {
        head_.recentre();
        level_.reset();
    }
    gamepad(seconds, screen);
    camera();
    sensor(now_s);
}

void Devices::gamepad(double seconds, Extent screen) {
    const std::optional<GamepadSeen> seen = gamepad_now();
    if (!seen && before_) setup_.say(state_.follow.gamepad + " is gone");
    state_.follow.gamepad = seen ? seen->name : "";
    if (seen) apply_gamepad(seen->moment, before_.value_or(seen->moment), seconds, screen, state_);
    before_ = seen ? std::optional(seen->moment) : std::nullopt;
}

void Devices::camera() {
    Following& follow = state_.follow;
    const Camera::Wants wants{follow.head, follow.light};
    if (!wants.head) state_.viewer = {0, 0, 1};
    if (wants == Camera::Wants{}) {
        follow.sees_head = false;
        // The window does not wait for a picture that is still to come.
        if (camera_) put_away_ = std::async(std::launch::async, [old = std::move(camera_)] {});
        return;
    }
    if (!camera_) {
        camera_ = std::make_unique<Camera>(setup_.camera, wants, setup_.wake);
        seen_ = 0;
        head_ = {};
        light_ = OneEuro(0.5, 2.0);
    } else if (wants != wants_) {
        camera_->want(wants);
    }
    wants_ = wants;
    const Camera::News news = camera_->fetch();
    if (!news.lost.empty()) {
        setup_.say(news.lost);
        follow.head = follow.light = follow.sees_head = false;
        state_.viewer = {0, 0, 1};
        camera_.reset();
        return;
    }
    if (news.pictures == std::exchange(seen_, news.pictures)) return;
    follow.sees_head = news.face.has_value();
    if (wants.head) state_.viewer = head_.see(news.face, news.time_s);
    if (wants.light && news.light && !state_.comparing.on) {
        state_.sweeping = false;
        const glm::dvec2 place = light_({news.light->x, news.light->y}, news.time_s);
        state_.lights[state_.light].angles = light_at(place);
    }
}

void Devices::sensor(double now_s) {
    bool& wanted = state_.follow.sensor;
    if (!wanted) {
        if (!sensor_) return;
        sensor_.reset();
        state_.flat = was_flat_;
        state_.tilt = sent_back(state_.tilt);
        return;
    }
    try {
        if (!sensor_) {
            sensor_ = std::make_unique<TiltSensor>(setup_.sensors);
            level_.reset();
            turned_ = OneEuro(1.5, 0.1);
            was_flat_ = std::exchange(state_.flat, true);
        }
    } catch (const Error& error) {
        setup_.say(error.what());
        wanted = false;
        return;
    }
    const TiltSensor::News news = sensor_->fetch();
    if (!news.lost.empty()) {
        setup_.say(news.lost);
        wanted = false;
        return;
    }
    if (!news.acceleration) return;
    if (!level_) level_ = news.acceleration;
    if (const auto turned = tilt_between_deg(*level_, *news.acceleration)) {
        const glm::dvec2 most(Tilt::kMost_deg);
        state_.tilt = Tilt{.angle_deg = glm::clamp(turned_(*turned, now_s), -most, most)};
    }
}

}  // namespace tangi
