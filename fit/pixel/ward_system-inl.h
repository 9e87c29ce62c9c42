// ward_system-inl.h: cost, gradient and J^T J of the lanes of vector registers: evaluate(). Included once for
// each instruction set by ward_kernel.cpp (Google Highway's foreach_target).
//
// All are in units of the robust scale squared. Channels share the derivatives of matt reflection and lobe,
// so the ten sums over the common parameters are taken once a light, not once a channel.
#if defined(TANGI_WARD_SYSTEM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANGI_WARD_SYSTEM_INL_H
#undef TANGI_WARD_SYSTEM_INL_H
#else
#define TANGI_WARD_SYSTEM_INL_H
#endif

#include <algorithm>

#include "fit/pixel/ward_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

// The upper triangle of J^T J and J^T r at a point; rows p, q, ln alpha, rho_s, then one a channel.
template <int C>
struct System {
    V common[10];     // pp pq pa ps qq qa qs aa as ss
    V diffuse[C][5];  // of each channel with p, q, a, s, and with itself
    V gradient[4 + C];
    V cost;
};

// All numbers of it, with their places in WardSlots::system.
template <int C, class Visit>
HWY_INLINE void each(System<C>& system, const Visit& visit) {
    int k = 0;
    for (V& v : system.common) visit(v, k++);
    for (auto& row : system.diffuse)
        for (V& v : row) visit(v, k++);
    for (V& v : system.gradient) visit(v, k++);
    visit(system.cost, k);
}

template <int C>
struct Point {
    V theta[4 + C];
};

// Weight of a squared derivative in J^T J of the root of Cauchy's loss (root_cauchy() of ward_residual.h),
// w (1 - w) / -ln w with w = 1 / (1 + s), within 0.0023 on [0, 1]; it only steers steps and errors.
HWY_INLINE V curvature_weight(V w) {
    V p = all(0.168562f);
    p = fma(p, w, all(-0.515448f));
    p = fma(p, w, all(1.036022f));
    p = fma(p, w, all(0.310864f));
    return hn::Mul(p, w);
}

// Residuals of one photograph, all channels: weights of squares and of residuals. `product` becomes that of
// 1 + s, which is all the cost needs.
template <int C>
HWY_INLINE void residuals_of(const V (&weight)[C], const V (&target)[C], const V* diffuse, V matt, V gloss,
                             V (&square)[C], V (&linear)[C], V& product) {
    V r[C], s[C];
    // A negative weight is that of a clipped value, a lower bound: as long as the model is above, it says
    // nothing.
    const V zero = hn::Zero(Floats());
    V counted[C];
    for (int c = 0; c < C; ++c) {
        const V off = hn::MulSub(weight[c], fma(diffuse[c], matt, gloss), target[c]);
        const M silent = hn::And(hn::Lt(weight[c], zero), hn::Le(off, zero));
        r[c] = hn::IfThenZeroElse(silent, off);
        counted[c] = hn::IfThenZeroElse(silent, weight[c]);
        s[c] = hn::Min(fma(r[c], r[c], all(1)), all(1e12f));
    }
    // One division for all channels.
    V w[C];
    if constexpr (C == 3) {
        const V first = hn::Mul(s[0], s[1]), last = hn::Mul(s[1], s[2]);
        product = hn::Mul(first, s[2]);
        const V inverse = hn::Div(all(1), product);
        w[0] = hn::Mul(last, inverse);
        w[1] = hn::Mul(hn::Mul(s[0], s[2]), inverse);
        w[2] = hn::Mul(first, inverse);
    } else {
        product = s[0];
        w[0] = hn::Div(all(1), s[0]);
    }
    for (int c = 0; c < C; ++c) {
        square[c] = hn::Mul(hn::Mul(counted[c], counted[c]), curvature_weight(w[c]));
        linear[c] = hn::Mul(hn::Mul(counted[c], r[c]), w[c]);
    }
}

// What a block of photographs leaves between the steps of evaluate(): few enough to stay in the nearest
// cache.
constexpr int kBlock = 16;
template <int C>
struct Block {
    Terms terms[kBlock];
    V square[kBlock][C], linear[kBlock][C];
};

