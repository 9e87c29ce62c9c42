#include "paint/brush/brush_tip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/base/noise.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr float kMostShorter = 1.5f;  // [1] of bristles, before brushes of few tufts get the mean of many

using procedural::hash;
using procedural::uniform;

constexpr std::size_t kDirections = 96;  // of reach_px()
constexpr float kInner = 0.5f;           // [1] of the dome: the other level that it knows
constexpr float kPerDirection = 2 * std::numbers::pi_v<float> / kDirections;
constexpr float kLying = 4;  // [1] length of a dragged bristle's mark over its width

// The bristles around a point: each cell of a grid holds one, off its middle by up to half a cell.
struct Bristle {
    float shorter;     // [1] 0 = the longest
    float distance;    // [cells] to the nearest
    std::uint64_t id;  // of the nearest
};

Bristle bristle_at(float u, float v, std::uint64_t seed) {
    const int cu = static_cast<int>(std::floor(u)), cv = static_cast<int>(std::floor(v));
    float envelope = 10, best = 10;
    std::uint64_t nearest = 0;
    for (int j = cv - 1; j <= cv + 1; ++j)
        for (int i = cu - 1; i <= cu + 1; ++i) {
            const std::uint64_t h = hash(seed, i, j);
            const float du = static_cast<float>(i) + uniform(hash(h, 1)) - u;
            const float dv = static_cast<float>(j) + uniform(hash(h, 2)) - v;
            const float distance2 = du * du + dv * dv;
            // Most bristles are a little shorter than the longest, some much.
            const float length = uniform(hash(h, 3));
            const float shorter = 0.75f * length * std::sqrt(length);
            envelope = std::min(envelope, shorter + 0.6f * distance2);
            if (distance2 < best) best = distance2, nearest = h;
        }
    return {envelope, std::sqrt(best), nearest};
}

// [1] Of the load in the middle. It falls to nothing at the rim, over more than a pixel: a sharp end would be
// printed wherever the brush's cells go over to other pixels.
float load_of(float dome) { return std::max(1 - dome * dome, 0.0f); }

// The greatest slope between neighbours, and a little for rounding.
float steepest_of(const std::vector<float>& map, int width) {
    float along = 0, across = 0;
    for (std::size_t i = 1; i < map.size(); ++i)
        if (i % static_cast<std::size_t>(width) != 0) along = std::max(along, std::abs(map[i] - map[i - 1]));
    for (auto i = static_cast<std::size_t>(width); i < map.size(); ++i)
        across = std::max(across, std::abs(map[i] - map[i - static_cast<std::size_t>(width)]));
    return 1.01f * portable::hypot(along, across) + 1e-3f;
}

}  // namespace

struct BrushTip::Hair {
    Bristle fine, tuft;
};

// [1] By how much less paint bristles got than others may have.
float BrushTip::luck_of(const Hair& bristles) {
    return 0.25f * uniform(hash(bristles.fine.id, 9)) + 0.75f * uniform(hash(bristles.tuft.id, 9));
}

BrushTip::Hair BrushTip::hair(float u, float v) const {
    // Bristles thinner than two pixels cannot be told apart.
    const auto cell = static_cast<float>(std::max(settings_.bristle_mm / mm_per_pixel_, 2.0));
    // A brush that turns with the stroke drags its bristles along its thickness, where they lie.
    const float x = u / cell, y = v / (settings_.follow ? kLying * cell : cell);
    return {bristle_at(x, y, hash(seed_, 1)), bristle_at(x / 4, y / 4, hash(seed_, 2))};
}

float BrushTip::dome_at(float u, float v) const {
    return traits_of(settings_.shape).dome(u / half_width_px_, v / half_thickness_px_, seed_);
}

// Of the pixel around a texel: the part that the tip covers, how full it is of what the middle holds, and
// the mean dome.
BrushTip::Filled BrushTip::filled(int u, int v) const {
    constexpr int samples = 6;
    Filled sum;
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const float dome =
                dome_at(static_cast<float>(u) + (static_cast<float>(i) + 0.5f) / samples - 0.5f,
                        static_cast<float>(v) + (static_cast<float>(j) + 0.5f) / samples - 0.5f);
            sum.cover += dome < 1;
            sum.load += load_of(dome);
            sum.dome += std::min(dome, 1.0f);
        }
    constexpr float all = samples * samples;
    return {sum.cover / all, sum.load / all, sum.dome / all};
}

