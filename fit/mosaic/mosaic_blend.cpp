#include "fit/mosaic/mosaic_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "surface/base/parallel.h"

namespace tangi {

namespace {

using glm::dvec2;

constexpr float kLeastWeight = 1e-4f;  // [1] of a position where its share is 0: others may not be measured
constexpr int kTaps = 3;               // [pixels] that Lanczos 3 needs around a place

// All numbers of a pixel that are interpolated.
struct Sample {
    static constexpr std::size_t kCount = 17;
    std::array<float, kCount> v{};
    glm::vec2 slope() const { return {v[0], v[1]}; }
    Rgb diffuse() const { return {v[2], v[3], v[4]}; }
    float specular() const { return v[5]; }
    float ln_alpha() const { return v[6]; }
    float confidence() const { return v[7]; }
    Rgb colour() const { return {v[8], v[9], v[10]}; }
    Stretch stretch() const { return {v[11], v[12]}; }
    // Variances.
    float slope2() const { return v[13]; }
    float diffuse2() const { return v[14]; }
    float specular2() const { return v[15]; }
    float roughness2() const { return v[16]; }

    void add(float weight, const Sample& other) {
        for (std::size_t i = 0; i < kCount; ++i) v[i] += weight * other.v[i];
    }
};

float squared(float value) { return value * value; }

Sample sample_of(const MosaicPart& part, int x, int y) {
    const Surface& s = part.surface;
    Sample p;
    const Slope slope = slope_of(s.normal(x, y));
    const Rgb &diffuse = s.diffuse(x, y),
              colour = s.specular_colour.empty() ? Rgb(1) : s.specular_colour(x, y);
    const Stretch stretch =
        s.lobe_axes.empty() ? Stretch(0) : stretch_of(s.lobe_axes(x, y), s.roughness(x, y));
    p.v = {slope.x,
           slope.y,
           diffuse.r,
           diffuse.g,
           diffuse.b,
           s.specular(x, y),
           std::log(s.roughness(x, y)),
           s.confidence(x, y),
           colour.r,
           colour.g,
           colour.b,
           stretch.x,
           stretch.y};
    if (part.errors.slope.empty()) return p;
    const FitErrors& e = part.errors;
    p.v[13] = squared(e.slope(x, y)), p.v[14] = squared(e.diffuse(x, y));
    p.v[15] = squared(e.specular(x, y)), p.v[16] = squared(e.roughness(x, y));
    return p;
}

// Weights of the six pixels around a place `t` behind the third of them (Lanczos 3: Duchon 1979), whose sum
// is 1.
std::array<float, 2 * kTaps> lanczos(double t) {
    std::array<float, 2 * kTaps> weights{};
    if (t < 1e-6) {
        weights[kTaps - 1] = 1;
        return weights;
    }
    double sum = 0;
    std::array<double, 2 * kTaps> raw{};
    for (std::size_t i = 0; i < raw.size(); ++i) {
        const double x = std::numbers::pi * (t + kTaps - 1 - static_cast<double>(i));
        raw[i] = kTaps * std::sin(x) * std::sin(x / kTaps) / (x * x);
        sum += raw[i];
    }
    for (std::size_t i = 0; i < raw.size(); ++i) weights[i] = static_cast<float>(raw[i] / sum);
    return weights;
}

// Bilinear among the pixels that were measured; false where there is none.
bool sample_between(const MosaicPart& part, const glm::ivec2& whole, const dvec2& rest, Sample& result) {
    float sum = 0;
    result = {};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const int x = whole.x + i, y = whole.y + j;
            if (x < 0 || y < 0 || x >= part.surface.width() || y >= part.surface.height() ||
                !(part.surface.confidence(x, y) > 0))
                continue;
            const auto weight = static_cast<float>((i ? rest.x : 1 - rest.x) * (j ? rest.y : 1 - rest.y));
            if (!(weight > 0)) continue;
            result.add(weight, sample_of(part, x, y));
            sum += weight;
        }
    if (!(sum > 0.5f)) return false;
    for (float& value : result.v) value /= sum;
    return true;
}

// At a place in pixels of the part.
bool sample_at(const MosaicPart& part, const dvec2& place, Sample& result) {
    const dvec2 floor = glm::floor(place + 1e-9), rest = glm::max(place - floor, dvec2(0));
    const glm::ivec2 whole(floor);
    constexpr int kSide = 2 * kTaps;
    const int x0 = whole.x - kTaps + 1, y0 = whole.y - kTaps + 1;
    const Surface& s = part.surface;
    if (x0 < 0 || y0 < 0 || x0 + kSide > s.width() || y0 + kSide > s.height())
        return sample_between(part, whole, rest, result);
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i)
            if (!(s.confidence(x0 + i, y0 + j) > 0)) return sample_between(part, whole, rest, result);
    const auto across = lanczos(rest.x), down = lanczos(rest.y);
    result = {};
    for (std::size_t j = 0; j < down.size(); ++j)
        for (std::size_t i = 0; i < across.size(); ++i)
            if (const float weight = across[i] * down[j]; weight != 0)
                result.add(weight, sample_of(part, x0 + static_cast<int>(i), y0 + static_cast<int>(j)));
    return true;
}

