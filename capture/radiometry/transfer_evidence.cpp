#include "capture/radiometry/transfer_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/median.h"
#include "surface/maps/light.h"

namespace tangi {

namespace {

constexpr int kEvidenceSamples = 1500;  // enough: the choice is between a handful of curves
constexpr int kEvidenceRounds = 3;      // of strengths: further ones change the residuals by 3 %
constexpr std::size_t kGroups = 8;      // of photographs, each left out in turn
constexpr double kUnknowns = 3;         // of matt reflection, a pixel
// ln of residuals by which the true curve may fit worse than another, as gloss, shadows and light between
// relief make it, and what is added where one photograph more than pixels have unknowns is all there is. Rms
// of 76 generated stacks in four encodings (lights in one ring at 30 to 60 degrees, domes, near and unequal
// lights; matt, glossy, gilded; linear to gamma 2.2): 0.07 with 8 lights in a ring and more, 0.15 with 5. Of
// 84 others, with room light and grounds of gold: 0.13 with 8, 0.10 with 12, 0.19 with 16, 0.09 with 24, 0.05
// with 40.
constexpr double kMisfit = 0.12, kMisfitOfFew = 0.25;
// [1] What gloss and light from all around make of ln strengths, as stored, even of lights that are equal.
constexpr double kEqualLights = 0.06;
// Lights side by side share what is wrong with them: each counts for a part of one, and beyond so many more
// say no more.
constexpr double kWorthOfLight = 0.3, kMostViewLights = 30;
// [1] d ln strength / d ln l.z: of rigs, whose lights are alike; of a light that is carried, which is held
// nearer or farther where it is low; and of what is mostly metal, which shines under high lights: 1.2 to 1.9
// in four generated stacks with a ground of gold over two thirds. Metal is taken for one picture in ten: a
// guess.
constexpr double kTrendOfRig = 0.05, kTrendOfCarried = 0.3, kTrendOfMetal = 1.5, kMostlyMetal = 0.1;
constexpr double kLeastHeights = 0.03;  // [1] scatter of ln l.z: below, lights stand in one ring
// What files of these kinds, without metadata, are beforehand: published sets of photographs for relighting
// are linear light in JPEG as well as sRGB; a gamma of 1.8 was that of a system and of two colour spaces;
// others are somebody's own.
constexpr double kLinearOf16 = 0.47, kSrgbOf16 = 0.3, kLinearOf8 = 0.27, kSrgbOf8 = 0.5, kGamma22 = 0.17,
                 kGamma18 = 0.06, kOther = 0.0005;

// d ln(linear) / d ln(encoded) in the middle of what is stored.
double gamma_at(const Transfer& transfer, double stored) {
    constexpr double step = 1.1;
    const auto decoded = [&](double e) {
        return std::max(static_cast<double>(transfer.decode(static_cast<float>(e))), 1e-9);
    };
    return std::log(decoded(stored * step) / decoded(stored / step)) / (2 * std::log(step));
}

double middling_stored(const Survey& survey) {
    std::vector<float> values;
    for (const float value : survey.values)
        if (!std::isnan(value)) values.push_back(value);
    return std::clamp(static_cast<double>(median(std::move(values))), 0.02, 0.8);
}

std::vector<double> log_heights(const Stack& stack) {
    std::vector<double> heights;
    for (const StackPhoto& photo : stack.photos)
        heights.push_back(std::log(std::max(static_cast<double>(photo.light.direction.z), 0.05)));
    return heights;
}

double scatter(std::vector<double> values) {
    const double middle = median(values);
    for (double& value : values) value = std::abs(value - middle);
    return 1.4826 * median(std::move(values));
}

bool stand_at_several_heights(const Stack& stack) {
    const std::vector<double> heights = log_heights(stack);
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    double mean = 0, squares = 0;
    for (const double h : heights) mean += h / static_cast<double>(heights.size());
    for (const double h : heights) squares += (h - mean) * (h - mean);
    return low != heights.end() && *high > *low &&
           std::sqrt(squares / static_cast<double>(heights.size())) > kLeastHeights;
}

// Of a straight line through strengths over heights, robustly (Cauchy).
double trend_of(const std::vector<double>& heights, const std::vector<double>& strengths) {
    double trend = 0, at_zero = median(strengths);
    std::vector<double> weights(heights.size(), 1);
    for (int sweep = 0; sweep < 20; ++sweep) {
        double w = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (std::size_t i = 0; i < heights.size(); ++i) {
            w += weights[i], x += weights[i] * heights[i], y += weights[i] * strengths[i];
            xx += weights[i] * heights[i] * heights[i], xy += weights[i] * heights[i] * strengths[i];
        }
        const double spread = w * xx - x * x;
        if (!(spread > 1e-9)) return 0;
        trend = (w * xy - x * y) / spread;
        at_zero = (y - trend * x) / w;
        std::vector<double> sizes;
        for (std::size_t i = 0; i < heights.size(); ++i)
            sizes.push_back(std::abs(strengths[i] - at_zero - trend * heights[i]));
        const double limit = 2 * (1.4826 * median(sizes) + 1e-3);
        for (std::size_t i = 0; i < heights.size(); ++i)
            weights[i] = 1 / (1 + (sizes[i] / limit) * (sizes[i] / limit));
    }
    return trend;
}

double prior_of(const Transfer& transfer, const Stack& stack) {
    const bool deep = stack.bits > 8;
    switch (transfer.kind) {
        case Transfer::Kind::linear:
            return deep ? kLinearOf16 : kLinearOf8;
        case Transfer::Kind::srgb:
            return deep ? kSrgbOf16 : kSrgbOf8;
        case Transfer::Kind::gamma:
            return transfer.gamma == 2.2 ? kGamma22 : transfer.gamma == 1.8 ? kGamma18 : kOther;
        case Transfer::Kind::curve:
            return kOther;
    }
    return kOther;
}

// Standard error of ln of the ratio of two residuals, by leaving out photographs (jackknife, Quenouille
// 1956).
double sigma_of(const TransferTrial& a, const TransferTrial& b) {
    const std::size_t groups = std::min(a.partial.size(), b.partial.size());
    if (groups < 2) return 0;
    double mean = 0, squares = 0;
    const auto log_ratio = [&](std::size_t g) {
        return std::log(std::max(a.partial[g], 1e-9) / std::max(b.partial[g], 1e-9));
    };
    const double n = static_cast<double>(groups);
    for (std::size_t g = 0; g < groups; ++g) mean += log_ratio(g) / n;
    for (std::size_t g = 0; g < groups; ++g) squares += (log_ratio(g) - mean) * (log_ratio(g) - mean);
    return std::sqrt(squares * (n - 1) / n);
}

double density(double value, double sigma) { return std::exp(-value * value / (2 * sigma * sigma)) / sigma; }

// How likely the lights' strengths are, as a curve has them: as equal as they turn out to be, half of all
// rigs with lights that are alike.
double log_evidence_of_lights(const TransferTrial& trial, double lights) {
    const double own = std::hypot(trial.strength_scatter, kEqualLights);
    const double trend =
        (1 - kMostlyMetal) / 2 *
            (density(trial.strength_trend, kTrendOfRig) + density(trial.strength_trend, kTrendOfCarried)) +
        kMostlyMetal * density(trial.strength_trend, kTrendOfMetal);
    return -lights * std::log(own) + std::log(trend + 1e-12);
}

}  // namespace

TransferTrial try_transfer(const Stack& stack, const Survey& survey, const Transfer& transfer) {
    const std::vector<Light> lights = stack.lights();
    const int width = stack.width(), height = stack.height();
    TransferTrial trial{.transfer = transfer};
    const LinearSurvey linear{survey, transfer, width, height};
    MattSample sample = matt_sample(lights, linear, kEvidenceSamples);
    trial.equal_residual = sample.residual();
    for (int round = 1; round < kEvidenceRounds; ++round) refine(sample, linear);
    trial.residual = sample.residual();
    const std::size_t groups = std::min(kGroups, lights.size());
    for (std::size_t group = 0; group < groups; ++group)
        trial.partial.push_back(sample.residual(MattSample::Left{group, groups}));
    const double gamma = gamma_at(transfer, middling_stored(survey));
    trial.strength_scatter = scatter(sample.log_strengths) / std::max(gamma, 0.1);
    trial.strength_trend = trend_of(log_heights(stack), sample.log_strengths);
    for (const LambertEstimate& estimate : sample.estimates)
        trial.normals.push_back(estimate.valid ? Vec3(estimate.normal) : Vec3(0));
    return trial;
}

void weigh(std::vector<TransferTrial>& trials, const Stack& stack) {
    if (trials.empty()) return;
    const TransferTrial best = *std::min_element(
        trials.begin(), trials.end(),
        [](const TransferTrial& a, const TransferTrial& b) { return a.residual < b.residual; });
    const double photos = static_cast<double>(stack.photos.size());
    const double misfit = kMisfit + kMisfitOfFew / std::max(photos - kUnknowns, 1.0);
    const double lights = std::clamp(kWorthOfLight * (photos - 2), 0.0, kMostViewLights);
    const bool heights = stand_at_several_heights(stack);
    double most = -1e300;
    for (TransferTrial& trial : trials) {
        const double worse = std::log(std::max(trial.residual, 1e-9) / std::max(best.residual, 1e-9)) /
                             std::hypot(misfit, sigma_of(trial, best));
        trial.log_evidence = -worse * worse / 2 + (heights ? log_evidence_of_lights(trial, lights) : 0);
        most = std::max(most, trial.log_evidence);
    }
    double sum = 0;
    for (TransferTrial& trial : trials) {
        trial.log_evidence -= most;
        trial.probability = prior_of(trial.transfer, stack) * std::exp(trial.log_evidence);
        sum += trial.probability;
    }
    for (TransferTrial& trial : trials) trial.probability /= sum;
}

double slopes_change_deg(const TransferTrial& a, const TransferTrial& b) {
    std::vector<float> angles;
    for (std::size_t k = 0; k < std::min(a.normals.size(), b.normals.size()); ++k)
        if (a.normals[k].z > 0 && b.normals[k].z > 0)
            angles.push_back(std::atan2(glm::length(glm::cross(a.normals[k], b.normals[k])),
                                        glm::dot(a.normals[k], b.normals[k])));
    return static_cast<double>(median(std::move(angles))) * kDegrees;
}

}  // namespace tangi
