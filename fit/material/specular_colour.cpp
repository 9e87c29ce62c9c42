#include "fit/material/specular_colour.h"

#include <algorithm>
#include <cmath>

#include "fit/material/lobe_neighbour_prior.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kReweightings = 5;
constexpr double kSpread = 0.05;     // [1] of rho_s,c, relative: what one Gaussian leaves open
constexpr double kWidest = 0.4;      // [1] alpha from which on a lobe may be diffuse light, and of its colour
constexpr double kWhiteSigma = 0.5;  // [1] of the prior, around white
// [1] Deviation from white below which a lobe is white: unequal lights and tone curves make as much.
constexpr float kClear = 0.1f;
constexpr float kLeastColour = 0.02f;  // [1] divide_by_specular_colour() divides by it
// [1] Part of the matt reflectance that may pass for a lobe: no paint is Lambert's, and where a file keeps
// little of chroma, highlights have the hue of what is below. Neighbours share it: it does not average out.
constexpr float kMattInLobe = 0.15f;
// [1] Part of the neighbours that counts: pixels next to each other share what sharpening, compression and
// mosaics made of colours.
constexpr float kIndependent = 0.25f;
constexpr float kAlike = 0.3f,
                kAlikeFloor = 0.04f;  // [1] relative difference of looks that are others, and noise

// Least squares for rho_d and rho_s of one channel.
struct Channel {
    double matt = 0, lobe = 0, cross = 0, value_matt = 0, value_lobe = 0;  // sums
    double diffuse = 0, specular = 0;

    void add(double weight, double d, double l, double value) {
        matt += weight * d * d;
        lobe += weight * l * l;
        cross += weight * d * l;
        value_matt += weight * d * value;
        value_lobe += weight * l * value;
    }
    double determinant() const { return matt * lobe - cross * cross; }
    bool solve() {
        if (!(determinant() > 1e-9 * matt * lobe)) return false;
        diffuse = (lobe * value_matt - cross * value_lobe) / determinant();
        specular = (matt * value_lobe - cross * value_matt) / determinant();
        if (diffuse < 0) {
            diffuse = 0;
            specular = value_lobe / lobe;
        }
        if (specular < 0) {
            specular = 0;
            diffuse = std::max(value_matt / matt, 0.0);
        }
        return true;
    }
    double variance() const { return matt / determinant(); }  // of rho_s
};

struct SolvedColour {
    double diffuse = 0, specular = 0, variance = 0;
    bool known = false;
};

// rho_s of channel c, and its variance.
SolvedColour solve_channel(const PixelSamples& s, const std::vector<WardTerms>& terms, int c,
                           double model_error, double robust_scale) {
    Channel result;
    double chi2 = 0;
    int used = 0;
    for (int iteration = 0; iteration < kReweightings; ++iteration) {
        Channel sums;
        chi2 = 0;
        used = 0;
        for (int i = 0; i < s.photos(); ++i) {
            const auto photo = static_cast<std::size_t>(i), at = static_cast<std::size_t>(i * s.channels + c);
            if (s.sigma[at] == 0) continue;
            const double d = s.irradiance[at] * (terms[photo].matt + s.ambient[photo]);
            const double l = s.irradiance[at] * terms[photo].lobe;
            const double predicted = result.diffuse * d + result.specular * l;
            if (iteration > 0 && s.sigma[at] < 0 && predicted >= s.value[at]) continue;
            const double validation = model_error * std::max(result.diffuse * d, s.value[at]);
            const double shadow = (1 - s.visible[photo]) * result.diffuse * d;
            const double variance = s.sigma[at] * s.sigma[at] + validation * validation + shadow * shadow;
            const double off = predicted - s.value[at], r2 = off * off / variance;
            const double robust = iteration > 0 ? 1 / (1 + r2 / (robust_scale * robust_scale)) : 1;
            sums.add(robust / variance, d, l, s.value[at]);
            chi2 += robust * r2;
            ++used;
        }
        if (!sums.solve()) return {};
        result = sums;
    }
    return {result.diffuse, result.specular, result.variance() * std::max(chi2 / std::max(used - 2, 1), 1.0),
            true};
}

// What a pixel looks like from all sides: matt and shiny light together.
Rgb look_of(const Surface& s, const Image<LobeEvidence>& evidence, int x, int y) {
    return s.diffuse(x, y) + s.specular(x, y) * evidence(x, y).colour;
}

}  // namespace

