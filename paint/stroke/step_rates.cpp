#include "paint/stroke/step_rates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr double kTipOfHold = 1.0 / 3;  // part of what bristles hold that is at their tips
constexpr float kPerStepAtMost = 0.5f;  // of load or paint in one step: TransferRates

// sigma = 0.03 N/m of linseed oil, tau = 60 Pa of paint that was just sheared.
constexpr double kYieldOverTension_per_mm = 60 / 0.03 * 1e-3;

// Surface tension levels waves of length l and amplitude a where sigma a (2 pi / l)^2, its stress in a film
// about as thick as they are long, exceeds the yield stress (after Orchard 1962, "On surface levelling in
// viscous liquids and gels"). Of waves of two pixels there remain, from trough to crest, 2 tau (2 mm)^2 / (4
// pi^2 sigma).
constexpr double kPit_per_mm = kYieldOverTension_per_mm * 2 / (std::numbers::pi * std::numbers::pi);

// By the same law paint is no more curved than by a radius of sigma / tau: a pixel on a ridge stands above
// those at either side by half a pixel's square over that at most.
constexpr double kBulge_per_mm = kYieldOverTension_per_mm / 2;

// [1] Under a blade all paint is sheared, and it leaves a sheet that is as even as its edge: of pits and
// bulges there remains this part. What a slanting edge lays in steps is else a lattice of single pixels, 1 %
// of a sheet's thickness.
constexpr float kSmoothed = 0.01f;

// Surface tension fills pits in paint of thickness h at a rate of h^3 sigma k^4 / (3 eta) (ibid.): one of two
// pixels' length, at 0.1 mm a pixel and in 10 Pa s, by a third in the 40 ms in which a brush passes, where h
// is this part [1] of a pixel, and by a twentieth where h is half of that. Thinner paint stays where it is.
constexpr double kStill = 0.2;

// [1] The lightest touch that all bristles bear which it flattens (kLightest in brush.cpp). Under a lighter
// one only some of them do: real contact grows as the force (Archard 1957, "Elastic deformation and the laws
// of friction"), from nothing. What does not touch neither gives nor takes nor pushes.
constexpr float kLightTouch = 0.15f;

// Pressure drives paint out of the tuft and, under it, to the sides, where it stays as lips: of a film of
// thickness h a cross-section of kSqueeze p h^2 at most while the contact passes, a ridge a few times as wide
// as the film is thick. [1] Both at full pressure; kPress over the deposit.
constexpr float kSqueeze = 10, kPress = 2.6f;

// [1] Bristles that are pressed through an upper film mix it with what it lies on: part of it that has
// changed places once the contact has passed, at full pressure, as a rate. Light ones slide over it, and
// tools that take up less than a brush (blades) stir less.
constexpr double kStir = 1.5;
// [1] Bristles change places with the paint that they are in so many times as fast, those that give less than
// a brush (rags) the less.
constexpr double kSwap = 2;

// [1] Pressing squeezes paint out of the tuft: deposit over that at a pressure of 0.6.
double squeezing(float pressure) { return 0.55 + 0.75 * static_cast<double>(pressure); }

float touching_part(float pressure) { return std::min(pressure / kLightTouch, 1.0f); }

}  // namespace

TransferRates rates_of(const BrushSettings& s, double mm_per_pixel) {
    TransferRates r;
    r.push = static_cast<float>(s.push);
    r.hold_mm = static_cast<float>(s.hold_mm);
    r.film_mm = static_cast<float>(s.film_mm);
    r.reach_mm = static_cast<float>(s.reach_mm);
    r.load_reach = static_cast<float>(s.load_reach);
    r.tip_mm = static_cast<float>(s.hold_mm * kTipOfHold);
    r.spread = static_cast<float>(s.spread);
    r.yield_mm = static_cast<float>(s.yield_slope * mm_per_pixel);
    r.flow = 0.15f;
    r.pit_mm = static_cast<float>(kPit_per_mm * mm_per_pixel * mm_per_pixel);
    r.bulge_mm = static_cast<float>(kBulge_per_mm * mm_per_pixel * mm_per_pixel);
    r.still_mm = static_cast<float>(kStill * mm_per_pixel);
    if (traits_of(s.shape).blade) {
        r.pit_mm *= kSmoothed;
        r.bulge_mm *= kSmoothed;
    }
    return r;
}

TransferRates rates_of(const Brush& brush, const Dab& dab, double mm_per_pixel) {
    const BrushSettings& s = brush.settings();
    const double length_px = brush.contact_length_px(dab), resolved_px = brush.resolved_length_px(dab);
    const auto rate = [&](double over_contact, double over_px) {
        return std::min(static_cast<float>(1 - portable::exp(-over_contact * dab.length_px / over_px)),
                        kPerStepAtMost);
    };
    const float touch = touching_part(dab.pressure);
    // A brush that is too small to be resolved works on a part of each pixel's width only, and its load lies
    // on bristles that stand for fewer.
    const double cover = brush.coverage(), across = cover * resolved_px / length_px;
    TransferRates r = rates_of(s, mm_per_pixel);
    r.deposit = rate(s.deposit * squeezing(dab.pressure), length_px) * touch;
    r.press = kPress * dab.pressure * touch;
    const auto passed = dab.stands ? dab.pressed : dab.length_px / static_cast<float>(resolved_px);
    r.squeeze_per_mm = kSqueeze * dab.pressure * touch * passed / static_cast<float>(mm_per_pixel);
    r.pickup = rate(s.pickup, resolved_px) * static_cast<float>(across) * touch;
    const BrushSettings usual;
    const double pressed = static_cast<double>(dab.pressure) * static_cast<double>(dab.pressure);
    r.stir = rate(kStir * pressed * std::min(s.pickup / usual.pickup, 1.0), resolved_px) *
             static_cast<float>(across) * touch;
    r.swap = static_cast<float>(kSwap * std::min(s.deposit / usual.deposit, 1.0)) * r.stir;
    r.push *= static_cast<float>(across) * touch;
    r.hold_mm = static_cast<float>(s.hold_mm * cover);
    r.tip_mm *= static_cast<float>(cover);
    r.film_mm = static_cast<float>(s.film_mm * across);
    r.ride_mm = brush.ride_mm(dab.pressure);
    r.load_reach = static_cast<float>(s.load_reach / cover);
    return r;
}

}  // namespace tangi
