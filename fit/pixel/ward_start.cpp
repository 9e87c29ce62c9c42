// ward_start.cpp: where the batched fit starts: photometric_stereo() of capture/ and the best of five widths
// of the lobe as in ward_fit.cpp, on the lanes of vector registers: start_ward_batch().
#include <algorithm>
#include <array>
#include <cmath>

#include "fit/pixel/ward_kernel.h"

#include "surface/base/vector_targets.h"  // before Highway

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fit/pixel/ward_start.cpp"
#include <hwy/foreach_target.h>

#include "fit/pixel/ward_stereo-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

// Widths 0.5 / sqrt(2)^k: their exponents are those of the widest times powers of two, so that one
// exponential serves all of them.
constexpr std::array<int, kWidths> kPower = {0, 1, 3, 4, 6};
constexpr int kPowers = kPower.back() + 3;
constexpr float kLnWidest = -0.693147181f, kLnWidthStep = -0.346573590f, kWidestInverse2 = 4;
constexpr float kLeastSpecular = 0.002f;  // [1] rho_s to start from: from 0 it would not move
inline float ln_width(int k) {
    return kLnWidest + kLnWidthStep * static_cast<float>(kPower[static_cast<std::size_t>(k)]);
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
            const V model = hn::Mul(model_error, hn::Max(matt, value));
            const V shadow = hn::Mul(hidden, matt);
            const V variance = fma(sigma, sigma, fma(model, model, hn::Mul(shadow, shadow)));
            const V root = hn::Mul(inverse_scale, inverse_root(choose(some, variance, all(1))));
            const V weight = keep(some, hn::CopySign(root, sigma));
            store(hn::Mul(weight, irradiance), slots.weight[index], at);
            store(hn::Mul(weight, value), slots.target[index], at);
            used = hn::Add(used, keep(hn::Gt(sigma, zero), all(1)));
        }
    }
    return used;
}

// Lobes of all widths under a light of a photograph, for rho_s = 1, into `grey`.
HWY_INLINE void store_lobes(const LaneModel& reflectance_model, const Geometry& g, Grey& grey, int at,
                            V (&lobes)[kWidths]) {
    const V shape = hn::Mul(g.shape, g.n_l);
    // The second lobe is twice as wide: two powers before.
    V power[kPowers];
    power[0] = exp_negative(hn::Mul(g.tan2, all(-0.25f * kWidestInverse2)));
    for (int k = 1; k < kPowers; ++k) power[k] = squared(power[k - 1]);
    const V core = hn::Mul(shape, reflectance_model.core),
            second_lobe_weight = hn::Mul(shape, hn::Mul(reflectance_model.second_lobe_weight, all(0.25f)));
    for (int k = 0; k < kWidths; ++k) {
        const int wide = kPower[static_cast<std::size_t>(k)];
        V lobe = hn::Mul(core, power[wide + 2]);
        if (reflectance_model.has_second_lobe) lobe = fma(second_lobe_weight, power[wide], lobe);
        lobes[k] = hn::Mul(lobe, all(kWidestInverse2 * static_cast<float>(1 << wide)));
        store(lobes[k], grey.reuse[k], at);
    }
}

// For each width the rho_s that explains what the matt estimate leaves over. What is matt, and the lobes, are
// left in `grey`.
template <int C>
HWY_INLINE void specular_candidates(const WardSlots& s, const WardFitOptions& options, const V (&diffuse)[C],
                                    Grey* grey, int at, V (&candidate)[kWidths]) {
    const V zero = hn::Zero(Floats());
    const V vx = load(s.view[0], at), vy = load(s.view[1], at), vz = load(s.view[2], at);
    const Facing f = facing(load(s.theta[0], at), load(s.theta[1], at), vx, vy, vz);
    const LaneModel reflectance_model = reflectance_model_of(options.reflectance_model);
    const Shape shape_of_lobe = shape_at(s, at, f);
    V numerator[kWidths], denominator[kWidths];
    for (int k = 0; k < kWidths; ++k) numerator[k] = denominator[k] = zero;
    for (int i = 0; i < s.photos; ++i) {
        const auto& light = s.light[static_cast<std::size_t>(i)];
        const V lx = load(light[0], at), ly = load(light[1], at), lz = load(light[2], at);
        const V l_v = fma(lx, vx, fma(ly, vy, hn::Mul(lz, vz)));
        Geometry g = geometry(f, lx, ly, lz, fma(l_v, all(2), all(2)));
        if (shape_of_lobe.some) stretch_half_vector(shape_of_lobe, f, lx, ly, lz, g);
        V direct = g.n_l;
        if (reflectance_model.rough)
            direct =
                keep(g.lit, rough_diffuse(reflectance_model, g.n_l, hn::Mul(f.view_n, f.inverse), l_v).value);
        const V matt = hn::Add(direct, load(light[3], at));
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
        V lobes[kWidths];
        store_lobes(reflectance_model, g, grey[i], at, lobes);
        for (int k = 0; k < kWidths; ++k) {
            numerator[k] = fma(lobes[k], left, numerator[k]);
            denominator[k] = fma(hn::Mul(lobes[k], lobes[k]), square, denominator[k]);
        }
    }
    const V most = all(static_cast<float>(options.bounds.specular_max)), least = all(kLeastSpecular);
    for (int k = 0; k < kWidths; ++k) {
        const M some = hn::Gt(denominator[k], zero);
        const V ratio = keep(some, hn::Div(numerator[k], choose(some, denominator[k], all(1))));
        candidate[k] = hn::Min(hn::Max(ratio, least), most);
    }
}