// The sums over the common parameters. Columns of J: p, q: rho_c dmatt + rho_s dlobe; ln alpha: rho_s dlobe;
// rho_s: lobe; rho_c: matt.
template <int C>
HWY_INLINE void add_common(const Block<C>& block, int n, const V* diffuse, V specular, System<C>& sum) {
    V h[10], g[4];
    for (int i = 0; i < 10; ++i) h[i] = sum.common[i];
    for (int i = 0; i < 4; ++i) g[i] = sum.gradient[i];
    for (int i = 0; i < n; ++i) {
        const Terms& t = block.terms[i];
        const V *square = block.square[i], *linear = block.linear[i];
        const V g0 = hn::Mul(specular, t.dlobe[0]), g1 = hn::Mul(specular, t.dlobe[1]);
        const V g2 = hn::Mul(specular, t.dlobe[2]);
        V one = square[0], first = hn::Mul(square[0], diffuse[0]), second = hn::Mul(first, diffuse[0]);
        V r_one = linear[0], r_first = hn::Mul(linear[0], diffuse[0]);
        for (int c = 1; c < C; ++c) {
            const V weighted = hn::Mul(square[c], diffuse[c]);
            one = hn::Add(one, square[c]);
            first = hn::Add(first, weighted);
            second = fma(weighted, diffuse[c], second);
            r_one = hn::Add(r_one, linear[c]);
            r_first = fma(linear[c], diffuse[c], r_first);
        }
        // Sums over the channels of weight * column p (q), split in what multiplies dmatt and what the rest.
        const V p_matt = fma(second, t.dmatt[0], hn::Mul(first, g0));
        const V q_matt = fma(second, t.dmatt[1], hn::Mul(first, g1));
        const V p_rest = fma(first, t.dmatt[0], hn::Mul(one, g0));
        const V q_rest = fma(first, t.dmatt[1], hn::Mul(one, g1));
        const V a_rest = hn::Mul(one, g2), s_rest = hn::Mul(one, t.lobe);
        h[0] = fma(p_matt, t.dmatt[0], fma(p_rest, g0, h[0]));
        h[1] = fma(p_matt, t.dmatt[1], fma(p_rest, g1, h[1]));
        h[2] = fma(p_rest, g2, h[2]);
        h[3] = fma(p_rest, t.lobe, h[3]);
        h[4] = fma(q_matt, t.dmatt[1], fma(q_rest, g1, h[4]));
        h[5] = fma(q_rest, g2, h[5]);
        h[6] = fma(q_rest, t.lobe, h[6]);
        h[7] = fma(a_rest, g2, h[7]);
        h[8] = fma(a_rest, t.lobe, h[8]);
        h[9] = fma(s_rest, t.lobe, h[9]);
        g[0] = fma(r_first, t.dmatt[0], fma(r_one, g0, g[0]));
        g[1] = fma(r_first, t.dmatt[1], fma(r_one, g1, g[1]));
        g[2] = fma(r_one, g2, g[2]);
        g[3] = fma(r_one, t.lobe, g[3]);
    }
    for (int i = 0; i < 10; ++i) sum.common[i] = h[i];
    for (int i = 0; i < 4; ++i) sum.gradient[i] = g[i];
}

// The sums of channel c with the common parameters: rho_s times the lobe's derivatives is left to the end.
template <int C>
HWY_INLINE void add_channel(const Block<C>& block, int n, int c, V (&h)[7], V& gradient) {
    V a[7], g = gradient;
    for (int i = 0; i < 7; ++i) a[i] = h[i];
    for (int i = 0; i < n; ++i) {
        const Terms& t = block.terms[i];
        const V matt = hn::Mul(block.square[i][c], t.matt);
        a[0] = fma(matt, t.dmatt[0], a[0]);
        a[1] = fma(matt, t.dmatt[1], a[1]);
        a[2] = fma(matt, t.dlobe[0], a[2]);
        a[3] = fma(matt, t.dlobe[1], a[3]);
        a[4] = fma(matt, t.dlobe[2], a[4]);
        a[5] = fma(matt, t.lobe, a[5]);
        a[6] = fma(matt, t.matt, a[6]);
        g = fma(block.linear[i][c], t.matt, g);
    }
    for (int i = 0; i < 7; ++i) h[i] = a[i];
    gradient = g;
}

// What evaluate() needs of a point, whatever the photograph.
template <int C>
struct PointTerms {
    V vx, vy, vz;
    Facing facing_of;
    Shape shape;
    V inverse_alpha2, specular;
    V diffuse[C];
};

template <int C>
HWY_INLINE PointTerms<C> point_terms(const WardSlots& s, int at, const Point<C>& point) {
    PointTerms<C> p;
    p.vx = load(s.view[0], at), p.vy = load(s.view[1], at), p.vz = load(s.view[2], at);
    p.facing_of = facing(point.theta[0], point.theta[1], p.vx, p.vy, p.vz);
    p.shape = shape_at(s, at, p.facing_of);
    const V alpha = exp_negative(point.theta[2]);  // bounds keep it below 1
    p.inverse_alpha2 = hn::Div(all(1), hn::Mul(alpha, alpha));
    p.specular = point.theta[3];
    for (int c = 0; c < C; ++c) p.diffuse[c] = point.theta[4 + c];
    return p;
}

