// ward_stereo-inl.h: photometric_stereo() of capture/ on the lanes of vector registers. Included once for
// each instruction set by ward_start.cpp (Google Highway's foreach_target).
#if defined(TANGI_WARD_STEREO_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANGI_WARD_STEREO_INL_H
#undef TANGI_WARD_STEREO_INL_H
#else
#define TANGI_WARD_STEREO_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "capture/radiometry/photometric_stereo.h"
#include "fit/pixel/ward_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

constexpr float kSmallestZ = 0.1f;  // of a normal, as in photometric_stereo.cpp
constexpr int kWidths = 5;          // of the lobe, that the start tries

// Grey samples of one register's worth of lanes; all 0 where a sample is not to be used.
struct Grey {
    WardLane x, y, z;         // light times irradiance
    WardLane ambient, value;  // likewise
    WardLane inverse2;        // 1 / irradiance^2
    WardLane weight, key;     // key: brightness, for sorting
    WardLane reuse[kWidths];
};
static_assert(sizeof(Grey) % sizeof(WardLane) == 0);

struct Vector {
    V x, y, z;
};
HWY_INLINE V dot(const Vector& a, const Vector& b) { return fma(a.x, b.x, fma(a.y, b.y, hn::Mul(a.z, b.z))); }

HWY_INLINE void compare_exchange(WardLane& a, WardLane& b, int at) {
    const V x = load(a, at), y = load(b, at);
    store(hn::Min(x, y), a, at);
    store(hn::Max(x, y), b, at);
}

HWY_INLINE void sort_keys(Grey* grey, const std::vector<std::array<int, 2>>& network, int at) {
    for (const auto& [low, high] : network) compare_exchange(grey[low].key, grey[high].key, at);
}

// Sums of the normal equations of g . (light + ambient * normal) = value.
struct Moments {
    V xx, xy, xz, yy, yz, zz, bx, by, bz;
};
HWY_INLINE Moments no_moments() {
    const V zero = hn::Zero(Floats());
    return {zero, zero, zero, zero, zero, zero, zero, zero, zero};
}
HWY_INLINE void add(Moments& m, V weight, const Vector& light, V ambient, V value, const Vector& normal) {
    const V x = fma(ambient, normal.x, light.x), y = fma(ambient, normal.y, light.y);
    const V z = fma(ambient, normal.z, light.z);
    const V wx = hn::Mul(weight, x), wy = hn::Mul(weight, y), wz = hn::Mul(weight, z);
    m.xx = fma(wx, x, m.xx);
    m.xy = fma(wx, y, m.xy);
    m.xz = fma(wx, z, m.xz);
    m.yy = fma(wy, y, m.yy);
    m.yz = fma(wy, z, m.yz);
    m.zz = fma(wz, z, m.zz);
    m.bx = fma(wx, value, m.bx);
    m.by = fma(wy, value, m.by);
    m.bz = fma(wz, value, m.bz);
}

// Where there is no unique g, it stays what it is.
HWY_INLINE M solve(const Moments& m, Vector& g) {
    const V zero = hn::Zero(Floats());
    V xx = m.xx, xy = m.xy, xz = m.xz, yy = m.yy, yz = m.yz, zz = m.zz, bx = m.bx, by = m.by, bz = m.bz;
    // By cofactors, scaled to a trace of 1 so that cubes stay in range.
    const V trace = hn::Add(hn::Add(xx, yy), zz);
    const V scale = hn::Div(all(1), choose(hn::Gt(trace, zero), trace, all(1)));
    for (V* v : {&xx, &xy, &xz, &yy, &yz, &zz, &bx, &by, &bz}) *v = hn::Mul(*v, scale);
    const V cx = hn::MulSub(yy, zz, hn::Mul(yz, yz)), cy = hn::MulSub(xz, yz, hn::Mul(xy, zz));
    const V cz = hn::MulSub(xy, yz, hn::Mul(xz, yy));
    const V determinant = fma(xx, cx, fma(xy, cy, hn::Mul(xz, cz)));
    const M unique = hn::And(hn::Gt(trace, zero), hn::Gt(determinant, all(1e-9f)));
    const V inverse = hn::Div(all(1), choose(unique, determinant, all(1)));
    const V dyy = hn::MulSub(xx, zz, hn::Mul(xz, xz)), dzz = hn::MulSub(xx, yy, hn::Mul(xy, xy));
    const V dyz = hn::MulSub(xy, xz, hn::Mul(xx, yz));
    const V gx = hn::Mul(fma(cx, bx, fma(cy, by, hn::Mul(cz, bz))), inverse);
    const V gy = hn::Mul(fma(cy, bx, fma(dyy, by, hn::Mul(dyz, bz))), inverse);
    const V gz = hn::Mul(fma(cz, bx, fma(dyz, by, hn::Mul(dzz, bz))), inverse);
    g = {choose(unique, gx, g.x), choose(unique, gy, g.y), choose(unique, gz, g.z)};
    return unique;
}

