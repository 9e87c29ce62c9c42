// damage.h: what time and restorers did to the procedural painting: cracks, losses, varnish, a retouch; and,
// where asked for, abrasion, flaking, a stain, an old fill and overpaint.
//
// Each of the first four has its own quarter of the picture (craquelure spreads beyond it), which depends on
// the seed; the others lie between the quarters and in the middle.
#pragma once

#include <array>

#include "datasets/brush_strokes.h"
#include "datasets/procedural_painting.h"

namespace tangi::procedural {

// How much of each kind of damage a point shows, 0..1.
struct DamageCover {
    float loss = 0, crack = 0, varnish = 0, retouch = 0;
    float abrasion = 0, flaking = 0, stain = 0, old_fill = 0, overpaint = 0;
};

inline constexpr std::array kDamageKinds = {
    &DamageCover::loss,    &DamageCover::crack,    &DamageCover::varnish,
    &DamageCover::retouch, &DamageCover::abrasion, &DamageCover::flaking,
    &DamageCover::stain,   &DamageCover::old_fill, &DamageCover::overpaint};

// What a loss lays bare at one point.
struct BareSupport {
    PaintSample ground, canvas;
};

class Damage {
public:
    // `paint_level_mm` is the mean height of the paint's surface, to which a retouch is filled up;
    // `ground_mm` that of the ground, down to which paint is rubbed off.
    Damage(const PaintingOptions& options, float paint_level_mm, float ground_mm);

    DamageCover apply(float x_mm, float y_mm, const BareSupport& bare, PaintSample& sample) const;

private:
    struct Blob {
        float x_mm = 0, y_mm = 0, radius_mm = 1, raggedness = 0.3f;
        Seed seed = 0;
        float depth_inside(float x_mm,
                           float y_mm) const;  // [mm] about the distance to the outline; < 0 outside
    };
    float crack(float x_mm, float y_mm, const BareSupport& bare, PaintSample& sample) const;
    float lose(float x_mm, float y_mm, const BareSupport& bare, PaintSample& sample) const;
    float varnish(float x_mm, float y_mm, PaintSample& sample) const;
    float retouch(float x_mm, float y_mm, PaintSample& sample) const;
    float abrade(float x_mm, float y_mm, const BareSupport& bare, PaintSample& sample) const;
    float flake(float x_mm, float y_mm, const BareSupport& bare, PaintSample& sample) const;
    float stain(float x_mm, float y_mm, PaintSample& sample) const;
    float fill(float x_mm, float y_mm, PaintSample& sample) const;
    float paint_over(float x_mm, float y_mm, PaintSample& sample) const;
    void apply_later(float x_mm, float y_mm, const BareSupport& bare, PaintSample& sample,
                     DamageCover& cover) const;

    PaintingOptions options_;
    float paint_level_mm_, ground_mm_;
    Blob cracked_, varnished_, retouched_;
    Blob abraded_, flaking_, stained_, filled_, overpainted_;
    std::array<Blob, 3> lost_;  // one large, two flakes beside it
    Rgb retouch_colour_{0.5f};
};

}  // namespace tangi::procedural
