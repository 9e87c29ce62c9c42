#include "fit/pixel/pixel_scores.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "surface/base/median.h"

namespace tangi {

void PixelScores::add(const std::vector<double>& squared_errors, double noise,
                      const std::vector<bool>& marked) {
    sum_db_.resize(squared_errors.size());
    photos_.resize(squared_errors.size());
    for (std::size_t k = 0; k < squared_errors.size(); ++k) {
        if (std::isnan(squared_errors[k]) || !(marked.empty() || marked[k])) continue;
        sum_db_[k] -= 10 * std::log10(squared_errors[k] + noise);
        ++photos_[k];
    }
}

void PixelScores::add(const PixelScores& other) {
    sum_db_.resize(std::max(sum_db_.size(), other.sum_db_.size()));
    photos_.resize(sum_db_.size());
    for (std::size_t k = 0; k < other.sum_db_.size(); ++k) {
        sum_db_[k] += other.sum_db_[k];
        photos_[k] += other.photos_[k];
    }
}

std::vector<double> PixelScores::gains_db(const PixelScores& other) const {
    std::vector<double> gains;
    for (std::size_t k = 0; k < std::min(sum_db_.size(), other.sum_db_.size()); ++k)
        if (photos_[k] > 0 && other.photos_[k] > 0)
            gains.push_back(sum_db_[k] / photos_[k] - other.sum_db_[k] / other.photos_[k]);
    return gains;
}

double PixelScores::part_better_than(const PixelScores& other) const {
    const std::vector<double> gains = gains_db(other);
    if (gains.empty()) return 0;
    const auto better = std::ranges::count_if(gains, [](double gain) { return gain > 0; });
    return static_cast<double>(better) / static_cast<double>(gains.size());
}

double PixelScores::median_gain_db(const PixelScores& other) const {
    std::vector<double> gains = gains_db(other);
    return gains.empty() ? 0 : median(std::move(gains));
}

}  // namespace tangi
