#include "fit/lobe_prior.h"

#include <algorithm>
#include <cmath>

namespace tangi {

namespace {

constexpr int kStep = 2;                  // [pixels] between neighbours that are asked
constexpr double kColour = 0.15;          // [1] difference, relative to the brightness, of another material
constexpr double kColourFloor = 0.02;     // [1] ... and what noise makes of dark colours
constexpr double kLnAlphaSpread = 0.15;   // [1] within one material, at least
constexpr double kSpecularSpread = 0.01;  // [1] likewise
constexpr double kSpecularPart = 0.1;     // [1] of rho_s, likewise

// Weighted mean and variance of what neighbours have, started from one pseudo-neighbour.
struct Moments {
    double weight, sum, squares;
    Moments(double value, double sigma, double by)
        : weight(by / (sigma * sigma)), sum(weight * value), squares(weight * value * value) {}
    void add(double value, double w) {
        weight += w;
        sum += w * value;
        squares += w * value * value;
    }
    double mean() const { return sum / weight; }
    double variance() const { return std::max(squares / weight - mean() * mean(), 0.0); }
};

}  // namespace

WardPrior lobe_prior_at(const Surface& s, const FitErrors& errors, const WardPrior& general, int x, int y) {
    const Rgb& colour = s.diffuse(x, y);
    const double scale = kColour * (colour.r + colour.g + colour.b) / 3 + kColourFloor;
    Moments ln_alpha(general.ln_alpha, general.ln_alpha_sigma, 1),
        specular(general.specular, general.specular_sigma, 1);
    for (int v = y - kLobeReach; v <= y + kLobeReach; v += kStep)
        for (int u = x - kLobeReach; u <= x + kLobeReach; u += kStep) {
            if ((u == x && v == y) || u < 0 || v < 0 || u >= s.width() || v >= s.height()) continue;
            if (!(s.confidence(u, v) > 0)) continue;
            const Rgb d = s.diffuse(u, v) - colour;
            const double alike = std::exp(-glm::dot(d, d) / 3 / (2 * scale * scale));
            if (alike < 1e-3) continue;
            const double alpha = s.roughness(u, v), rho = s.specular(u, v);
            const double alpha_error = errors.roughness(u, v) / alpha, rho_error = errors.specular(u, v);
            ln_alpha.add(std::log(alpha),
                         alike / (alpha_error * alpha_error + kLnAlphaSpread * kLnAlphaSpread));
            specular.add(rho, alike / (rho_error * rho_error + kSpecularSpread * kSpecularSpread +
                                       kSpecularPart * kSpecularPart * rho * rho));
        }
    WardPrior prior;
    prior.ln_alpha = ln_alpha.mean();
    prior.ln_alpha_sigma = std::hypot(std::sqrt(ln_alpha.variance()), kLnAlphaSpread);
    prior.specular = specular.mean();
    prior.specular_sigma =
        std::hypot(std::sqrt(specular.variance()), kSpecularSpread, kSpecularPart * prior.specular);
    return prior;
}

}  // namespace tangi