LobeEvidence lobe_evidence(const PixelSamples& s, const WardEstimate& e, const WardFitOptions& options) {
    if (s.channels != 3 || e.roughness > kWidest) return {};
    const double theta[kWardCommon] = {e.slope.x, e.slope.y, std::log(e.roughness), e.specular};
    std::vector<WardTerms> terms;
    for (const glm::dvec3& light : s.light)
        terms.push_back(ward_terms(theta, light, s.view, options.reflectance_model, e.stretch));
    glm::dvec3 diffuse(0), specular(0);
    double variance = 0;
    for (int c = 0; c < 3; ++c) {
        const SolvedColour solved = solve_channel(s, terms, c, options.model_error, options.robust_scale);
        if (!solved.known) return {};
        diffuse[c] = solved.diffuse;
        specular[c] = solved.specular;
        variance += solved.variance / 3;
    }
    const double mean = (specular.r + specular.g + specular.b) / 3;
    if (!(mean > 0)) return {};
    const glm::dvec3 hue = diffuse - (diffuse.r + diffuse.g + diffuse.b) / 3;
    return {Rgb(specular / mean), static_cast<float>(1 / (variance / (mean * mean) + kSpread * kSpread)),
            static_cast<float>(glm::length(hue) / mean)};
}

Rgb specular_colour_of(const LobeEvidence& evidence) {
    constexpr auto prior = static_cast<float>(1 / (kWhiteSigma * kWhiteSigma));
    const Rgb colour = (evidence.weight * evidence.colour + prior) / (evidence.weight + prior);
    // The positive part of James and Stein's estimator: what is small is nothing, what is large is kept. What
    // the matt part explains is nothing either, but takes little of a colour that is far beyond it.
    const Rgb off = colour - Rgb(1);
    const float off2 = std::max(glm::dot(off, off), 1e-12f);
    const float by_chance = (square(kClear) + 3 / (evidence.weight + prior)) / off2;
    const float by_matt = square(kMattInLobe * evidence.matt_hue) / off2;
    const float kept = std::max(1 - by_chance, 0.0f) * std::max(1 - square(by_matt), 0.0f);
    if (!(kept > 0)) return Rgb(1);
    const Rgb shrunk = glm::max(Rgb(1) + kept * off, Rgb(0));
    return glm::max(shrunk / std::max({shrunk.r, shrunk.g, shrunk.b}), Rgb(kLeastColour));
}

Image<Rgb> specular_colours(const Surface& s, const Image<LobeEvidence>& evidence) {
    Image<Rgb> colours(s.width(), s.height(), Rgb(1));
    parallel_for(0, s.height(), 4, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) {
                if (!(s.confidence(x, y) > 0)) continue;
                const Rgb look = look_of(s, evidence, x, y);
                const float scale2 = square(kAlike * (look.r + look.g + look.b) / 3 + kAlikeFloor);
                Rgb sum(0);
                float weight = 0, hue = 0;
                for (int v = std::max(y - kLobeReach, 0); v <= std::min(y + kLobeReach, s.height() - 1); ++v)
                    for (int u = std::max(x - kLobeReach, 0); u <= std::min(x + kLobeReach, s.width() - 1);
                         ++u) {
                        const LobeEvidence& e = evidence(u, v);
                        if (!(e.weight > 0)) continue;
                        const Rgb off = look_of(s, evidence, u, v) - look;
                        // What noise makes of looks is no difference of them.
                        const float noise2 =
                            square(s.specular(x, y)) / std::max(evidence(x, y).weight, 0.1f) +
                            square(s.specular(u, v)) / e.weight;
                        const float inverse2 = 1 / (3 * (scale2 + 4 * noise2));
                        const float w = e.weight * square(std::max(1 - glm::dot(off, off) * inverse2, 0.0f));
                        sum += w * e.colour;
                        hue += w * e.matt_hue;
                        weight += w;
                    }
                if (weight > 0)
                    colours(x, y) = specular_colour_of({sum / weight, kIndependent * weight, hue / weight});
            }
    });
    return colours;
}

void divide_by_specular_colour(const Rgb& colour, PixelSamples& s) {
    if (colour == Rgb(1)) return;
    const Rgb crosstalk = crosstalk_of(colour);
    for (std::size_t first = 0; first + 2 < s.value.size(); first += 3) {
        const double most = std::max({s.value[first], s.value[first + 1], s.value[first + 2]});
        for (int c = 0; c < 3; ++c) {
            const std::size_t at = first + static_cast<std::size_t>(c);
            s.irradiance[at] *= colour[c];
            if (s.sigma[at] != 0)
                s.sigma[at] = std::copysign(std::hypot(s.sigma[at], crosstalk[c] * most), s.sigma[at]);
        }
    }
}

WardEstimate coloured(WardEstimate e, const Rgb& colour) {
    const glm::dvec3 c(colour);
    e.diffuse *= c;
    e.diffuse_error *= glm::length(c) / std::sqrt(3.0);
    e.specular_colour = c;
    return e;
}

}  // namespace tangi