// Robust costs of the candidates, as products of 1 + s.
template <int C>
HWY_INLINE void cost_products(const WardSlots& s, const V (&diffuse)[C], const Grey* grey, int at,
                              const V (&candidate)[kWidths], LogProduct (&product)[kWidths]) {
    const V zero = hn::Zero(Floats());
    for (int k = 0; k < kWidths; ++k) product[k] = empty_product();
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
}

// For each of five widths the rho_s that explains what the matt estimate leaves over, and its robust cost;
// the cheapest wins. Least squares alone has two minima in alpha.
template <int C>
HWY_INLINE void start_lobe(const WardSlots& s, const WardFitOptions& options, const V (&diffuse)[C],
                           Grey* grey, int at, V& ln_alpha, V& specular) {
    V candidate[kWidths];
    specular_candidates<C>(s, options, diffuse, grey, at, candidate);
    LogProduct product[kWidths];
    cost_products<C>(s, diffuse, grey, at, candidate, product);
    const V a_weight = load(s.prior_ln_alpha_weight, at), a_middle = load(s.prior_ln_alpha, at);
    const V s_weight = load(s.prior_specular_weight, at), s_middle = load(s.prior_specular, at);
    V best = all(std::numeric_limits<float>::infinity());
    ln_alpha = all(ln_width(2));
    specular = all(kLeastSpecular);
    for (int k = 0; k < kWidths; ++k) {
        const V a_off = hn::Sub(all(ln_width(k)), a_middle), s_off = hn::Sub(candidate[k], s_middle);
        const V cost =
            fma(hn::Mul(a_weight, a_off), a_off, fma(hn::Mul(s_weight, s_off), s_off, logarithm(product[k])));
        const M better = hn::Lt(cost, best);
        best = choose(better, cost, best);
        ln_alpha = choose(better, all(ln_width(k)), ln_alpha);
        specular = choose(better, candidate[k], specular);
    }
}

template <int C>
HWY_INLINE void start(const WardBatch& b, const WardFitOptions& options, const WardScratch& scratch,
                      Grey* grey, int at, WardSlots& slots) {
    Vector normal;
    const V count = make_grey<C>(b, grey, at);
    const M valid = stereo(grey, scratch, count, at, normal);
    V diffuse[C];
    diffuse_of<C>(b, grey, normal, at, diffuse);
    const V used = weigh<C>(b, options, normal, diffuse, at, slots);
    const V scale2 = all(1 / static_cast<float>(options.robust_scale * options.robust_scale));
    const V a_sigma = load(b.prior_ln_alpha_sigma, at), s_sigma = load(b.prior_specular_sigma, at);
    store(load(b.prior_ln_alpha, at), slots.prior_ln_alpha, at);
    store(load(b.prior_specular, at), slots.prior_specular, at);
    store(hn::Div(scale2, hn::Mul(a_sigma, a_sigma)), slots.prior_ln_alpha_weight, at);
    store(hn::Div(scale2, hn::Mul(s_sigma, s_sigma)), slots.prior_specular_weight, at);
    for (std::size_t i = 0; i < 2; ++i) {
        store(load(b.prior_slope[i], at), slots.prior_slope[i], at);
        store(hn::Mul(scale2, load(b.prior_slope_weight[i], at)), slots.prior_slope_weight[i], at);
    }
    for (std::size_t i = 0; i < 3; ++i) store(load(b.view[i], at), slots.view[i], at);
    for (std::size_t i = 0; i < 3; ++i) store(load(b.shape[i], at), slots.shape[i], at);
    // What is given is where to start; what samples weigh is as of stereo, so that costs compare.
    V p = hn::Neg(hn::Div(normal.x, normal.z)), q = hn::Neg(hn::Div(normal.y, normal.z));
    const V given = load(b.start_given, at);  // 0 or 1
    p = fma(given, hn::Sub(load(b.start[0], at), p), p);
    q = fma(given, hn::Sub(load(b.start[1], at), q), q);
    for (std::size_t c = 0; c < C; ++c)
        diffuse[c] = fma(given, hn::Sub(load(b.start[2 + c], at), diffuse[c]), diffuse[c]);
    store(p, slots.theta[0], at);
    store(q, slots.theta[1], at);
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
    store(all(3e-3f), slots.damping, at);
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
            start<3>(b, options, scratch, grey, at, slots);
        else
            start<1>(b, options, scratch, grey, at, slots);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tangi {

HWY_EXPORT(StartBatch);

namespace {

// Batcher's merge exchange (Knuth, The Art of Computer Programming 3, algorithm 5.2.2M).
std::vector<std::array<int, 2>> sorting_network(int n) {
    std::vector<std::array<int, 2>> pairs;
    for (int p = 1; p < n; p *= 2)
        for (int k = p; k >= 1; k /= 2)
            for (int j = k % p; j + k < n; j += 2 * k)
                for (int i = j; i < j + std::min(k, n - j - k); ++i)
                    if (i / (2 * p) == (i + k) / (2 * p)) pairs.push_back({i, i + k});
    return pairs;
}

}  // namespace

void start_ward_batch(const WardBatch& batch, const WardFitOptions& options, WardScratch& scratch,
                      WardSlots& slots) {
    if (scratch.sorted != batch.photos) {
        scratch.network = sorting_network(batch.photos);
        scratch.sorted = batch.photos;
    }
    HWY_DYNAMIC_DISPATCH(StartBatch)(batch, options, scratch, slots);
}

}  // namespace tangi
#endif