// Fills the grey samples; returns how many each lane has.
template <int C>
HWY_INLINE V make_grey(const WardBatch& b, Grey* grey, int at) {
    const V zero = hn::Zero(Floats());
    V count = zero;
    for (int i = 0; i < b.photos; ++i) {
        Grey& s = grey[i];
        V value = zero, irradiance = zero;
        M usable = hn::Eq(zero, zero);
        for (int c = 0; c < C; ++c) {
            const auto index = static_cast<std::size_t>(i * C + c);
            value = hn::Add(value, load(b.value[index], at));
            irradiance = hn::Add(irradiance, load(b.irradiance[index], at));
            usable = hn::And(usable, hn::Gt(load(b.sigma[index], at), zero));
        }
        const V e = keep(usable, hn::Mul(irradiance, all(1.0f / C)));
        const auto& light = b.light[static_cast<std::size_t>(i)];
        const V z = hn::Mul(load(light[2], at), e);
        const V ambient = hn::Mul(load(b.ambient[static_cast<std::size_t>(i)], at), e);
        const V grey_value = keep(usable, hn::Mul(value, all(1.0f / C)));
        store(hn::Mul(load(light[0], at), e), s.x, at);
        store(hn::Mul(load(light[1], at), e), s.y, at);
        store(z, s.z, at);
        store(ambient, s.ambient, at);
        store(grey_value, s.value, at);
        store(keep(usable, hn::Div(all(1), choose(usable, hn::Mul(e, e), all(1)))), s.inverse2, at);
        const V brightness = hn::Div(grey_value, hn::Max(hn::Add(z, ambient), all(1e-3f)));
        store(brightness, s.weight, at);
        store(choose(usable, brightness, all(1e30f)), s.key, at);
        count = hn::Add(count, keep(usable, all(1)));
    }
    return count;
}

// Brightness of the samples of each lane: a fifth of the way from either end, and in the middle.
struct Quantiles {
    V low, middle, high;
};
HWY_INLINE Quantiles quantiles(Grey* grey, const WardScratch& scratch, V count, int at) {
    sort_keys(grey, scratch.network, at);
    WardLane counts, low, high, typical;
    store(count, counts, at);
    for (int lane = at; lane < at + static_cast<int>(hn::Lanes(Floats())); ++lane) {
        const int k = static_cast<int>(counts[lane]);
        if (k < 1) continue;  // 0 everywhere
        low[lane] = grey[k / 5].key[lane];
        high[lane] = grey[k - 1 - k / 5].key[lane];
        typical[lane] = grey[k / 2].key[lane];
    }
    return {load(low, at), load(typical, at), load(high, at)};
}

// The first g, towards a flat surface: what is neither shadow nor highlight decides.
HWY_INLINE M start_stereo(Grey* grey, int samples, const Quantiles& brightness_of, int at, Vector& g) {
    const V lowest =
        hn::Max(brightness_of.low, hn::Mul(brightness_of.high, all(static_cast<float>(kWardStereo.shadow))));
    const Vector flat = g;
    Moments start = no_moments();
    for (int i = 0; i < samples; ++i) {
        Grey& s = grey[i];
        const V brightness = load(s.weight, at);
        const M between = hn::And(hn::Ge(brightness, lowest), hn::Le(brightness, brightness_of.high));
        const V weight = choose(between, all(1), all(0.01f));
        store(weight, s.weight, at);
        add(start, weight, {load(s.x, at), load(s.y, at), load(s.z, at)}, load(s.ambient, at),
            load(s.value, at), flat);
    }
    return solve(start, g);
}

// One iteration of lanes that are still `going`: those that have no unique g are no more.
HWY_INLINE void reweigh_stereo(Grey* grey, int samples, V scale, int at, M& going, Vector& g) {
    const V length = hn::Sqrt(dot(g, g));
    const V tightness = hn::Div(all(1), hn::Max(hn::Mul(scale, scale), all(1e-30f)));
    const V inverse = hn::Div(all(1), hn::Max(length, all(1e-30f)));
    const Vector facing_g = {hn::Mul(g.x, inverse), hn::Mul(g.y, inverse), hn::Mul(g.z, inverse)};
    const Vector before = g;
    const V zero = hn::Zero(Floats());
    Moments sums = no_moments();
    for (int i = 0; i < samples; ++i) {
        Grey& s = grey[i];
        const Vector light = {load(s.x, at), load(s.y, at), load(s.z, at)};
        const V direct = dot(before, light), ambient = load(s.ambient, at), value = load(s.value, at);
        const V off = hn::Sub(value, fma(ambient, length, hn::Max(direct, zero)));
        const V w = hn::Div(all(1), fma(hn::Mul(off, off), hn::Mul(load(s.inverse2, at), tightness), all(1)));
        const V weight = choose(hn::Gt(direct, zero), hn::Mul(w, w), all(1e-4f));
        store(choose(going, weight, load(s.weight, at)), s.weight, at);
        add(sums, weight, light, ambient, value, facing_g);
    }
    const M unique = solve(sums, g);
    going = hn::And(going, unique);
    g = {choose(going, g.x, before.x), choose(going, g.y, before.y), choose(going, g.z, before.z)};
}

