#include "fit/pixel/validation_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/error.h"

namespace tangi {

namespace {

// [1] What explains less than one sample in a hundred more is left as it is: lights and lobes are as listed,
// bit for bit, where there is nothing to find.
constexpr double kWorth = 0.01;

}  // namespace

void ValidationScores::add(const std::vector<double>& squared_errors, double noise,
                           const std::vector<bool>& marked) {
    add_mean({squared_errors}, noise, marked);
}

void ValidationScores::add_mean(const std::vector<std::vector<double>>& squared_errors, double noise,
                                const std::vector<bool>& marked) {
    std::vector<float>& scores = photos_.emplace_back(squared_errors.front().size());
    for (std::size_t k = 0; k < scores.size(); ++k) {
        double explained = 0;
        for (const std::vector<double>& one : squared_errors)
            explained += noise / (one[k] + noise) / static_cast<double>(squared_errors.size());
        scores[k] = marked.empty() || marked[k] ? static_cast<float>(explained)
                                                : std::numeric_limits<float>::quiet_NaN();
    }
}

void ValidationScores::add(const ValidationScores& other) {
    photos_.insert(photos_.end(), other.photos_.begin(), other.photos_.end());
}

ValidationScores::Gain ValidationScores::over(const ValidationScores& other) const {
    TP_REQUIRE(photos_.size() == other.photos_.size(), "scores of the same photographs");
    const std::size_t pixels = photos_.empty() ? 0 : photos_.front().size();
    std::vector<std::vector<double>> gained;
    double sum = 0;
    long count = 0;
    for (std::size_t i = 0; i < photos_.size(); ++i) {
        TP_REQUIRE(photos_[i].size() == pixels && other.photos_[i].size() == pixels, "of the same pixels");
        std::vector<double>& row = gained.emplace_back(pixels);
        for (std::size_t k = 0; k < pixels; ++k) {
            row[k] = static_cast<double>(photos_[i][k]) - static_cast<double>(other.photos_[i][k]);
            if (std::isnan(row[k])) continue;
            sum += row[k];
            ++count;
        }
    }
    if (count == 0) return {};
    const double n = static_cast<double>(count), mean = sum / n;
    std::vector<double> of_pixels(pixels);
    double variance = 0;
    for (const std::vector<double>& row : gained) {
        double of_photo = 0;
        for (std::size_t k = 0; k < pixels; ++k) {
            if (std::isnan(row[k])) continue;
            const double off = row[k] - mean;
            of_photo += off;
            of_pixels[k] += off;
            variance -= off * off;
        }
        variance += of_photo * of_photo;
    }
    for (const double off : of_pixels) variance += off * off;
    // Of few clusters, their common mean has taken up some of the spread (the same paper, p. 241).
    const auto clusters = static_cast<double>(std::min(gained.size(), pixels));
    const double correction = clusters > 1 ? clusters / (clusters - 1) : 1;
    return {mean, std::sqrt(correction * std::max(variance, 0.0)) / n};
}

std::size_t select_model(std::span<const ValidationScores* const> from_simplest) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < from_simplest.size(); ++i)
        if (from_simplest[i]->over(*from_simplest[best]).mean > 0) best = i;
    for (std::size_t i = 0; i < best; ++i) {
        const ValidationScores::Gain gain = from_simplest[best]->over(*from_simplest[i]);
        if (!(gain.mean > std::max(kWorth, gain.sigma))) return i;
    }
    return best;
}

}  // namespace tangi
