#include "datasets/damage.h"

#include <algorithm>
#include <glm/common.hpp>

#include "datasets/composition.h"

namespace tangi::procedural {

namespace {

void blend(PaintSample& sample, const Rgb& diffuse, float specular, float roughness, float part) {
    sample.diffuse += part * (diffuse - sample.diffuse);
    sample.specular = mix(sample.specular, specular, part);
    sample.roughness = mix(sample.roughness, roughness, part);
    sample.specular_colour +=
        part * (Rgb(1) - sample.specular_colour);  // dirt, ground, varnish and paint shine white
}

}  // namespace

float Damage::Blob::depth_inside(float x, float y) const {
    const float away = std::hypot(x - x_mm, y - y_mm);
    if (away > radius_mm * (1 + 2 * raggedness)) return -radius_mm;
    return radius_mm * (1 + raggedness * fractal_noise(1.6f * x / radius_mm, 1.6f * y / radius_mm, 5, seed)) -
           away;
}

Damage::Damage(const PaintingOptions& options, float paint_level_mm, float ground_mm)
    : options_(options), paint_level_mm_(paint_level_mm), ground_mm_(ground_mm) {
    const float half_width = static_cast<float>(options.width * options.mm_per_pixel / 2);
    const float half_height = static_cast<float>(options.height * options.mm_per_pixel / 2);
    const float size = std::min(half_width, half_height);
    const int turn = static_cast<int>(hash(options.seed, 50) % 4);
    const auto blob = [&](int kind, float radius, float raggedness) {
        const Seed seed = hash(options.seed, static_cast<std::uint64_t>(60 + kind));
        const int quarter = (kind + turn) % 4;
        const float right = quarter == 0 || quarter == 3 ? 1.0f : -1.0f, up = quarter < 2 ? 1.0f : -1.0f;
        return Blob{right * half_width * uniform(seed, 0.42f, 0.58f),
                    up * half_height * uniform(hash(seed, 1), 0.42f, 0.58f), radius * size, raggedness, seed};
    };
    cracked_ = blob(0, 0.62f, 0.25f);
    lost_[0] = blob(1, 0.18f, 0.6f);
    retouched_ = blob(2, 0.22f, 0.25f);
    varnished_ = blob(3, 0.28f, 0.06f);
    for (std::size_t i = 1; i < lost_.size(); ++i) {
        const float angle = uniform(hash(lost_[0].seed, i), 0, 2 * std::numbers::pi_v<float>);
        lost_[i] = lost_[0];
        lost_[i].x_mm += 1.7f * lost_[0].radius_mm * std::cos(angle + static_cast<float>(i));
        lost_[i].y_mm += 1.7f * lost_[0].radius_mm * std::sin(angle + static_cast<float>(i));
        lost_[i].radius_mm *= 0.3f;
        lost_[i].seed = hash(lost_[0].seed, 10 + i);
    }
    const auto between = [&](int kind, float radius, float raggedness) {
        const Seed seed = hash(options.seed, static_cast<std::uint64_t>(80 + kind));
        constexpr std::array<std::array<float, 2>, 5> places = {{{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
        const auto& [right, up] = places[(static_cast<std::size_t>(kind) + hash(options.seed, 51)) % 5];
        const float out = uniform(seed, 0.5f, 0.62f);
        return Blob{out * right * half_width, out * up * half_height, radius * size, raggedness, seed};
    };
    abraded_ = between(0, 0.22f, 0.3f);
    flaking_ = between(1, 0.2f, 0.2f);
    stained_ = between(2, 0.2f, 0.3f);
    filled_ = between(3, 0.15f, 0.3f);
    overpainted_ = between(4, 0.19f, 0.15f);
    // A restorer's match is close, never exact.
    retouch_colour_ = Rgb(0.92f, 0.97f, 1.05f) *
                      colour_about(retouched_.x_mm / half_width, retouched_.y_mm / half_height, options.seed);
}

DamageCover Damage::apply(float x, float y, const BareSupport& bare, PaintSample& sample) const {
    DamageCover cover;
    if (options_.craquelure > 0) cover.crack = crack(x, y, bare, sample);
    if (options_.varnish) cover.varnish = varnish(x, y, sample);
    if (options_.losses) cover.loss = lose(x, y, bare, sample);
    if (options_.retouch) cover.retouch = retouch(x, y, sample);
    cover.crack *= (1 - cover.loss) * (1 - cover.retouch);
    cover.varnish *= (1 - cover.loss) * (1 - cover.retouch);
    apply_later(x, y, bare, sample, cover);
    return cover;
}

// What hides something else hides it in the truth too; a stain hides nothing.
void Damage::apply_later(float x, float y, const BareSupport& bare, PaintSample& sample,
                         DamageCover& cover) const {
    if (options_.abrasion) cover.abrasion = abrade(x, y, bare, sample);
    if (options_.flaking) cover.flaking = flake(x, y, bare, sample);
    if (options_.stain) cover.stain = stain(x, y, sample);
    if (options_.old_fill) cover.old_fill = fill(x, y, sample);
    if (options_.overpaint) cover.overpaint = paint_over(x, y, sample);
    const float shown_below_fill = 1 - cover.overpaint, shown = shown_below_fill * (1 - cover.old_fill);
    cover.old_fill *= shown_below_fill;
    for (float* below : {&cover.loss, &cover.crack, &cover.varnish, &cover.retouch, &cover.abrasion,
                         &cover.flaking, &cover.stain})
        *below *= shown;
}

float Damage::crack(float x, float y, const BareSupport& bare, PaintSample& sample) const {
    const float region = smooth_step(0, 0.3f * cracked_.radius_mm, cracked_.depth_inside(x, y));
    if (region <= 0) return 0;
    // Two generations: primary cracks, and finer ones that break up only some of the islands between them.
    const float cell = static_cast<float>(options_.crack_distance_mm);
    float groove = 0, cover = 0, curl = 0;
    for (int generation = 0; generation < 2; ++generation) {
        const Seed seed = hash(cracked_.seed, static_cast<std::uint64_t>(20 + generation));
        const float pitch = generation == 0 ? cell : 0.45f * cell;
        const float wx = x + 0.22f * pitch * fractal_noise(2 * x / pitch, 2 * y / pitch, 2, hash(seed, 1));
        const float wy = y + 0.22f * pitch * fractal_noise(2 * x / pitch, 2 * y / pitch, 2, hash(seed, 2));
        const float present =
            generation == 0
                ? smooth_step(-0.45f, -0.2f, noise(x / cell, y / cell, hash(seed, 3)))
                : smooth_step(0.2f, 0.45f, noise(0.7f * x / cell, 0.7f * y / cell, hash(seed, 3)));
        const float strength = region * present * (generation == 0 ? 1.0f : 0.6f);
        if (strength <= 0) continue;
        const float distance = pitch * voronoi_edge_distance(wx / pitch, wy / pitch, seed);
        const float half_width = 0.15f * (1 + 0.5f * noise(x, y, hash(seed, 4)));
        groove = std::max(groove, strength * std::exp(-distance * distance / (half_width * half_width)));
        curl = std::max(curl, strength * std::exp(-distance / (0.18f * cell)));
        if (strength > 0.25f) cover = std::max(cover, 1 - smooth_step(0.8f, 1.2f, distance / half_width));
    }
    sample.height_mm += static_cast<float>(options_.cupping_mm) * curl;
    const float depth =
        std::min(0.25f * static_cast<float>(options_.craquelure), sample.height_mm - bare.canvas.height_mm);
    sample.height_mm -= groove * std::max(depth, 0.0f);
    blend(sample, 0.15f * sample.diffuse + Rgb(0.012f, 0.01f, 0.008f), 0.02f, 0.6f,
          groove);  // dirt collects there
    return cover;
}

float Damage::lose(float x, float y, const BareSupport& bare, PaintSample& sample) const {
    float depth = -1e9f;
    for (const Blob& blob : lost_) depth = std::max(depth, blob.depth_inside(x, y));
    const float cover = smooth_step(0, 0.35f, depth);
    if (cover <= 0) return 0;
    const float bare_canvas = smooth_step(0, 0.4f, depth - 0.3f * lost_[0].radius_mm);
    const PaintSample& g = bare.ground;
    const PaintSample& c = bare.canvas;
    const Rgb diffuse = (1 - bare_canvas) * g.diffuse + bare_canvas * c.diffuse;
    sample.height_mm = mix(sample.height_mm, mix(g.height_mm, c.height_mm, bare_canvas), cover);
    blend(sample, diffuse, mix(g.specular, c.specular, bare_canvas),
          mix(g.roughness, c.roughness, bare_canvas), smooth_step(0.2f, 0.8f, cover));
    return cover;
}

float Damage::varnish(float x, float y, PaintSample& sample) const {
    const float cover = smooth_step(0, 0.8f, varnished_.depth_inside(x, y));
    if (cover <= 0) return 0;
    sample.height_mm += 0.015f * cover;
    blend(sample, sample.diffuse * Rgb(0.96f, 0.92f, 0.80f), 0.046f, std::max(0.4f * sample.roughness, 0.07f),
          cover);
    return cover;
}

float Damage::retouch(float x, float y, PaintSample& sample) const {
    const float cover = smooth_step(0, 0.8f, retouched_.depth_inside(x, y));
    if (cover <= 0) return 0;
    sample.height_mm = mix(sample.height_mm, paint_level_mm_, 0.6f * cover);
    const float tone = 1 + 0.08f * fractal_noise(x / 3, y / 3, 3, hash(retouched_.seed, 1));
    blend(sample, tone * retouch_colour_, 0.024f, 0.55f, cover);
    return cover;
}

// What rubs is stiff: it takes what stands above a surface that comes down to the tops of the ground, so that
// the ground shows on the threads, and paint is left between them. Worn surfaces are matt.
float Damage::abrade(float x, float y, const BareSupport& bare, PaintSample& sample) const {
    const float cover = smooth_step(0, 0.5f * abraded_.radius_mm, abraded_.depth_inside(x, y));
    if (cover <= 0) return 0;
    const Seed seed = abraded_.seed;
    const float tops = ground_mm_ + 0.2f * static_cast<float>(options_.weave_mm) +
                       0.015f * fractal_noise(x / 3, y / 3, 3, hash(seed, 1));
    const float most = 0.25f * cover;  // [mm] thick paint is not rubbed through
    const float worn = std::max(mix(sample.height_mm, tops, cover), sample.height_mm - most);
    const float rubbed = sample.height_mm - worn;
    if (rubbed <= 0) return cover;
    const float left = std::max(worn - bare.ground.height_mm, 0.0f);  // [mm] of paint
    const float bared = std::exp(-left / 0.012f);
    const float matt = smooth_step(0, 0.01f, rubbed);
    sample.height_mm = worn;
    blend(sample, sample.diffuse, 0.024f, std::max(sample.roughness, 0.5f), matt);
    blend(sample, bare.ground.diffuse, bare.ground.specular, bare.ground.roughness, bared);
    return cover;
}

// Plates of paint between gaps; their edges have come up.
float Damage::flake(float x, float y, const BareSupport& bare, PaintSample& sample) const {
    const float cover = smooth_step(0, 0.1f * flaking_.radius_mm, flaking_.depth_inside(x, y));
    if (cover <= 0) return 0;
    const Seed seed = hash(flaking_.seed, 3);
    const float pitch = 0.7f * static_cast<float>(options_.crack_distance_mm);
    const float wx = x + 0.15f * pitch * fractal_noise(2 * x / pitch, 2 * y / pitch, 2, hash(seed, 1));
    const float wy = y + 0.15f * pitch * fractal_noise(2 * x / pitch, 2 * y / pitch, 2, hash(seed, 2));
    const float distance = pitch * voronoi_edge_distance(wx / pitch, wy / pitch, seed);
    const float lift = 0.22f * (1 + 0.6f * noise(x / pitch, y / pitch, hash(seed, 3)));
    sample.height_mm += cover * lift * std::exp(-distance / (0.16f * pitch));
    const float half_width = 0.22f;
    const float gap = cover * std::exp(-distance * distance / (half_width * half_width));
    sample.height_mm = mix(sample.height_mm, bare.ground.height_mm, gap);
    blend(sample, 0.08f * bare.ground.diffuse, 0.02f, 0.6f, gap);  // in shade, and dirty
    return cover;
}

// Water that dried there: what it left absorbs like a film, most of it at the rim.
float Damage::stain(float x, float y, PaintSample& sample) const {
    const float depth = stained_.depth_inside(x, y);
    const float cover = smooth_step(0, 1.2f, depth);
    if (cover <= 0) return 0;
    const float rim = std::max(depth, 0.0f) / 1.5f;
    const float density = cover * (0.45f + 0.1f * fractal_noise(x / 12, y / 12, 3, hash(stained_.seed, 1)) +
                                   0.35f * std::exp(-rim * rim));
    sample.diffuse *= Rgb(std::exp(-0.35f * density), std::exp(-0.65f * density), std::exp(-1.2f * density));
    return cover;
}

// Putty, levelled with a knife and toned; some are waxy, most matt.
float Damage::fill(float x, float y, PaintSample& sample) const {
    const float cover = smooth_step(0, 0.5f, filled_.depth_inside(x, y));
    if (cover <= 0) return 0;
    const Seed seed = filled_.seed;
    const float level =
        paint_level_mm_ + 0.02f * noise(x / 9, y / 9, hash(seed, 1)) + 0.002f * noise(2 * x, 2 * y, seed);
    sample.height_mm = mix(sample.height_mm, level, cover);
    const bool waxy = uniform(hash(seed, 2)) < 0.35f;
    const float tone = 1 + 0.06f * fractal_noise(x / 5, y / 5, 2, hash(seed, 4));
    const Rgb putty = glm::mix(Rgb(0.58f, 0.53f, 0.44f), retouch_colour_, uniform(hash(seed, 3), 0.1f, 0.7f));
    blend(sample, tone * putty, waxy ? 0.045f : 0.022f, waxy ? 0.17f : 0.62f, cover);
    return cover;
}

// A later hand's paint over the original, with brush marks of its own; what is below shows in its relief.
float Damage::paint_over(float x, float y, PaintSample& sample) const {
    const float cover = smooth_step(0, 0.7f, overpainted_.depth_inside(x, y));
    if (cover <= 0) return 0;
    const Seed seed = overpainted_.seed;
    const float turn = uniform(hash(seed, 1), 0, std::numbers::pi_v<float>);
    const float along = x * std::cos(turn) + y * std::sin(turn),
                across = y * std::cos(turn) - x * std::sin(turn);
    const float marks = 0.025f * fractal_noise(along / 9, across / 0.9f, 3, hash(seed, 2));
    const float below = mix(sample.height_mm, paint_level_mm_, 0.35f);
    sample.height_mm = mix(sample.height_mm, std::max(below, sample.height_mm - 0.1f) + 0.11f + marks, cover);
    const bool glossy = uniform(hash(seed, 3)) < 0.5f;
    const float tone = 1 + 2.5f * marks;
    blend(sample, 0.75f * tone * Rgb(1.1f, 1.0f, 0.8f) * retouch_colour_, glossy ? 0.048f : 0.024f,
          glossy ? 0.15f : 0.56f, 0.92f * cover);
    return cover;
}

}  // namespace tangi::procedural