// The normal of g where that is `valid`, else (0, 0, 1). Steeper than can be seen: turned up to the steepest.
HWY_INLINE Vector visible_normal(const Vector& g, V length, M valid) {
    const V inverse = hn::Div(all(1), choose(valid, length, all(1)));
    const Vector normal = {hn::Mul(g.x, inverse), hn::Mul(g.y, inverse), hn::Mul(g.z, inverse)};
    const V across = hn::Sqrt(fma(normal.x, normal.x, hn::Mul(normal.y, normal.y)));
    const M steep = hn::And(valid, hn::Lt(normal.z, all(kSmallestZ))), flat = hn::Lt(across, all(1e-12f));
    const V turn = choose(
        steep, hn::Div(all(std::sqrt(1 - kSmallestZ * kSmallestZ)), choose(flat, all(1), across)), all(1));
    const V z = choose(steep, choose(flat, all(1), all(kSmallestZ)), normal.z);
    return {keep(valid, hn::Mul(normal.x, turn)), keep(valid, hn::Mul(normal.y, turn)),
            choose(valid, z, all(1))};
}

// photometric_stereo() but for the diffuse channels: weights are left in `grey`.
HWY_INLINE M stereo(Grey* grey, const WardScratch& scratch, V count, int at, Vector& normal) {
    const PhotometricStereoOptions& options = kWardStereo;
    const Quantiles brightness = quantiles(grey, scratch, count, at);
    M valid = hn::And(hn::Ge(count, all(3)), hn::Gt(brightness.middle, all(1e-5f)));
    const V zero = hn::Zero(Floats());
    Vector g = {zero, zero, all(1)};
    valid = hn::And(valid, start_stereo(grey, scratch.sorted, brightness, at, g));
    const auto outlier = static_cast<float>(options.outlier_scale);
    const V smallest = hn::Mul(brightness.middle, all(outlier));
    V scale = hn::Mul(brightness.middle, all(4 * outlier));
    M going = valid;
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
        scale = hn::Max(hn::Mul(scale, all(0.7f)), smallest);
        reweigh_stereo(grey, scratch.sorted, scale, at, going, g);
    }
    const V length = hn::Sqrt(dot(g, g));
    valid = hn::And(valid, hn::Gt(length, all(1e-6f)));
    normal = visible_normal(g, length, valid);
    return valid;
}

// The albedo of each channel that explains the samples under the normal, as stereo() weighed them.
template <int C>
HWY_INLINE void diffuse_of(const WardBatch& b, const Grey* grey, const Vector& normal, int at,
                           V (&diffuse)[C]) {
    const V zero = hn::Zero(Floats());
    V numerator[C], denominator[C];
    for (int c = 0; c < C; ++c) numerator[c] = denominator[c] = zero;
    for (int i = 0; i < b.photos; ++i) {
        const auto& light = b.light[static_cast<std::size_t>(i)];
        const V direct = dot(normal, {load(light[0], at), load(light[1], at), load(light[2], at)});
        const M used = hn::And(hn::Gt(direct, zero), hn::Gt(load(grey[i].inverse2, at), zero));
        const V w = keep(used, load(grey[i].weight, at));
        const V cosine = hn::Add(direct, load(b.ambient[static_cast<std::size_t>(i)], at));
        for (int c = 0; c < C; ++c) {
            const auto index = static_cast<std::size_t>(i * C + c);
            const V model = hn::Mul(cosine, load(b.irradiance[index], at));
            const V value = keep(used, load(b.value[index], at));
            numerator[c] = fma(hn::Mul(w, value), model, numerator[c]);
            denominator[c] = fma(hn::Mul(w, model), model, denominator[c]);
        }
    }
    for (int c = 0; c < C; ++c) {
        const M some = hn::Gt(denominator[c], zero);
        diffuse[c] = keep(some, hn::Max(hn::Div(numerator[c], choose(some, denominator[c], all(1))), zero));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#endif
