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

}  // namespace

LambertEstimate photometric_stereo(const PixelSamples& s, const PhotometricStereoOptions& options) {
    LambertEstimate result;
    std::vector<GreySample> samples;
    for (int i = 0; i < s.photos(); ++i) {
        double value = 0, irradiance = 0;
        bool usable = true;
        for (int c = 0; c < s.channels; ++c) {
            const auto at = static_cast<std::size_t>(i * s.channels + c);
            value += s.value[at];
            irradiance += s.irradiance[at];
            usable = usable && s.sigma[at] > 0;
        }
        const auto photo = static_cast<std::size_t>(i);
        irradiance /= s.channels;
        if (usable)
            samples.push_back(
                {s.light[photo] * irradiance, s.ambient[photo] * irradiance, value / s.channels});
    }
    if (samples.size() < 3) return result;

    // Start: samples whose brightness, as if the surface faced the viewer, is neither that of a highlight nor
    // of a shadow.
    std::vector<double> brightness;
    for (const GreySample& sample : samples)
        brightness.push_back(sample.value / std::max(sample.light.z + sample.ambient, 1e-3));
    std::vector<double> sorted = brightness;
    std::sort(sorted.begin(), sorted.end());
    const double high = sorted[sorted.size() - 1 - sorted.size() / 5],
                 low = std::max(sorted[sorted.size() / 5], options.shadow * high);
    const double typical = sorted[sorted.size() / 2];
    if (!(typical > 1e-5)) return result;
    std::vector<double> weights(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
        weights[i] = brightness[i] >= low && brightness[i] <= high ? 1.0 : 0.01;

    glm::dvec3 normal(0, 0, 1);
    auto g = solve(samples, weights, normal);
    if (!g) return result;
    double scale = 4 * options.outlier_scale * typical;  // tightened step by step (graduated non-convexity)
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
        scale = std::max(scale * 0.7, options.outlier_scale * typical);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double direct = glm::dot(*g, samples[i].light);
            const double predicted = std::max(direct, 0.0) + samples[i].ambient * glm::length(*g);
            const double r = (samples[i].value - predicted) / (scale * glm::length(samples[i].light));
            const double w = 1 / (1 + r * r);
            weights[i] = direct > 0 ? w * w : 1e-4;  // attached shadow: says next to nothing about g
        }
        const double length = glm::length(*g);
        if (length > 0) normal = *g / length;
        const auto next = solve(samples, weights, normal);
        if (!next) break;
        g = next;
    }
    const double length = glm::length(*g);
    if (!(length > 1e-6)) return result;
    result.normal = facing_viewer(*g);

    // Per channel: the albedo that explains the same samples, given the normal.
    for (int c = 0; c < s.channels; ++c) {
        double numerator = 0, denominator = 0;
        std::size_t used = 0;
        for (int i = 0; i < s.photos(); ++i) {
            bool usable = true;
            for (int k = 0; k < s.channels; ++k)
                usable = usable && s.sigma[static_cast<std::size_t>(i * s.channels + k)] > 0;
            if (!usable) continue;
            const double w = weights[used++];
            const auto at = static_cast<std::size_t>(i * s.channels + c);
            const auto photo = static_cast<std::size_t>(i);
            const double direct = glm::dot(result.normal, s.light[photo]);
            if (direct <= 0) continue;
            const double cosine = direct + s.ambient[photo];
            numerator += w * s.value[at] * cosine * s.irradiance[at];
            denominator += w * cosine * cosine * s.irradiance[at] * s.irradiance[at];
        }
        result.diffuse[c] = denominator > 0 ? std::max(numerator / denominator, 0.0) : 0;
    }
    for (int c = s.channels; c < 3; ++c) result.diffuse[c] = result.diffuse[0];
    result.valid = true;
    return result;
}

}  // namespace tangi