// Bilinear in the cells of a share; the border goes on.
template <class T, class Add>
void at_cell(const Image<T>& map, const Region& cells, const dvec2& cell, const Add& add) {
    const dvec2 p = cell - dvec2(cells.x0, cells.y0), floor = glm::floor(p), rest = p - floor;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i)
            add(static_cast<float>((i ? rest.x : 1 - rest.x) * (j ? rest.y : 1 - rest.y)),
                map.clamped(static_cast<int>(floor.x) + i, static_cast<int>(floor.y) + j));
}

float weight_at(const PositionShare& share, const dvec2& cell) {
    float weight = kLeastWeight;
    at_cell(share.weight, share.cells, cell, [&](float part, float value) { weight += part * value; });
    return weight;
}

LowBand low_at(const PositionShare& share, const dvec2& cell) {
    LowBand low;
    at_cell(share.low, share.cells, cell, [&](float part, const LowBand& value) {
        low.slope += part * value.slope, low.ln_diffuse += part * value.ln_diffuse;
        low.ln_specular += part * value.ln_specular, low.ln_alpha += part * value.ln_alpha;
    });
    return low;
}

// Brings a position's numbers to the wall's scale and frame.
void level(const PositionScale& scale, const PlacedPosition& placed, const LowBand& low, Sample& p) {
    const glm::dvec2 slope = slope_on_wall(scale, p.slope());
    p.v[0] = static_cast<float>(slope.x) + low.slope.x, p.v[1] = static_cast<float>(slope.y) + low.slope.y;
    const Rgb factor = scale.diffuse * glm::exp(low.ln_diffuse);
    for (int c = 0; c < 3; ++c)
        p.v[static_cast<std::size_t>(2 + c)] = std::max(p.diffuse()[c] * factor[c], 0.0f);
    const float specular = scale.specular * std::exp(low.ln_specular);
    p.v[5] = std::max(p.specular() * specular, 0.0f);
    p.v[6] += std::log(scale.roughness) + low.ln_alpha;
    const auto c2 = static_cast<float>(std::cos(2 * placed.turn_rad)),
               s2 = static_cast<float>(std::sin(2 * placed.turn_rad));
    const Stretch stretch = p.stretch();
    p.v[11] = c2 * stretch.x - s2 * stretch.y, p.v[12] = s2 * stretch.x + c2 * stretch.y;
    p.v[14] *= squared((factor.r + factor.g + factor.b) / 3);
    p.v[15] *= squared(specular), p.v[16] *= squared(scale.roughness);
}

// A position that shows some of a rectangle.
struct Shown {
    std::size_t index = 0;
    Homography from_wall{1};
    MosaicPart part;
    dvec2 corner{0};  // [pixels of the position] of the part
};

std::vector<Shown> shown_in(const MosaicBlend& blend, const Region& part) {
    std::vector<Shown> all;
    for (std::size_t i = 0; i < blend.positions.size(); ++i) {
        if (!blend.layout.positions[i].joined) continue;
        Shown shown{i, glm::inverse(blend.layout.positions[i].to_wall), {}, {}};
        dvec2 low(1e30), high(-1e30);
        for (const dvec2& corner : {dvec2(part.x0, part.y0), dvec2(part.x1, part.y0), dvec2(part.x1, part.y1),
                                    dvec2(part.x0, part.y1)}) {
            const dvec2 p = mapped(shown.from_wall, corner);
            low = glm::min(low, p), high = glm::max(high, p);
        }
        const auto within = [](double value, int most) {
            return static_cast<int>(std::clamp(value, 0.0, double(most)));
        };
        const MosaicPosition& position = blend.positions[i];
        const Region needed{within(std::floor(low.x) - kTaps, position.width),
                            within(std::floor(low.y) - kTaps, position.height),
                            within(std::ceil(high.x) + kTaps + 1, position.width),
                            within(std::ceil(high.y) + kTaps + 1, position.height)};
        if (needed.empty()) continue;
        shown.part = position.read(needed), shown.corner = dvec2(needed.x0, needed.y0);
        all.push_back(std::move(shown));
    }
    return all;
}

