// log_ratio.h: the mean ln of a ratio over parts of a picture, and how sure it is.
#pragma once

#include <algorithm>
#include <cmath>

namespace tangi {

class LogRatio {
public:
    void add(double a, double b) {
        const double ratio = std::log(std::max(a, kNone) / std::max(b, kNone));
        ++n_, sum_ += ratio, squares_ += ratio * ratio;
    }
    double count() const { return n_; }
    double mean() const { return sum_ / n_; }
    // [standard errors] By which the mean is below 0.
    double certainty() const {
        const double variance = std::max(squares_ / n_ - mean() * mean(), 0.0);
        return -mean() / std::max(std::sqrt(variance / (n_ - 1)), 1e-9);
    }

private:
    static constexpr double kNone = 1e-30;
    double n_ = 0, sum_ = 0, squares_ = 0;
};

}  // namespace tangi