BrushTip::BrushTip(const BrushSettings& settings, double mm_per_pixel, double half_width_px,
                   double half_thickness_px, std::uint64_t seed)
    : settings_(settings),
      mm_per_pixel_(mm_per_pixel),
      half_width_px_(static_cast<float>(half_width_px)),
      half_thickness_px_(static_cast<float>(half_thickness_px)),
      seed_(seed) {
    half_u_ = static_cast<int>(std::ceil(half_width_px)) + 2;
    half_v_ = static_cast<int>(std::ceil(half_thickness_px)) + 2;
    const int width = 2 * half_u_ + 1, height = 2 * half_v_ + 1;
    const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<char> inside(texels);  // the texel's middle
    std::vector<float> domes(texels, 1.0f), shorter(texels), cover(texels);
    load_.assign(texels, 0.0f);
    for (int v = -half_v_; v <= half_v_; ++v)
        for (int u = -half_u_; u <= half_u_; ++u)
            inside[static_cast<std::size_t>((v + half_v_) * width + u + half_u_)] =
                dome_at(static_cast<float>(u), static_cast<float>(v)) < 1;
    double area = 0, length = 0, load = 0, lucky = 0;
    for (int v = 1 - half_v_; v < half_v_; ++v)
        for (int u = 1 - half_u_; u < half_u_; ++u) {
            const auto i = static_cast<std::size_t>((v + half_v_) * width + u + half_u_);
            bool same = true;
            for (const int k : {-1, 1, -width - 1, -width, 1 - width, width - 1, width, width + 1})
                same = same && inside[i] == inside[i + static_cast<std::size_t>(k)];
            if (same && !inside[i]) continue;
            const auto fu = static_cast<float>(u), fv = static_cast<float>(v);
            const float dome = dome_at(fu, fv);
            const Filled part = same ? Filled{1, load_of(dome), dome} : filled(u, v);
            const Hair bristles = hair(fu, fv);
            shorter[i] = std::min(0.55f * bristles.fine.shorter + 0.7f * bristles.tuft.shorter, kMostShorter);
            if (!(part.cover > 0)) continue;
            domes[i] = part.dome;
            cover[i] = part.cover;
            load_[i] = part.load;
            area += part.cover;
            length += part.cover * shorter[i];
            load += part.load;
            lucky += part.load * luck_of(bristles);
        }
    // A brush of few tufts has a hand's pressure and a palette's paint all the same.
    if (length > 0) longest_ = static_cast<float>(kMeanShorter * area / length) * kMostShorter;
    for (float& s : shorter) s /= kMostShorter;
    texels_ = texel_pairs(domes, shorter, cover, width);
    steepest_ = steepest_of(domes, width);
    find_reach();
    const double variation = settings.load_variation;
    if (load > 0) fullness_ = static_cast<float>((1 - variation / 2) * load / (load - variation * lucky));
}

void BrushTip::find_reach() {
    for (std::size_t level = 0; level < 2; ++level) {
        std::vector<float>& reach = reach_px_[level];
        reach.assign(kDirections, 0.0f);
        for (int v = -half_v_; v <= half_v_; ++v) {
            const auto fv = static_cast<float>(v);
            int first = half_u_, last = -half_u_;
            for (int u = -half_u_; u <= half_u_; ++u)
                if (dome_at(static_cast<float>(u), fv) <= (level == 0 ? 1.0f : kInner))
                    first = std::min(first, u), last = u;
            for (const int u : {first, last}) {
                if (first > last) continue;
                for (std::size_t i = 0; i < kDirections; ++i) {
                    const float angle = static_cast<float>(i) * kPerDirection;
                    reach[i] = std::max(reach[i], portable::cos(angle) * static_cast<float>(u) +
                                                      portable::sin(angle) * fv + 0.5f);
                }
            }
        }
    }
}

// Between the two levels as a power of the dome, which tips are.
float BrushTip::reach_px(float u, float v, float dome) const {
    const float at = portable::atan2(v, u) / kPerDirection + static_cast<float>(kDirections);
    const auto before = static_cast<std::size_t>(at);
    const auto towards = [&](const std::vector<float>& reach) {
        const float a = reach[before % kDirections], b = reach[(before + 1) % kDirections];
        return std::max(a + (b - a) * (at - static_cast<float>(before)), 0.5f);
    };
    const float rim = towards(reach_px_[0]);
    return rim * portable::pow(towards(reach_px_[1]) / rim,
                               portable::log(std::max(dome, 1e-3f)) / portable::log(kInner));
}

float BrushTip::fresh_load_mm(float u, float v, float middle_mm) const {
    const int x = static_cast<int>(std::lround(u)) + half_u_, y = static_cast<int>(std::lround(v)) + half_v_;
    const int width = 2 * half_u_ + 1, height = 2 * half_v_ + 1;
    if (x < 0 || y < 0 || x >= width || y >= height) return 0;
    const float load = load_[static_cast<std::size_t>(y * width + x)];
    if (!(load > 0)) return 0;
    return middle_mm * load * fullness_ *
           (1 - static_cast<float>(settings_.load_variation) * luck_of(hair(u, v)));
}

}  // namespace tangi