// What all positions that show it say of a pixel of the wall; variances of independent errors.
bool blend_pixel(const MosaicBlend& blend, const std::vector<Shown>& shown, const dvec2& pixel,
                 Sample& result) {
    const dvec2 cell = blend.grid.cell_of(pixel);
    float sum = 0;
    result = {};
    std::array<float, 4> variances{};
    for (const Shown& s : shown) {
        const PositionShare& share = blend.seams.shares[s.index];
        const dvec2 place = mapped(s.from_wall, pixel);
        const MosaicPosition& position = blend.positions[s.index];
        if (!(place.x > -0.5 && place.y > -0.5 && place.x < position.width - 0.5 &&
              place.y < position.height - 0.5))
            continue;
        Sample own;
        if (!sample_at(s.part, place - s.corner, own)) continue;
        level(blend.scales.positions[s.index], blend.layout.positions[s.index], low_at(share, cell), own);
        const float weight = weight_at(share, cell);
        result.add(weight, own);
        for (std::size_t k = 0; k < 4; ++k) variances[k] += squared(weight) * own.v[13 + k];
        sum += weight;
    }
    if (!(sum > 0)) return false;
    for (float& value : result.v) value /= sum;
    for (std::size_t k = 0; k < 4; ++k) result.v[13 + k] = variances[k] / squared(sum);
    return true;
}

void store(const Sample& p, int x, int y, MosaicPart& part) {
    Surface& s = part.surface;
    s.normal(x, y) = normal_of({p.slope().x, p.slope().y});
    s.diffuse(x, y) = p.diffuse(), s.specular(x, y) = p.specular();
    s.roughness(x, y) = std::exp(p.ln_alpha());
    s.confidence(x, y) = std::clamp(p.confidence(), 1e-6f, 1.0f);
    if (!s.specular_colour.empty()) {
        const Rgb colour = glm::clamp(p.colour(), Rgb(0), Rgb(1));
        s.specular_colour(x, y) = colour / std::max({colour.r, colour.g, colour.b, 1e-6f});
    }
    if (!s.lobe_axes.empty()) s.lobe_axes(x, y) = axes_of(p.stretch(), s.roughness(x, y));
    if (part.errors.slope.empty()) return;
    part.errors.slope(x, y) = std::sqrt(std::max(p.slope2(), 0.0f));
    part.errors.diffuse(x, y) = std::sqrt(std::max(p.diffuse2(), 0.0f));
    part.errors.specular(x, y) = std::sqrt(std::max(p.specular2(), 0.0f));
    part.errors.roughness(x, y) = std::sqrt(std::max(p.roughness2(), 0.0f));
}

bool any(const MosaicBlend& blend, bool MosaicPosition::*what, bool wanted) {
    for (std::size_t i = 0; i < blend.positions.size(); ++i)
        if (blend.layout.positions[i].joined && blend.positions[i].*what == wanted) return true;
    return false;
}

}  // namespace

MosaicPart blended(const MosaicBlend& blend, const Region& part) {
    MosaicPart result{Surface(part.width(), part.height()), {}};
    if (any(blend, &MosaicPosition::has_specular_colour, true))
        result.surface.specular_colour = Image<Rgb>(part.width(), part.height(), Rgb(1));
    if (any(blend, &MosaicPosition::has_lobe_axes, true))
        result.surface.lobe_axes = Image<LobeAxes>(part.width(), part.height());
    if (!any(blend, &MosaicPosition::has_errors, false))
        result.errors = FitErrors(part.width(), part.height());
    const std::vector<Shown> shown = shown_in(blend, part);
    parallel_for(0, part.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < part.width(); ++x)
                if (Sample p; blend_pixel(blend, shown, dvec2(part.x0 + x, part.y0 + y), p))
                    store(p, x, y, result);
    });
    return result;
}

}  // namespace tangi
