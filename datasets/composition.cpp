#include "datasets/composition.h"

#include <algorithm>
#include <array>
#include <glm/exponential.hpp>
#include <glm/vec2.hpp>
#include <utility>

namespace tangi::procedural {

namespace {

// Oil paints, thick and opaque: albedo (linear Rec. 709), F0, alpha. Earths dry matt, lakes and blacks rich
// in oil.
struct Pigment {
    Rgb albedo;
    float specular, roughness;
};
constexpr Pigment kWhite{{0.86f, 0.85f, 0.80f}, 0.045f, 0.30f}, kNaples{{0.80f, 0.62f, 0.28f}, 0.042f, 0.32f},
    kCadmiumYellow{{0.80f, 0.52f, 0.035f}, 0.045f, 0.28f}, kOchre{{0.50f, 0.27f, 0.06f}, 0.034f, 0.42f},
    kCadmiumRed{{0.55f, 0.045f, 0.025f}, 0.045f, 0.26f}, kSienna{{0.22f, 0.075f, 0.03f}, 0.034f, 0.40f},
    kUmber{{0.10f, 0.065f, 0.035f}, 0.030f, 0.45f}, kUltramarine{{0.03f, 0.04f, 0.28f}, 0.038f, 0.34f},
    kCobalt{{0.045f, 0.13f, 0.45f}, 0.040f, 0.32f}, kCerulean{{0.07f, 0.29f, 0.46f}, 0.040f, 0.34f},
    kViridian{{0.025f, 0.18f, 0.12f}, 0.042f, 0.24f}, kSap{{0.10f, 0.16f, 0.025f}, 0.042f, 0.26f},
    kBlack{{0.022f, 0.022f, 0.025f}, 0.040f, 0.24f};

// Paints darken each other when mixed: a geometric mean is nearer to that than an arithmetic one.
Pigment mixed(const Pigment& a, const Pigment& b, float t) {
    return {glm::pow(a.albedo, Rgb(1 - t)) * glm::pow(b.albedo, Rgb(t)), mix(a.specular, b.specular, t),
            mix(a.roughness, b.roughness, t)};
}

enum class Subject { sky, sun, hills, field, tree };

constexpr float kSunX = 0.25f, kSunY = 0.5f, kSunRadius = 0.2f;

Subject subject_at(float x, float y, Seed seed) {
    const float horizon = -0.05f + 0.08f * noise(1.5f * x, 0.5f, hash(seed, 1));
    const float ridge = horizon + 0.2f + 0.14f * noise(1.3f * x, 7.5f, hash(seed, 2));
    const float tree_x = -0.6f + 0.05f * noise(3 * y, 3.5f, hash(seed, 3));
    if (y > -0.45f && y < 0.62f && std::abs(x - tree_x) < 0.16f * std::sqrt((0.62f - y) / 1.07f))
        return Subject::tree;
    if (y < horizon) return Subject::field;
    if (y < ridge) return Subject::hills;
    return std::hypot(x - kSunX, y - kSunY) < kSunRadius ? Subject::sun : Subject::sky;
}

// Direction in which the brush follows the subject [rad].
float direction_at(Subject subject, float x, float y, Seed seed) {
    const float wander = noise(1.8f * x, 1.8f * y, hash(seed, 4));
    switch (subject) {
        case Subject::field:
            return 0.55f + 0.9f * wander;
        case Subject::hills:
            return 0.1f + 0.8f * wander;
        case Subject::tree:
            return 1.5f + 0.5f * wander;
        case Subject::sun:
        case Subject::sky:
            break;
    }
    // The sky turns around the sun and flows level far from it.
    const float dx = x - kSunX, dy = y - kSunY;
    const float near_sun = std::exp(-(dx * dx + dy * dy) / 0.18f);
    const float around = std::atan(dx / -(std::abs(dy) > 1e-3f ? dy : 1e-3f));
    return mix(0.9f * wander, around, near_sun);
}

Pigment paint_at(Subject subject, float x, float y, Seed seed, Seed stroke) {
    const float patch = 0.5f + 0.7f * noise(3 * x, 3 * y, hash(seed, 5));
    const float t = std::clamp(patch + uniform(stroke, -0.3f, 0.3f), 0.0f, 1.0f);
    const float chance = uniform(hash(stroke, 1));
    switch (subject) {
        case Subject::sun:
            return mixed(chance < 0.3f ? kWhite : kCadmiumYellow, kNaples, t);
        case Subject::hills:
            return chance < 0.25f ? mixed(kViridian, kWhite, 0.4f * t)
                                  : mixed(kUltramarine, mixed(kWhite, kCadmiumRed, 0.35f), 0.15f + 0.4f * t);
        case Subject::tree:
            return chance < 0.2f ? mixed(kSap, kNaples, 0.5f) : mixed(kViridian, kBlack, 0.8f * t);
        case Subject::field:
            if (chance < 0.06f) return kSienna;
            return chance < 0.55f ? mixed(kOchre, kCadmiumYellow, t) : mixed(kSap, kOchre, 0.8f * t);
        case Subject::sky:
            break;
    }
    const float near_sun = std::exp(-std::hypot(x - kSunX, y - kSunY) / 0.35f);
    if (uniform(hash(stroke, 2)) < near_sun) return mixed(kWhite, chance < 0.5f ? kNaples : kOchre, 0.6f * t);
    if (y + 0.35f * patch < 0.6f || chance < 0.25f) return mixed(kWhite, kCobalt, 0.35f * t);
    return mixed(chance < 0.6f ? kCobalt : kCerulean, chance < 0.4f ? kUltramarine : kWhite, 0.7f * t);
}

Pigment accent_at(Subject subject, Seed stroke) {
    const float chance = uniform(hash(stroke, 3));
    switch (subject) {
        case Subject::field:
            return chance < 0.4f ? kCadmiumRed : chance < 0.8f ? kNaples : kWhite;
        case Subject::hills:
            return chance < 0.5f ? mixed(kWhite, kCerulean, 0.4f) : kUmber;
        case Subject::tree:
            return chance < 0.5f ? mixed(kSap, kNaples, 0.6f) : kBlack;
        case Subject::sun:
            return kCadmiumYellow;
        case Subject::sky:
            break;
    }
    return chance < 0.7f ? kWhite : mixed(kWhite, kCerulean, 0.5f);
}

struct PaintLayer {
    float width;     // of the brush, in brushes of the options
    float coverage;  // strokes over each point, on average
    float thickness_mm;
    float ridge_mm;
    float load_low;
};
constexpr std::array<PaintLayer, 4> kLayers = {{{1.8f, 2.4f, 0.06f, 0.04f, 1.6f},
                                                {1.0f, 2.2f, 0.12f, 0.11f, 1.1f},
                                                {0.7f, 0.8f, 0.16f, 0.17f, 1.0f},
                                                {0.6f, 0.10f, 0.30f, 0.32f, 1.2f}}};

}  // namespace

Rgb colour_about(float x, float y, Seed seed) {
    Rgb sum(0);
    constexpr int count = 16;
    for (int i = 0; i < count; ++i)
        sum += paint_at(subject_at(x, y, seed), x, y, seed, hash(seed, static_cast<std::uint64_t>(100 + i)))
                   .albedo;
    return sum / static_cast<float>(count);
}

namespace {

// A layer of strokes: the last is of accents.
struct LayerPlan {
    const PaintLayer& layer;
    bool accents;
    Seed seed;
    float width_mm, length_mm;  // of a stroke, usually
    float step_mm;              // from one to the next
    float level_mm;             // that the layer lies on
};

LayerPlan plan_of(int k, const PaintingOptions& options, float level_mm) {
    const PaintLayer& layer = kLayers[static_cast<std::size_t>(k)];
    const float width = layer.width * static_cast<float>(options.brush_width_mm), length = 3.5f * width;
    return {layer,
            k == static_cast<int>(kLayers.size()) - 1,
            hash(options.seed, static_cast<std::uint64_t>(1000 + k)),
            width,
            length,
            std::sqrt(width * length / (layer.coverage * static_cast<float>(options.coverage))),
            level_mm};
}

// Half the sides of the picture.
glm::vec2 half_size_mm(const PaintingOptions& options) {
    return {static_cast<float>(options.width * options.mm_per_pixel / 2),
            static_cast<float>(options.height * options.mm_per_pixel / 2)};
}

// The stroke of place (i, j) of a layer; `h` is all that its accidents come from.
Stroke stroke_at(int i, int j, Seed h, const LayerPlan& plan, const PaintingOptions& options) {
    const auto random = [&](std::uint64_t index, float low, float high) {
        return uniform(hash(h, 10 + index), low, high);
    };
    const glm::vec2 half = half_size_mm(options);
    const float impasto = static_cast<float>(options.impasto);
    Stroke s;
    s.x_mm = (static_cast<float>(i) + random(0, -0.5f, 0.5f)) * plan.step_mm;
    s.y_mm = (static_cast<float>(j) + random(1, -0.5f, 0.5f)) * plan.step_mm;
    const float x = std::clamp(s.x_mm / half.x, -1.2f, 1.2f);
    const float y = std::clamp(s.y_mm / half.y, -1.2f, 1.2f);
    const Subject subject = subject_at(x, y, options.seed);
    const float angle = direction_at(subject, x, y, options.seed) + random(2, -0.3f, 0.3f) +
                        (random(3, 0, 1) < 0.5f ? std::numbers::pi_v<float> : 0.0f);
    s.cos = std::cos(angle);
    s.sin = std::sin(angle);
    s.length_mm = plan.length_mm * std::exp(random(4, -0.7f, 0.5f));
    s.half_width_mm = plan.width_mm / 2 * std::exp(random(5, -0.55f, 0.25f));
    s.curvature = random(6, -1.3f, 1.3f) / s.length_mm;
    s.thickness_mm = impasto * plan.layer.thickness_mm * random(7, 0.6f, 1.3f);
    s.ridge_mm = impasto * plan.layer.ridge_mm * random(8, 0.4f, 1.4f);
    s.load = plan.layer.load_low + random(9, 0, 1);
    s.level_mm = plan.level_mm;
    const Pigment paint = plan.accents ? accent_at(subject, h) : paint_at(subject, x, y, options.seed, h);
    const Pigment other = paint_at(subject, x, y, options.seed, hash(h, 5));
    s.first = paint.albedo * random(10, 0.88f, 1.05f);
    s.second = mixed(paint, other, 0.45f).albedo;
    s.specular = paint.specular;
    s.roughness = std::clamp(paint.roughness * random(11, 0.85f, 1.2f), 0.1f, 0.7f);
    s.seed = hash(h, 6);
    return s;
}

// In the order in which they are laid, which is by chance.
void add_layer(const LayerPlan& plan, const PaintingOptions& options, std::vector<Stroke>& strokes) {
    const glm::vec2 half = half_size_mm(options);
    std::vector<std::pair<Seed, Stroke>> shuffled;
    const int nx = static_cast<int>((half.x + plan.length_mm / 2) / plan.step_mm) + 1;
    const int ny = static_cast<int>((half.y + plan.length_mm / 2) / plan.step_mm) + 1;
    for (int j = -ny; j <= ny; ++j)
        for (int i = -nx; i <= nx; ++i) {
            const Seed h = hash(plan.seed, i, j);
            shuffled.emplace_back(hash(h, 7), stroke_at(i, j, h, plan, options));
        }
    std::sort(shuffled.begin(), shuffled.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [order, stroke] : shuffled) strokes.push_back(stroke);
}

}  // namespace

std::vector<Stroke> compose(const PaintingOptions& options, float ground_mm) {
    std::vector<Stroke> strokes;
    if (options.coverage <= 0) return strokes;
    float level = ground_mm;
    for (int k = 0; k < static_cast<int>(kLayers.size()); ++k) {
        const LayerPlan plan = plan_of(k, options, level);
        add_layer(plan, options, strokes);
        level += static_cast<float>(options.impasto) * plan.layer.thickness_mm *
                 std::min(plan.layer.coverage * static_cast<float>(options.coverage), 1.6f);
    }
    return strokes;
}

}  // namespace tangi::procedural
