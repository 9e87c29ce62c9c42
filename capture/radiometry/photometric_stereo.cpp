#include "capture/radiometry/photometric_stereo.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace tangi {

namespace {

// Smallest z of a normal: about 84 degrees. Steeper ones are not seen from straight ahead.
constexpr double kSmallestZ = 0.1;

struct GreySample {
    glm::dvec3 light;  // scaled by the irradiance
    double ambient;    // likewise
    double value;
};

// Matt reflection of g = rho_d n is g.l + ambient |g|; with the normal of the step before, |g| = g.n, and the
// ambient light is one more light that comes from where the surface faces.
glm::dvec3 effective_light(const GreySample& sample, const glm::dvec3& normal) {
    return sample.light + sample.ambient * normal;
}

std::optional<glm::dvec3> solve(const std::vector<GreySample>& samples, const std::vector<double>& weights,
                                const glm::dvec3& normal) {
    glm::dmat3 a(0);
    glm::dvec3 b(0);
    double trace = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const glm::dvec3 light = effective_light(samples[i], normal);
        a += weights[i] * glm::outerProduct(light, light);
        b += weights[i] * samples[i].value * light;
    }
    trace = a[0][0] + a[1][1] + a[2][2];
    if (!(trace > 0) || !(glm::determinant(a) > 1e-9 * trace * trace * trace)) return std::nullopt;
    return glm::inverse(a) * b;
}

glm::dvec3 facing_viewer(glm::dvec3 n) {
    n = glm::normalize(n);
    if (n.z >= kSmallestZ) return n;
    const double across = std::hypot(n.x, n.y);
    if (across < 1e-12) return {0, 0, 1};
    const double scale = std::sqrt(1 - kSmallestZ * kSmallestZ) / across;
    return {n.x * scale, n.y * scale, kSmallestZ};
}

bool is_usable(const PixelSamples& s, int photo) {
    for (int c = 0; c < s.channels; ++c)
        if (!(s.sigma[static_cast<std::size_t>(photo * s.channels + c)] > 0)) return false;
    return true;
}

// Of the photographs that are usable, in their order.
std::vector<GreySample> grey_samples(const PixelSamples& s) {
    std::vector<GreySample> samples;
    for (int i = 0; i < s.photos(); ++i) {
        double value = 0, irradiance = 0;
        for (int c = 0; c < s.channels; ++c) {
            const auto at = static_cast<std::size_t>(i * s.channels + c);
            value += s.value[at];
            irradiance += s.irradiance[at];
        }
        const auto photo = static_cast<std::size_t>(i);
        irradiance /= s.channels;
        if (is_usable(s, i))
            samples.push_back(
                {s.light[photo] * irradiance, s.ambient[photo] * irradiance, value / s.channels});
    }
    return samples;
}

// Where to start: samples whose brightness, as if the surface faced the viewer, is neither that of a
// highlight nor of a shadow, weigh most.
struct StereoStart {
    std::vector<double> weights;
    double typical = 0;  // brightness
};
StereoStart stereo_start(const std::vector<GreySample>& samples, const PhotometricStereoOptions& options) {
    std::vector<double> brightness;
    for (const GreySample& sample : samples)
        brightness.push_back(sample.value / std::max(sample.light.z + sample.ambient, 1e-3));
    std::vector<double> sorted = brightness;
    std::sort(sorted.begin(), sorted.end());
    const auto brighter = static_cast<std::size_t>(options.highlights * static_cast<double>(sorted.size()));
    const double high = sorted[sorted.size() - 1 - brighter],
                 low = std::max(sorted[sorted.size() / 5], options.shadow * high);
    StereoStart start{std::vector<double>(samples.size())};
    // The median of what is lit: where most photographs are dark, theirs tells nothing.
    const auto lit = std::lower_bound(sorted.begin(), sorted.end(), low),
               last = std::upper_bound(lit, sorted.end(), high);
    if (lit != last) start.typical = *(lit + (last - lit) / 2);
    for (std::size_t i = 0; i < samples.size(); ++i)
        start.weights[i] = brightness[i] >= low && brightness[i] <= high ? 1.0 : 0.01;
    return start;
}

// By how far samples are from what g predicts.
void reweigh(const std::vector<GreySample>& samples, const glm::dvec3& g, double scale,
             std::vector<double>& weights) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double direct = glm::dot(g, samples[i].light);
        const double predicted = std::max(direct, 0.0) + samples[i].ambient * glm::length(g);
        const double r = (samples[i].value - predicted) / (scale * glm::length(samples[i].light));
        const double w = 1 / (1 + r * r);
        weights[i] = direct > 0 ? w * w : 1e-4;  // attached shadow: says next to nothing about g
    }
}

// The albedo of a channel that explains the samples, as they were weighed, given the normal.
double albedo_of(const PixelSamples& s, int c, const glm::dvec3& normal, const std::vector<double>& weights) {
    double numerator = 0, denominator = 0;
    std::size_t used = 0;
    for (int i = 0; i < s.photos(); ++i) {
        if (!is_usable(s, i)) continue;
        const double w = weights[used++];
        const auto at = static_cast<std::size_t>(i * s.channels + c);
        const auto photo = static_cast<std::size_t>(i);
        const double direct = glm::dot(normal, s.light[photo]);
        if (direct <= 0) continue;
        const double cosine = direct + s.ambient[photo];
        numerator += w * s.value[at] * cosine * s.irradiance[at];
        denominator += w * cosine * cosine * s.irradiance[at] * s.irradiance[at];
    }
    return denominator > 0 ? std::max(numerator / denominator, 0.0) : 0;
}

}  // namespace

LambertEstimate photometric_stereo(const PixelSamples& s, const PhotometricStereoOptions& options) {
    LambertEstimate result;
    const std::vector<GreySample> samples = grey_samples(s);
    if (samples.size() < 3) return result;
    auto [weights, typical] = stereo_start(samples, options);
    if (!(typical > 1e-5)) return result;

    glm::dvec3 normal(0, 0, 1);
    auto g = solve(samples, weights, normal);
    if (!g) return result;
    double scale = 4 * options.outlier_scale * typical;  // tightened step by step (graduated non-convexity)
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
        scale = std::max(scale * 0.7, options.outlier_scale * typical);
        reweigh(samples, *g, scale, weights);
        const double length = glm::length(*g);
        if (length > 0) normal = *g / length;
        const auto next = solve(samples, weights, normal);
        if (!next) break;
        g = next;
    }
    if (!(glm::length(*g) > 1e-6)) return result;
    result.normal = facing_viewer(*g);
    for (int c = 0; c < s.channels; ++c) result.diffuse[c] = albedo_of(s, c, result.normal, weights);
    for (int c = s.channels; c < 3; ++c) result.diffuse[c] = result.diffuse[0];
    result.valid = true;
    return result;
}

}  // namespace tangi
