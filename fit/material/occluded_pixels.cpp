#include "fit/material/occluded_pixels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/parallel.h"

namespace tangi {

namespace {

// Of paint in the shade that passes for a black mirror (generated stacks of thick paint, lights low and few):
// rho_d next to 0, rho_s 0.1 to 1, alpha 0.06 to 0.25. Metal leaf is as bright as what is around it, or has
// wider lobes (real/leaf: alpha 0.46 and more where it is dark).
constexpr float kDarkPart = 0.3f;   // [1] rho_d over the mean around
constexpr float kCertain = 0.9f;    // [1] confidence
constexpr float kStrong = 0.15f;    // [1] rho_s
constexpr float kNarrow = 0.4f;     // [1] alpha
constexpr float kNoSlope = 0.04f;   // [1] confidence of a slope whose standard error is 0.5
constexpr float kDistrust = 1e-3f;  // [1] confidence
constexpr float kNoWitness = 10;    // [1] standard error
constexpr int kAround = 6, kAroundStep = 2, kBeside = 3;  // [pixels]
constexpr double kOwnSpecular = 0.1, kOwnLnAlpha = 0.7;   // [1] sigma of a lobe that is not its neighbours'
// [1] Cosine of 15 degrees, which lights of a ring of 24 are apart.
constexpr double kSameWay = 0.966;
constexpr double kDarkPhoto = 0.5;  // [1] of what is predicted
// [sigma^2] For each photograph: one in seven is hidden by relief that the height does not show.
constexpr double kUnexplained = 4;

float rgb_sum(const Rgb& c) { return c.r + c.g + c.b; }

// Calls body(u, v) for every `step`-th pixel up to `reach` from another, but not for that.
template <class Body>
void for_around(const Surface& s, int x, int y, int reach, int step, const Body& body) {
    for (int v = y - reach; v <= y + reach; v += step)
        for (int u = x - reach; u <= x + reach; u += step)
            if (u >= 0 && v >= 0 && u < s.width() && v < s.height() && (u != x || v != y)) body(u, v);
}

bool may_be_misread(const Surface& s, int x, int y) {
    const float confidence = s.confidence(x, y);
    if (!(confidence > 0)) return false;
    if (confidence < kNoSlope) return true;
    const bool mirror = s.specular(x, y) > kStrong && s.roughness(x, y) < kNarrow;
    if (confidence >= kCertain && !mirror) return false;
    float around = 0;
    int count = 0;
    for_around(s, x, y, kAround, kAroundStep, [&](int u, int v) {
        if (!(s.confidence(u, v) > 0)) return;
        around += rgb_sum(s.diffuse(u, v));
        ++count;
    });
    return rgb_sum(s.diffuse(x, y)) * static_cast<float>(count) < kDarkPart * around;
}

// Of two lights in about the same direction across: what hides the upper one hides the lower one, too.
bool is_below(const glm::dvec3& light, const glm::dvec3& other) {
    const double a = std::hypot(light.x, light.y), b = std::hypot(other.x, other.y);
    return light.x * other.x + light.y * other.y > kSameWay * a * b && light.z * b < other.z * a;
}

}  // namespace

Image<unsigned char> find_occluded_pixels(const Surface& surface) {
    Image<unsigned char> occluded(surface.width(), surface.height());
    parallel_for(0, surface.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < surface.width(); ++x) occluded(x, y) = may_be_misread(surface, x, y);
    });
    return occluded;
}

std::vector<float> distrust(const Image<unsigned char>& occluded, Surface& surface) {
    std::vector<float> before;
    for (std::size_t i = 0; i < occluded.size(); ++i) {
        if (!occluded.pixels()[i]) continue;
        float& confidence = surface.confidence.pixels()[i];
        before.push_back(confidence);
        confidence = std::min(confidence, kDistrust);
    }
    return before;
}

void trust_again(const Image<unsigned char>& occluded, const std::vector<float>& confidences,
                 Surface& surface) {
    auto before = confidences.begin();
    for (std::size_t i = 0; i < occluded.size(); ++i)
        if (occluded.pixels()[i]) surface.confidence.pixels()[i] = *before++;
}

void fill_from_neighbours(const Image<unsigned char>& occluded, Surface& s, FitErrors& errors) {
    // Only what is not a occluded pixel is looked at, and only occluded pixels are changed.
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) {
                if (!occluded(x, y)) continue;
                errors.specular(x, y) = errors.roughness(x, y) = kNoWitness;
                float weights = 0, specular = 0, roughness = 0;
                Rgb diffuse(0);
                for_around(s, x, y, kBeside, 1, [&](int u, int v) {
                    if (occluded(u, v) || !(s.confidence(u, v) > 0)) return;
                    const auto dx = static_cast<float>(u - x), dy = static_cast<float>(v - y);
                    const float weight = s.confidence(u, v) / (1 + dx * dx + dy * dy);
                    weights += weight;
                    specular += weight * s.specular(u, v);
                    roughness += weight * s.roughness(u, v);
                    diffuse += weight * s.diffuse(u, v);
                });
                if (!(weights > 0)) continue;
                s.specular(x, y) = specular / weights;
                if (!s.lobe_axes.empty())
                    s.lobe_axes(x, y).roughness_v *= roughness / weights / s.roughness(x, y);
                s.roughness(x, y) = roughness / weights;
                s.diffuse(x, y) = diffuse / weights;
            }
    });
}

WardPrior of_its_own(WardPrior prior) {
    prior.specular_sigma = std::max(prior.specular_sigma, kOwnSpecular);
    prior.ln_alpha_sigma = std::max(prior.ln_alpha_sigma, kOwnLnAlpha);
    return prior;
}

double hide_dark(const WardStart& start, PixelSamples& samples) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-start.slope.x, -start.slope.y, 1));
    const auto channels = static_cast<std::size_t>(samples.channels);
    const auto n_l = [&](std::size_t photo) {
        return std::max(glm::dot(normal, samples.light[photo]), 0.0) + samples.ambient[photo];
    };
    const auto predicted = [&](std::size_t photo, std::size_t c) {
        return samples.irradiance[photo * channels + c] * start.diffuse[static_cast<int>(c)] * n_l(photo);
    };
    std::vector<std::size_t> dark, lit;
    for (std::size_t photo = 0; photo < samples.light.size(); ++photo) {
        double value = 0, all = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            if (samples.sigma[photo * channels + c] == 0) continue;
            value += samples.value[photo * channels + c];
            all += predicted(photo, c);
        }
        if (all > 0) (value < kDarkPhoto * all ? dark : lit).push_back(photo);
    }
    double unexplained = 0;
    for (const std::size_t photo : dark) {
        const auto below = [&](std::size_t other) {
            return is_below(samples.light[other], samples.light[photo]);
        };
        if (std::ranges::any_of(lit, below)) continue;
        unexplained += kUnexplained * samples.visible[photo];
        for (std::size_t c = 0; c < channels; ++c)
            if (double& sigma = samples.sigma[photo * channels + c]; sigma != 0) {
                const double known = std::abs(sigma), hidden = std::hypot(sigma, predicted(photo, c));
                unexplained += samples.visible[photo] * 2 * std::log(hidden / known);
                sigma = std::copysign(hidden, sigma);
            }
    }
    return unexplained;
}

}  // namespace tangi
