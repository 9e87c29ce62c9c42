// one_euro.h: a low-pass filter for what a hand or a head does: steady while it rests, quick while it moves.
//
// Casiez, Roussel, Vogel 2012, "1 Euro filter": the cut-off frequency grows with the speed.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

namespace tangi {

class OneEuro {
public:
    // `resting_hz`: the cut-off of what rests; `per_speed`: how much it grows with the speed [Hz for one unit
    // a second].
    OneEuro(double resting_hz, double per_speed) : resting_hz_(resting_hz), per_speed_(per_speed) {}

    glm::dvec2 operator()(const glm::dvec2& value, double time_s) {
        const double seconds = time_s - time_s_;
        if (!started_) last_ = value_ = value;
        if (started_ && seconds > 0) {
            speed_ += weight(kSpeed_hz, seconds) * ((value - last_) / seconds - speed_);
            value_ += weight(resting_hz_ + per_speed_ * glm::length(speed_), seconds) * (value - value_);
            last_ = value;
        }
        started_ = true;
        time_s_ = time_s;
        return value_;
    }

private:
    static constexpr double kSpeed_hz = 1;

    static double weight(double cutoff_hz, double seconds) {
        const double turns = 2 * std::numbers::pi * cutoff_hz * seconds;
        return turns / (turns + 1);
    }

    double resting_hz_, per_speed_, time_s_ = 0;
    bool started_ = false;
    glm::dvec2 value_{0}, last_{0}, speed_{0};
};

}  // namespace tangi
