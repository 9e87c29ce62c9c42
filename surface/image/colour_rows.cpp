#include "surface/image/colour_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "surface/base/error.h"

#include "surface/base/vector_targets.h"  // before Highway

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/image/colour_rows.cpp"
#include <hwy/foreach_target.h>

#include <hwy/contrib/math/math-inl.h>

#include "surface/base/simd_math-inl.h"

#ifndef TANGI_COLOUR_ROWS_ONCE
#define TANGI_COLOUR_ROWS_ONCE
namespace tangi {

constexpr int kColourBlock = 64;  // pixels at once: what is kept of them between two steps stays in the cache

// offset + scale x^power above `knee`, slope x up to it.
struct PowerCurve {
    float knee, slope, inner_scale, inner_offset, power, scale, offset;
};

struct ColourBlock {
    alignas(64) double l[kColourBlock], a[kColourBlock], b[kColourBlock];
};

}  // namespace tangi
#endif

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

// x^power for x in 0..1 and power > 0, within 1e-6 of it.
HWY_INLINE V power_of(V x, V power) {
    const V ln = log_of(hn::Max(x, all(1e-30f)));
    return keep(hn::Gt(x, all(1e-30f)), exp_negative(hn::Mul(power, hn::Min(ln, all(0)))));
}

void PowerRow(const PowerCurve& curve, const float* from, float* to, std::size_t count) {
    const Floats tag;
    const std::size_t lanes = hn::Lanes(tag);
    const auto value = [&](V x) HWY_ATTR {
        x = hn::Min(hn::Max(x, all(0)), all(1));
        const V inner = fma(x, all(curve.inner_scale), all(curve.inner_offset));
        const V bent = fma(power_of(inner, all(curve.power)), all(curve.scale), all(curve.offset));
        return choose(hn::Le(x, all(curve.knee)), hn::Mul(x, all(curve.slope)), bent);
    };
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) hn::StoreU(value(hn::LoadU(tag, from + i)), tag, to + i);
    if (i == count) return;
    alignas(64) float rest[kVectorLanes] = {};
    std::copy(from + i, from + count, rest);
    hn::Store(value(hn::Load(tag, rest)), tag, rest);
    std::copy(rest, rest + (count - i), to + i);
}

using Doubles = hn::CappedTag<double, 8>;
using W = hn::Vec<Doubles>;

HWY_INLINE W wide(double value) { return hn::Set(Doubles(), value); }
HWY_INLINE W wide_at(const double* values, int at) { return hn::Load(Doubles(), values + at); }
// Products that are not fused with the sum, so that equal colours differ by nothing.
HWY_INLINE W squares(W a, W b) { return hn::Add(hn::Mul(a, a), hn::Mul(b, b)); }

