#include "surface/maps/light_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tangi {

namespace {

using Terms = std::array<double, 6>;

// Of ln gain, and of what a term of a beam makes of ln irradiance at the picture's border:
constexpr double kOutlier = 0.1;      // [1] leftover from which a light counts less for the trend
constexpr double kTrendSigma = 0.3;   // [1] how much of a trend is to be expected
constexpr double kScoreScale = 0.05;  // [1] errors well above count by their number, not their size
// [standard errors] By which a light must be predicted better from its direction than by the mean of all: of
// many ways, one is the best by chance (generated lights of random strengths: 0.35 dB of held-out photographs
// on average, 2.2 at most; real stacks, whose strengths go with their directions, stay as they were).
constexpr double kSure = 2;

Terms terms_of(const Vec3& l) { return {1, l.x, l.y, l.x * l.x, l.x * l.y, l.y * l.y}; }

double dot(const Terms& a, const Terms& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

// What is known of lights in some directions.
struct Known {
    std::span<const Light> lights;
    std::vector<double> values;  // one a light
};

Known log_gains(std::span<const Light> lights) {
    Known known{lights, {}};
    for (const Light& light : lights)
        known.values.push_back(std::log(std::max(static_cast<double>(light.gain.g), 1e-6)));
    return known;
}

// [1/mm^degree] What a term of a beam is multiplied by.
double unit_of(std::size_t term, double radius_mm) { return term < 2 ? radius_mm : radius_mm * radius_mm; }

Known beam_terms(std::span<const Light> lights, std::size_t term, double radius_mm) {
    Known known{lights, {}};
    for (const Light& light : lights)
        known.values.push_back(static_cast<double>(light.beam.terms[term]) * unit_of(term, radius_mm));
    return known;
}

// Solves a x = b for a symmetric positive definite a by Cholesky's decomposition.
Terms solved(std::array<Terms, 6> a, Terms b) {
    constexpr std::size_t n = 6;
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
        a[j][j] = std::sqrt(a[j][j]);
        for (std::size_t i = j + 1; i < n; ++i) {
            for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
    return b;
}

// `validation` < 0: none. Without a slope the trend is the robust mean.
Terms fitted_trend(const Known& known, int validation, bool slopes) {
    Terms trend{};
    for (int iteration = 0; iteration < 8; ++iteration) {
        std::array<Terms, 6> a{};
        Terms b{};
        for (std::size_t i = 0; i < a.size(); ++i)
            a[i][i] = i == 0 ? 1e-9 : (slopes ? kOutlier * kOutlier / (kTrendSigma * kTrendSigma) : 1e12);
        for (std::size_t i = 0; i < known.values.size(); ++i) {
            if (static_cast<int>(i) == validation) continue;
            const Terms t = terms_of(known.lights[i].direction);
            const double value = known.values[i], r = (value - dot(trend, t)) / kOutlier;
            const double weight = iteration == 0 ? 1 : 1 / (1 + r * r);
            for (std::size_t j = 0; j < t.size(); ++j) {
                for (std::size_t k = 0; k < t.size(); ++k) a[j][k] += weight * t[j] * t[k];
                b[j] += weight * t[j] * value;
            }
        }
        trend = solved(a, b);
    }
    return trend;
}

double predicted(const LightModel& model, const Known& known, const Vec3& direction, int validation = -1) {
    double sum = 0, weight = model.shrink;
    for (std::size_t i = 0; i < known.values.size(); ++i) {
        if (static_cast<int>(i) == validation) continue;
        const Vec3& listed = known.lights[i].direction;
        const Vec3 d = listed - direction;
        const double w = std::exp(-glm::dot(d, d) / (2 * model.reach * model.reach));
        sum += w * (known.values[i] - dot(model.trend, terms_of(listed)));
        weight += w;
    }
    return dot(model.trend, terms_of(direction)) + sum / weight;
}

// Whether errors are smaller by kSure standard errors of the mean difference.
bool is_surely_better(const std::vector<double>& errors, const std::vector<double>& others) {
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double gain = others[i] - errors[i];
        sum += gain;
        squares += gain * gain;
    }
    const double n = static_cast<double>(errors.size()), mean = sum / n;
    return mean > kSure * std::sqrt(std::max(squares / n - mean * mean, 0.0) / std::max(n - 1, 1.0));
}

LightModel fitted(const Known& known) {
    struct Candidate {
        bool slopes;
        double reach, shrink, score = 0;
        std::vector<double> scores{};  // one a light
    };
    std::vector<Candidate> candidates;
    for (const bool slopes : {false, true})
        for (const double reach : {0.1, 0.2, 0.4})
            for (const double shrink : {1e9, 3.0, 1.0, 0.3}) candidates.push_back({slopes, reach, shrink});
    constexpr std::size_t kSame = 0;  // all lights have the mean
    for (std::size_t i = 0; i < known.values.size(); ++i) {
        const int out = static_cast<int>(i);
        const std::array<Terms, 2> trends = {fitted_trend(known, out, false), fitted_trend(known, out, true)};
        for (Candidate& c : candidates) {
            const LightModel model{trends[c.slopes], c.reach, c.shrink};
            const double error =
                (predicted(model, known, known.lights[i].direction, out) - known.values[i]) / kScoreScale;
            c.scores.push_back(std::log1p(error * error));
            c.score += c.scores.back();
        }
    }
    const Candidate& best = *std::min_element(candidates.begin(), candidates.end(),
                                              [](const auto& a, const auto& b) { return a.score < b.score; });
    const Candidate& same = candidates[kSame];
    const Candidate& chosen = is_surely_better(best.scores, same.scores) ? best : same;
    return {fitted_trend(known, -1, chosen.slopes), chosen.reach, chosen.shrink};
}

}  // namespace

LightModel fit_light_model(std::span<const Light> lights) {
    return lights.empty() ? LightModel{} : fitted(log_gains(lights));
}

double predicted_gain(const LightModel& model, std::span<const Light> lights, const Vec3& direction) {
    return std::exp(predicted(model, log_gains(lights), direction));
}

Rgb predicted_colour(std::span<const Light> lights, const Vec3& direction) {
    Rgb colour(1);
    const auto is_grey = [](const Light& light) { return light.gain == Rgb(light.gain.g); };
    if (std::ranges::all_of(lights, is_grey)) return colour;
    for (const int channel : {0, 2}) {
        Known known{lights, {}};
        for (const Light& light : lights)
            known.values.push_back(std::log(std::max(light.gain[channel] / light.gain.g, 1e-6f)));
        colour[channel] = static_cast<float>(std::exp(predicted(fitted(known), known, direction)));
    }
    return colour;
}

BeamModel fit_beam_model(std::span<const Light> lights, double radius_mm) {
    BeamModel model{.radius_mm = radius_mm};
    for (std::size_t term = 0; term < model.terms.size() && !lights.empty(); ++term)
        model.terms[term] = fitted(beam_terms(lights, term, radius_mm));
    return model;
}

Beam predicted_beam(const BeamModel& model, std::span<const Light> lights, const Vec3& direction) {
    Beam beam;
    for (std::size_t term = 0; term < model.terms.size(); ++term) {
        const Known known = beam_terms(lights, term, model.radius_mm);
        beam.terms[term] = static_cast<float>(predicted(model.terms[term], known, direction) /
                                              unit_of(term, model.radius_mm));
    }
    return beam;
}

}  // namespace tangi