// The terms of n photographs from `first` on, and their residuals.
template <int C>
HWY_INLINE void fill_block(const WardSlots& s, const LaneModel& reflectance_model, int at,
                           const PointTerms<C>& p, int first, int n, Block<C>& block, LogProduct& product) {
    for (int i = 0; i < n; ++i) {
        const auto& light = s.light[static_cast<std::size_t>(first + i)];
        const V lx = load(light[0], at), ly = load(light[1], at), lz = load(light[2], at);
        const V l_v = fma(lx, p.vx, fma(ly, p.vy, hn::Mul(lz, p.vz)));
        block.terms[i] = ward_terms(reflectance_model, p.facing_of, p.shape, p.inverse_alpha2, lx, ly, lz,
                                    load(light[3], at), l_v);
    }
    for (int i = 0; i < n; ++i) {
        V weight[C], target[C], factor;
        for (int c = 0; c < C; ++c) {
            const auto index = static_cast<std::size_t>((first + i) * C + c);
            weight[c] = load(s.weight[index], at);
            target[c] = load(s.target[index], at);
        }
        residuals_of<C>(weight, target, p.diffuse, block.terms[i].matt,
                        hn::Mul(p.specular, block.terms[i].lobe), block.square[i], block.linear[i], factor);
        multiply(product, factor);
    }
}

// Priors of the lobe and of the slope. `product`: of the residuals.
template <int C>
HWY_INLINE void add_priors(const WardSlots& s, int at, const Point<C>& point, LogProduct& product,
                           System<C>& sum) {
    const V a_weight = load(s.prior_ln_alpha_weight, at), s_weight = load(s.prior_specular_weight, at);
    const V a_off = hn::Sub(point.theta[2], load(s.prior_ln_alpha, at));
    const V s_off = hn::Sub(point.theta[3], load(s.prior_specular, at));
    sum.common[7] = hn::Add(sum.common[7], a_weight);
    sum.common[9] = hn::Add(sum.common[9], s_weight);
    sum.gradient[2] = fma(a_weight, a_off, sum.gradient[2]);
    sum.gradient[3] = fma(s_weight, s_off, sum.gradient[3]);
    sum.cost = fma(hn::Mul(a_weight, a_off), a_off, fma(hn::Mul(s_weight, s_off), s_off, logarithm(product)));
    for (int i = 0; i < 2; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const V weight = load(s.prior_slope_weight[k], at);
        const V off = hn::Sub(point.theta[i], load(s.prior_slope[k], at));
        sum.common[4 * i] = hn::Add(sum.common[4 * i], weight);
        sum.gradient[i] = fma(weight, off, sum.gradient[i]);
        sum.cost = fma(hn::Mul(weight, off), off, sum.cost);
    }
}

// In blocks, and each block in steps with few sums each: one loop over all of it would have more sums than
// there are registers, and a chain of dependent operations too long to overlap with the next photograph's.
template <int C>
HWY_NOINLINE void evaluate(const WardSlots& s, const LaneModel& reflectance_model, int at,
                           const Point<C>& point, System<C>& sum) {
    const V zero = hn::Zero(Floats());
    V channel[C][7];
    for (V& v : sum.common) v = zero;
    for (V& v : sum.gradient) v = zero;
    for (auto& row : channel)
        for (V& v : row) v = zero;
    const PointTerms<C> p = point_terms<C>(s, at, point);
    LogProduct product = empty_product();
    Block<C> block;
    for (int first = 0; first < s.photos; first += kBlock) {
        const int n = std::min(kBlock, s.photos - first);
        fill_block<C>(s, reflectance_model, at, p, first, n, block, product);
        add_common<C>(block, n, p.diffuse, p.specular, sum);
        for (int c = 0; c < C; ++c) add_channel<C>(block, n, c, channel[c], sum.gradient[4 + c]);
    }
    for (int c = 0; c < C; ++c) {
        V* h = sum.diffuse[c];
        h[0] = fma(p.diffuse[c], channel[c][0], hn::Mul(p.specular, channel[c][2]));
        h[1] = fma(p.diffuse[c], channel[c][1], hn::Mul(p.specular, channel[c][3]));
        h[2] = hn::Mul(p.specular, channel[c][4]);
        h[3] = channel[c][5];
        h[4] = channel[c][6];
    }
    add_priors<C>(s, at, point, product, sum);
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#endif
