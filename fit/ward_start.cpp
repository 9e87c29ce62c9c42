// ward_start.cpp: where the batched fit starts: photometric_stereo() of capture/ and the best of five widths
// of the lobe as in ward_fit.cpp, on the lanes of vector registers: start_ward_batch().
#include <algorithm>
#include <array>
#include <cmath>

#include "capture/photometric_stereo.h"
#include "fit/ward_kernel.h"

#include "fit/ward_targets.h"  // before Highway

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fit/ward_start.cpp"
#include <hwy/foreach_target.h>

#include "fit/ward_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

constexpr float kSmallestZ = 0.1f;  // of a normal, as in photometric_stereo.cpp
constexpr int kWidths = 5;
constexpr std::array<float, kWidths> kWidth = {0.06f, 0.12f, 0.2f, 0.32f, 0.5f};

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

// Batcher's merge exchange (Knuth, The Art of Computer Programming 3, algorithm 5.2.2M).
HWY_INLINE void sort_keys(Grey* grey, int n, int at) {
    for (int p = 1; p < n; p *= 2)
        for (int k = p; k >= 1; k /= 2)
            for (int j = k % p; j + k < n; j += 2 * k)
                for (int i = j; i < j + std::min(k, n - j - k); ++i)
                    if (i / (2 * p) == (i + k) / (2 * p)) compare_exchange(grey[i].key, grey[i + k].key, at);
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

// photometric_stereo() but for the diffuse channels: weights are left in `grey`.
HWY_INLINE M stereo(Grey* grey, int n, V count, int at, Vector& normal) {
    const Floats d;
    sort_keys(grey, n, at);
    WardLane counts, low, high, typical;
    store(count, counts, at);
    for (int lane = at; lane < at + static_cast<int>(hn::Lanes(d)); ++lane) {
        const int k = static_cast<int>(counts[lane]);
        if (k < 1) continue;  // 0 everywhere
        low[lane] = grey[k / 5].key[lane];
        high[lane] = grey[k - 1 - k / 5].key[lane];
        typical[lane] = grey[k / 2].key[lane];
    }
    const V lowest = load(low, at), highest = load(high, at), middle = load(typical, at);
    M valid = hn::And(hn::Ge(count, all(3)), hn::Gt(middle, all(1e-5f)));
    const V zero = hn::Zero(d);
    normal = {zero, zero, all(1)};
    Vector g = normal;
    Moments start = no_moments();
    for (int i = 0; i < n; ++i) {
        Grey& s = grey[i];
        const V brightness = load(s.weight, at);
        const M between = hn::And(hn::Ge(brightness, lowest), hn::Le(brightness, highest));
        const V weight = choose(between, all(1), all(0.01f));
        store(weight, s.weight, at);
        add(start, weight, {load(s.x, at), load(s.y, at), load(s.z, at)}, load(s.ambient, at),
            load(s.value, at), normal);
    }
    valid = hn::And(valid, solve(start, g));
    const PhotometricStereoOptions options;
    const auto outlier = static_cast<float>(options.outlier_scale);
    const V smallest = hn::Mul(middle, all(outlier));
    V scale = hn::Mul(middle, all(4 * outlier));
    M going = valid;
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
        scale = hn::Max(hn::Mul(scale, all(0.7f)), smallest);
        const V length = hn::Sqrt(dot(g, g));
        const V tightness = hn::Div(all(1), hn::Max(hn::Mul(scale, scale), all(1e-30f)));
        const V inverse = hn::Div(all(1), hn::Max(length, all(1e-30f)));
        const Vector facing_g = {hn::Mul(g.x, inverse), hn::Mul(g.y, inverse), hn::Mul(g.z, inverse)};
        const Vector before = g;
        Moments sums = no_moments();
        for (int i = 0; i < n; ++i) {
            Grey& s = grey[i];
            const Vector light = {load(s.x, at), load(s.y, at), load(s.z, at)};
            const V direct = dot(before, light), ambient = load(s.ambient, at), value = load(s.value, at);
            const V off = hn::Sub(value, fma(ambient, length, hn::Max(direct, zero)));
            const V w =
                hn::Div(all(1), fma(hn::Mul(off, off), hn::Mul(load(s.inverse2, at), tightness), all(1)));
            const V weight = choose(hn::Gt(direct, zero), hn::Mul(w, w), all(1e-4f));
            store(choose(going, weight, load(s.weight, at)), s.weight, at);
            add(sums, weight, light, ambient, value, facing_g);
        }
        const M unique = solve(sums, g);
        going = hn::And(going, unique);
        g = {choose(going, g.x, before.x), choose(going, g.y, before.y), choose(going, g.z, before.z)};
    }
    const V length = hn::Sqrt(dot(g, g));
    valid = hn::And(valid, hn::Gt(length, all(1e-6f)));
    const V inverse = hn::Div(all(1), choose(valid, length, all(1)));
    normal = {hn::Mul(g.x, inverse), hn::Mul(g.y, inverse), hn::Mul(g.z, inverse)};
    // Steeper than can be seen: turned up to the steepest.
    const V across = hn::Sqrt(fma(normal.x, normal.x, hn::Mul(normal.y, normal.y)));
    const M steep = hn::And(valid, hn::Lt(normal.z, all(kSmallestZ))), flat = hn::Lt(across, all(1e-12f));
    const V turn = choose(
        steep, hn::Div(all(std::sqrt(1 - kSmallestZ * kSmallestZ)), choose(flat, all(1), across)), all(1));
    normal = {hn::Mul(normal.x, turn), hn::Mul(normal.y, turn),
              choose(steep, choose(flat, all(1), all(kSmallestZ)), normal.z)};
    const M known = valid;
    normal = {keep(known, normal.x), keep(known, normal.y), choose(known, normal.z, all(1))};
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

// Light, weights and targets of the iteration; what the model leaves out is taken relative to the matt
// prediction (add_model_error() of ward_fit.cpp says why). Weights of clipped values are negative.
template <int C>
HWY_INLINE V weigh(const WardBatch& b, const WardFitOptions& options, const Vector& normal,
                   const V (&diffuse)[C], int at, WardSlots& slots) {
    const V zero = hn::Zero(Floats());
    const V model_error = all(static_cast<float>(options.model_error));
    const V inverse_scale = all(1 / static_cast<float>(options.robust_scale));
    V used = zero;
    for (int i = 0; i < b.photos; ++i) {
        const auto photo = static_cast<std::size_t>(i);
        const Vector l = {load(b.light[photo][0], at), load(b.light[photo][1], at),
                          load(b.light[photo][2], at)};
        const V ambient = load(b.ambient[photo], at);
        const V hidden = hn::Sub(all(1), load(b.visible[photo], at));
        store(l.x, slots.light[photo][0], at);
        store(l.y, slots.light[photo][1], at);
        store(l.z, slots.light[photo][2], at);
        store(ambient, slots.light[photo][3], at);
        const V cosine = hn::Add(hn::Max(dot(normal, l), zero), ambient);
        for (int c = 0; c < C; ++c) {
            const auto index = static_cast<std::size_t>(i * C + c);
            const V sigma = load(b.sigma[index], at), irradiance = load(b.irradiance[index], at);
            const V given = load(b.value[index], at);
            const M some = hn::And(hn::Ne(sigma, zero), hn::Lt(hn::Abs(given), all(1e30f)));
            const V value = keep(some, given);
            const V matt = hn::Mul(hn::Mul(diffuse[c], cosine), irradiance);
            const V left_out = hn::Mul(model_error, hn::Max(matt, value));
            const V shadow = hn::Mul(hidden, matt);
            const V variance = fma(sigma, sigma, fma(left_out, left_out, hn::Mul(shadow, shadow)));
            const V root = hn::Mul(inverse_scale, inverse_root(choose(some, variance, all(1))));
            const V weight = keep(some, hn::CopySign(root, sigma));
            store(hn::Mul(weight, irradiance), slots.weight[index], at);
            store(hn::Mul(weight, value), slots.target[index], at);
            used = hn::Add(used, keep(hn::Gt(sigma, zero), all(1)));
        }
    }
    return used;
}

// For each of five widths the rho_s that explains what the matt estimate leaves over, and its robust cost;
// the cheapest wins. Least squares alone has two minima in alpha.
template <int C>
HWY_INLINE void start_lobe(const WardSlots& s, const WardFitOptions& options, const V (&diffuse)[C],
                           Grey* grey, int at, V& ln_alpha, V& specular) {
    const V zero = hn::Zero(Floats());
    const V vx = load(s.view[0], at), vy = load(s.view[1], at), vz = load(s.view[2], at);
    const Facing f = facing(load(s.theta[0], at), load(s.theta[1], at), vx, vy, vz);
    const Law law = law_of(options.law);
    V numerator[kWidths], denominator[kWidths];
    for (int k = 0; k < kWidths; ++k) numerator[k] = denominator[k] = zero;
    for (int i = 0; i < s.photos; ++i) {
        const auto& light = s.light[static_cast<std::size_t>(i)];
        const V lx = load(light[0], at), ly = load(light[1], at), lz = load(light[2], at);
        const V l_v = fma(lx, vx, fma(ly, vy, hn::Mul(lz, vz)));
        const Geometry g = geometry(f, lx, ly, lz, fma(l_v, all(2), all(2)));
        V direct = g.n_l;
        if (law.rough)
            direct = keep(g.lit, rough_diffuse(law, g.n_l, hn::Mul(f.view_n, f.inverse), l_v).value);
        const V matt = hn::Add(direct, load(light[3], at)), shape = hn::Mul(g.shape, g.n_l);
        store(matt, grey[i].key, at);
        V left = zero, square = zero;  // sums over the channels of weight * residual, weight^2
        for (int c = 0; c < C; ++c) {
            const auto index = static_cast<std::size_t>(i * C + c);
            const V weight = load(s.weight[index], at);
            const V over = fnma(hn::Mul(weight, diffuse[c]), matt, load(s.target[index], at));
            const V counted = hn::IfThenZeroElse(hn::And(hn::Lt(weight, zero), hn::Ge(over, zero)), weight);
            left = fma(counted, over, left);
            square = fma(counted, counted, square);
        }
        for (int k = 0; k < kWidths; ++k) {
            const float alpha = kWidth[static_cast<std::size_t>(k)], inverse2 = 1 / (alpha * alpha);
            const Gaussians gauss = gaussians(law, g.tan2, all(inverse2));
            const V lobe = hn::Mul(law.hazy ? hn::Add(gauss.core, gauss.haze) : gauss.core, shape);
            store(lobe, grey[i].reuse[k], at);
            numerator[k] = fma(lobe, left, numerator[k]);
            denominator[k] = fma(hn::Mul(lobe, lobe), square, denominator[k]);
        }
    }
    const V most = all(static_cast<float>(options.bounds.specular_max)), least = all(0.002f);
    V candidate[kWidths];
    LogProduct product[kWidths];
    for (int k = 0; k < kWidths; ++k) {
        const M some = hn::Gt(denominator[k], zero);
        const V ratio = keep(some, hn::Div(numerator[k], choose(some, denominator[k], all(1))));
        candidate[k] = hn::Min(hn::Max(ratio, least), most);
        product[k] = empty_product();
    }
    for (int i = 0; i < s.photos; ++i) {
        const V matt = load(grey[i].key, at);
        V weight[C], off[C];
        for (int c = 0; c < C; ++c) {
            const auto index = static_cast<std::size_t>(i * C + c);
            weight[c] = load(s.weight[index], at);
            off[c] = hn::MulSub(hn::Mul(weight[c], diffuse[c]), matt, load(s.target[index], at));
        }
        for (int k = 0; k < kWidths; ++k) {
            const V gloss = hn::Mul(candidate[k], load(grey[i].reuse[k], at));
            V factor = all(1);
            for (int c = 0; c < C; ++c) {
                const V plain = fma(weight[c], gloss, off[c]);
                const V r = hn::IfThenZeroElse(hn::And(hn::Lt(weight[c], zero), hn::Le(plain, zero)), plain);
                factor = hn::Mul(factor, hn::Min(fma(r, r, all(1)), all(1e12f)));
            }
            multiply(product[k], factor);
        }
    }
    const V a_weight = load(s.prior_ln_alpha_weight, at), a_middle = load(s.prior_ln_alpha, at);
    const V s_weight = load(s.prior_specular_weight, at), s_middle = load(s.prior_specular, at);
    V best = all(std::numeric_limits<float>::infinity());
    ln_alpha = all(std::log(kWidth[2]));
    specular = least;
    for (int k = 0; k < kWidths; ++k) {
        const float ln_width = std::log(kWidth[static_cast<std::size_t>(k)]);
        const V a_off = hn::Sub(all(ln_width), a_middle), s_off = hn::Sub(candidate[k], s_middle);
        const V cost =
            fma(hn::Mul(a_weight, a_off), a_off, fma(hn::Mul(s_weight, s_off), s_off, logarithm(product[k])));
        const M better = hn::Lt(cost, best);
        best = choose(better, cost, best);
        ln_alpha = choose(better, all(ln_width), ln_alpha);
        specular = choose(better, candidate[k], specular);
    }
}

template <int C>
HWY_INLINE void start(const WardBatch& b, const WardFitOptions& options, Grey* grey, int at,
                      WardSlots& slots) {
    Vector normal;
    const V count = make_grey<C>(b, grey, at);
    const M valid = stereo(grey, b.photos, count, at, normal);
    V diffuse[C];
    diffuse_of<C>(b, grey, normal, at, diffuse);
    const V used = weigh<C>(b, options, normal, diffuse, at, slots);
    const V scale2 = all(1 / static_cast<float>(options.robust_scale * options.robust_scale));
    const V a_sigma = load(b.prior_ln_alpha_sigma, at), s_sigma = load(b.prior_specular_sigma, at);
    store(load(b.prior_ln_alpha, at), slots.prior_ln_alpha, at);
    store(load(b.prior_specular, at), slots.prior_specular, at);
    store(hn::Div(scale2, hn::Mul(a_sigma, a_sigma)), slots.prior_ln_alpha_weight, at);
    store(hn::Div(scale2, hn::Mul(s_sigma, s_sigma)), slots.prior_specular_weight, at);
    for (std::size_t i = 0; i < 3; ++i) store(load(b.view[i], at), slots.view[i], at);
    store(hn::Neg(hn::Div(normal.x, normal.z)), slots.theta[0], at);
    store(hn::Neg(hn::Div(normal.y, normal.z)), slots.theta[1], at);
    V ln_alpha, specular;
    start_lobe<C>(slots, options, diffuse, grey, at, ln_alpha, specular);
    store(ln_alpha, slots.theta[2], at);
    store(specular, slots.theta[3], at);
    for (int c = 0; c < C; ++c) store(diffuse[c], slots.theta[static_cast<std::size_t>(kWardCommon + c)], at);
    for (int i = 0; i < kWardCommon + C; ++i) {
        const auto [low, high] = ward_interval(options.bounds, i);
        WardLane& theta = slots.theta[static_cast<std::size_t>(i)];
        store(hn::Min(hn::Max(load(theta, at), all(static_cast<float>(low))), all(static_cast<float>(high))),
              theta, at);
    }
    store(used, slots.used, at);
    store(keep(valid, all(1)), slots.valid, at);
    store(keep(valid, all(1)), slots.alive, at);
    store(all(1e-3f), slots.damping, at);
    store(all(2), slots.damping_growth, at);
    store(hn::Zero(Floats()), slots.iterations, at);
    store(hn::Zero(Floats()), slots.resumed, at);
    store(hn::Zero(Floats()), slots.converged, at);
}

void StartBatch(const WardBatch& b, const WardFitOptions& options, WardScratch& scratch, WardSlots& slots) {
    scratch.lanes.resize(static_cast<std::size_t>(b.photos) * sizeof(Grey) / sizeof(WardLane));
    Grey* grey = reinterpret_cast<Grey*>(scratch.lanes.data());
    for (int at = 0; at < kWardLanes; at += static_cast<int>(hn::Lanes(Floats()))) {
        if (b.channels == 3)
            start<3>(b, options, grey, at, slots);
        else
            start<1>(b, options, grey, at, slots);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tangi {

HWY_EXPORT(StartBatch);

void start_ward_batch(const WardBatch& batch, const WardFitOptions& options, WardScratch& scratch,
                      WardSlots& slots) {
    HWY_DYNAMIC_DISPATCH(StartBatch)(batch, options, scratch, slots);
}

}  // namespace tangi
#endif