// As lab_from_linear().
HWY_INLINE void lab_of_block(const Rgb* linear, int count, ColourBlock& lab) {
    constexpr double epsilon = 216.0 / 24389, kappa = 24389.0 / 27;
    alignas(64) double t[3][kColourBlock];  // of the white's X, Y, Z
    alignas(64) float root[3][kColourBlock];
    for (int i = 0; i < kColourBlock; ++i) {
        const Rgb colour = i < count ? linear[i] : Rgb(0);
        const double r = std::clamp(colour.r, 0.0f, 1.0f), g = std::clamp(colour.g, 0.0f, 1.0f),
                     b = std::clamp(colour.b, 0.0f, 1.0f);
        t[0][i] = (0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047;
        t[1][i] = 0.2126729 * r + 0.7151522 * g + 0.0721750 * b;
        t[2][i] = (0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883;
        for (int k = 0; k < 3; ++k) root[k][i] = static_cast<float>(t[k][i]);
    }
    const Floats tag;
    for (int i = 0; i < 3 * kColourBlock; i += static_cast<int>(hn::Lanes(tag))) {
        float* at = &root[0][0] + i;
        const V x = hn::Max(hn::Load(tag, at), all(static_cast<float>(epsilon)));
        hn::Store(exp_negative(hn::Mul(hn::Min(log_of(x), all(0)), all(1.0f / 3))), tag, at);
    }
    // A step of Newton's takes 3e-7 to 1e-13.
    const auto f = [&](int k, int i) HWY_ATTR {
        const W x = wide_at(t[k], i),
                y = hn::PromoteTo(Doubles(), hn::Load(hn::Rebind<float, Doubles>(), root[k] + i));
        const W y2 = hn::Mul(y, y);
        const W better = hn::Sub(y, hn::Div(hn::Sub(hn::Mul(y2, y), x), hn::Mul(wide(3), y2)));
        const W straight = hn::Div(hn::MulAdd(wide(kappa), x, wide(16)), wide(116));
        return hn::IfThenElse(hn::Gt(x, wide(epsilon)), better, straight);
    };
    for (int i = 0; i < kColourBlock; i += static_cast<int>(hn::Lanes(Doubles()))) {
        const W fx = f(0, i), fy = f(1, i), fz = f(2, i);
        hn::Store(hn::Sub(hn::Mul(wide(116), fy), wide(16)), Doubles(), lab.l + i);
        hn::Store(hn::Mul(wide(500), hn::Sub(fx, fy)), Doubles(), lab.a + i);
        hn::Store(hn::Mul(wide(200), hn::Sub(fy, fz)), Doubles(), lab.b + i);
    }
}

// sqrt(c^7 / (c^7 + 25^7))
HWY_INLINE W seventh(W c) {
    const W c2 = hn::Mul(c, c), c7 = hn::Mul(hn::Mul(c2, c2), hn::Mul(c2, c));
    return hn::Sqrt(hn::Div(c7, hn::Add(c7, wide(6103515625.0))));
}

// A colour's a' and b as chroma and unit vector of the hue; no vector where there is no chroma.
struct Hue {
    W c, x, y;
};
HWY_INLINE Hue hue_of(W a, W b) {
    const W c = hn::Sqrt(squares(a, b)), zero = hn::Zero(Doubles());
    const auto some = hn::Gt(c, zero);
    const W divisor = hn::IfThenElse(some, c, wide(1));
    return {c, hn::IfThenElseZero(some, hn::Div(a, divisor)), hn::IfThenElseZero(some, hn::Div(b, divisor))};
}

// 2 R_C sin(2 dtheta), for the mean hue's cosine and sine. The hue counts from 0 to 360 degrees, so that what
// is 85 degrees beyond 275 lies 275 before it.
HWY_INLINE W rotation_term(W x, W y, W c_mean) {
    constexpr double degree = std::numbers::pi / 180;
    const W cosine = wide(std::cos(275 * degree)), sine = wide(std::sin(275 * degree));
    const W along = hn::Add(hn::Mul(x, cosine), hn::Mul(y, sine));
    const W across = hn::Sub(hn::Mul(y, cosine), hn::Mul(x, sine));
    const W half = hn::Div(across, hn::Max(hn::Add(wide(1), along), wide(1e-12)));
    W off_deg = hn::Mul(hn::Atan(Doubles(), half), wide(2 / degree));
    off_deg = hn::IfThenElse(hn::Gt(off_deg, wide(85)), hn::Sub(off_deg, wide(360)), off_deg);
    const W u = hn::Mul(off_deg, wide(1.0 / 25));
    const W angle = hn::Mul(hn::Exp(Doubles(), hn::Neg(hn::Mul(u, u))), wide(60 * degree));
    return hn::Mul(hn::Mul(hn::Sin(Doubles(), angle), wide(-2)), seventh(c_mean));
}

// T of the mean hue by the addition theorems.
HWY_INLINE W hue_weight(W x, W y) {
    constexpr double degree = std::numbers::pi / 180;
    const W x2 = hn::Mul(x, x), cos2 = hn::MulSub(wide(2), x2, wide(1)),
            sin2 = hn::Mul(wide(2), hn::Mul(x, y));
    const W cos3 = hn::Mul(x, hn::MulSub(wide(4), x2, wide(3))),
            sin3 = hn::Mul(y, hn::MulSub(wide(4), x2, wide(1)));
    const W cos4 = hn::MulSub(wide(2), hn::Mul(cos2, cos2), wide(1)),
            sin4 = hn::Mul(wide(2), hn::Mul(sin2, cos2));
    const auto turned = [&](double weight, double by_deg, W c, W s) HWY_ATTR {
        return hn::MulAdd(wide(weight * std::cos(by_deg * degree)), c,
                          hn::Mul(wide(weight * std::sin(by_deg * degree)), s));
    };
    W t = hn::Sub(wide(1), turned(0.17, 30, x, y));
    t = hn::MulAdd(wide(0.24), cos2, t);
    t = hn::Add(t, turned(0.32, -6, cos3, sin3));
    return hn::Sub(t, turned(0.20, 63, cos4, sin4));
}

// As delta_e_2000(), with unit vectors instead of angles. Hues that are opposite, whose mean no vector tells,
// come as -1.
HWY_INLINE W delta_e_of(W l1, W a1, W b1, W l2, W a2, W b2) {
    const W half = wide(0.5), one = wide(1), zero = hn::Zero(Doubles());
    const W chroma = hn::Mul(half, hn::Add(hn::Sqrt(squares(a1, b1)), hn::Sqrt(squares(a2, b2))));
    const W stretch = hn::Add(one, hn::Mul(half, hn::Sub(one, seventh(chroma))));
    const Hue first = hue_of(hn::Mul(stretch, a1), b1), second = hue_of(hn::Mul(stretch, a2), b2);
    // The mean hue halves the angle; hues without chroma count as 0 degrees.
    const W sum_x = hn::Add(first.x, second.x), sum_y = hn::Add(first.y, second.y);
    const W sum = hn::Sqrt(squares(sum_x, sum_y)), both = hn::Mul(first.c, second.c);
    const auto none = hn::Eq(hn::Add(first.c, second.c), zero);
    const auto opposite = hn::And(hn::Gt(both, zero), hn::Lt(sum, wide(1e-6)));
    const W divisor = hn::IfThenElse(hn::Or(none, opposite), one, sum);
    const W x = hn::IfThenElse(none, one, hn::Div(sum_x, divisor)), y = hn::Div(sum_y, divisor);
    const W cross = hn::Sub(hn::Mul(first.x, second.y), hn::Mul(first.y, second.x));

    const W delta_h = hn::Mul(hn::Mul(wide(2), hn::Sqrt(both)), hn::Div(cross, divisor));
    const W l_mean = hn::Mul(half, hn::Add(l1, l2)), c_mean = hn::Mul(half, hn::Add(first.c, second.c));
    const W off = hn::Sub(l_mean, wide(50)), l50 = hn::Mul(off, off);
    const W s_l = hn::Add(one, hn::Div(hn::Mul(wide(0.015), l50), hn::Sqrt(hn::Add(wide(20), l50))));
    const W s_c = hn::MulAdd(wide(0.045), c_mean, one);
    const W s_h = hn::MulAdd(hn::Mul(wide(0.015), c_mean), hue_weight(x, y), one);
    const W l = hn::Div(hn::Sub(l2, l1), s_l), c = hn::Div(hn::Sub(second.c, first.c), s_c);
    const W h = hn::Div(delta_h, s_h);
    const W mixed = hn::Mul(rotation_term(x, y, c_mean), hn::Mul(c, h));
    const W square = hn::Add(hn::Mul(l, l), hn::Add(squares(c, h), mixed));
    return hn::IfThenElse(opposite, wide(-1), hn::Sqrt(hn::Max(square, zero)));
}

void DeltaERow(const Rgb* a, const Rgb* b, float* delta_e, std::size_t count) {
    ColourBlock first, second;
    alignas(64) double result[kColourBlock];
    for (std::size_t at = 0; at < count; at += kColourBlock) {
        const int n = static_cast<int>(std::min(count - at, static_cast<std::size_t>(kColourBlock)));
        lab_of_block(a + at, n, first);
        lab_of_block(b + at, n, second);
        for (int i = 0; i < n; i += static_cast<int>(hn::Lanes(Doubles())))
            hn::Store(delta_e_of(wide_at(first.l, i), wide_at(first.a, i), wide_at(first.b, i),
                                 wide_at(second.l, i), wide_at(second.a, i), wide_at(second.b, i)),
                      Doubles(), result + i);
        for (int i = 0; i < n; ++i) {
            if (result[i] < 0)
                result[i] = delta_e_2000({first.l[i], first.a[i], first.b[i]},
                                         {second.l[i], second.a[i], second.b[i]});
            delta_e[at + static_cast<std::size_t>(i)] = static_cast<float>(result[i]);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tangi {

HWY_EXPORT(PowerRow);
HWY_EXPORT(DeltaERow);

namespace {

// Nothing for curves that are no power.
std::optional<PowerCurve> encoding_curve(const Transfer& t) {
    if (t.kind == Transfer::Kind::srgb)
        return PowerCurve{0.0031308f, 12.92f, 1, 0, 1 / 2.4f, 1.055f, -0.055f};
    if (t.kind == Transfer::Kind::gamma)
        return PowerCurve{-1, 0, 1, 0, static_cast<float>(1 / t.gamma), 1, 0};
    return std::nullopt;
}

std::optional<PowerCurve> decoding_curve(const Transfer& t) {
    if (t.kind == Transfer::Kind::srgb)
        return PowerCurve{0.04045f, 1 / 12.92f, 1 / 1.055f, 0.055f / 1.055f, 2.4f, 1, 0};
    if (t.kind == Transfer::Kind::gamma) return PowerCurve{-1, 0, 1, 0, static_cast<float>(t.gamma), 1, 0};
    return std::nullopt;
}

template <class Otherwise>
void through_curve(const std::optional<PowerCurve>& curve, std::span<const Rgb> from, std::span<Rgb> to,
                   const Otherwise& otherwise) {
    TP_REQUIRE(from.size() == to.size(), "rows have one length");
    if (from.empty()) return;
    if (curve) {
        HWY_DYNAMIC_DISPATCH(PowerRow)(*curve, &from[0].r, &to[0].r, 3 * from.size());
        return;
    }
    for (std::size_t i = 0; i < from.size(); ++i)
        for (int c = 0; c < 3; ++c) to[i][c] = otherwise(from[i][c]);
}

}  // namespace

void encode_row(const Transfer& transfer, std::span<const Rgb> linear, std::span<Rgb> stored) {
    through_curve(encoding_curve(transfer), linear, stored,
                  [&](float value) { return std::min(transfer.encode(value), 1.0f); });
}

void decode_row(const Transfer& transfer, std::span<const Rgb> stored, std::span<Rgb> linear) {
    through_curve(decoding_curve(transfer), stored, linear,
                  [&](float value) { return transfer.decode(std::min(value, 1.0f)); });
}

void delta_e_2000_row(std::span<const Rgb> a, std::span<const Rgb> b, std::span<float> delta_e) {
    TP_REQUIRE(a.size() == b.size() && a.size() == delta_e.size(), "rows have one length");
    HWY_DYNAMIC_DISPATCH(DeltaERow)(a.data(), b.data(), delta_e.data(), a.size());
}

}  // namespace tangi
#endif
