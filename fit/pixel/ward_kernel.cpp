// ward_kernel.cpp: Levenberg-Marquardt on the lanes of vector registers: run_ward_slots().
//
// The block of the diffuse channels in J^T J is diagonal and eliminated first.
#include "fit/pixel/ward_kernel.h"

#include <algorithm>
#include <cmath>

#include "surface/base/vector_targets.h"  // before Highway

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fit/pixel/ward_kernel.cpp"
#include <hwy/foreach_target.h>

#include "fit/pixel/ward_system-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

// Position in System::common.
constexpr int kAt[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
constexpr float kTiny = 1e-10f;  // keeps a parameter that nothing depends on from dividing by 0

constexpr float kLittle = 2e-4f;  // [1] of the cost: an undamped step that lowers it by less is the last
constexpr float kFree = 0.1f;     // [1] damping up to which a step counts as undamped

// The common parameters' system once the channels are eliminated, and its factors L D L^T.
struct Factors {
    V l[4][4], d[4];
};
HWY_INLINE void factorise(V (&a)[4][4], Factors& f) {
    for (int j = 0; j < 4; ++j) {
        V d = a[j][j];
        for (int k = 0; k < j; ++k) d = fnma(hn::Mul(f.l[j][k], f.l[j][k]), f.d[k], d);
        // Rounding can leave nothing of a pivot, or less.
        f.d[j] = hn::Max(d, fma(a[j][j], all(1e-6f), all(kTiny)));
        const V inverse = hn::Div(all(1), f.d[j]);
        for (int i = j + 1; i < 4; ++i) {
            V sum = a[i][j];
            for (int k = 0; k < j; ++k) sum = fnma(hn::Mul(f.l[i][k], f.l[j][k]), f.d[k], sum);
            f.l[i][j] = hn::Mul(sum, inverse);
        }
    }
}
HWY_INLINE void back_substitute(const Factors& f, V (&x)[4]) {
    for (int i = 1; i < 4; ++i)
        for (int k = 0; k < i; ++k) x[i] = fnma(f.l[i][k], x[k], x[i]);
    for (int i = 0; i < 4; ++i) x[i] = hn::Div(x[i], f.d[i]);
    for (int i = 2; i >= 0; --i)
        for (int k = i + 1; k < 4; ++k) x[i] = fnma(f.l[k][i], x[k], x[i]);
}

template <int C>
struct Limits {
    V low[4 + C], high[4 + C];
    V enough;  // fall of the cost; less is not worth a step
    V most;    // iterations
};

// The damped step, 0 for parameters at a bound that the gradient pushes them over; returns by how much the
// quadratic model falls.
template <int C>
HWY_INLINE V step_of(const System<C>& h, const Point<C>& point, const Limits<C>& limits, V damping,
                     V (&step)[4 + C]) {
    const V zero = hn::Zero(Floats());
    V open[4 + C], gradient[4 + C];  // open: 1 where a parameter may move
    for (int i = 0; i < 4 + C; ++i) {
        const M stuck = hn::Or(hn::And(hn::Le(point.theta[i], limits.low[i]), hn::Gt(h.gradient[i], zero)),
                               hn::And(hn::Ge(point.theta[i], limits.high[i]), hn::Lt(h.gradient[i], zero)));
        open[i] = hn::IfThenZeroElse(stuck, all(1));
        gradient[i] = hn::Mul(open[i], h.gradient[i]);
    }
    const V more = hn::Add(all(1), damping);
    V a[4][4], x[4];
    for (int i = 0; i < 4; ++i) {
        x[i] = hn::Neg(gradient[i]);
        for (int j = 0; j < i; ++j) a[i][j] = hn::Mul(hn::Mul(open[i], open[j]), h.common[kAt[i][j]]);
        a[i][i] = fma(h.common[kAt[i][i]], more, all(kTiny));
    }
    V inverse[C], row[C][4];
    for (int c = 0; c < C; ++c) {
        inverse[c] = hn::Div(all(1), fma(h.diffuse[c][4], more, all(kTiny)));
        for (int i = 0; i < 4; ++i) row[c][i] = hn::Mul(hn::Mul(open[4 + c], open[i]), h.diffuse[c][i]);
        for (int i = 0; i < 4; ++i) {
            const V scaled = hn::Mul(row[c][i], inverse[c]);
            x[i] = fma(scaled, gradient[4 + c], x[i]);
            for (int j = 0; j <= i; ++j) a[i][j] = fnma(scaled, row[c][j], a[i][j]);
        }
    }
    Factors factors;
    factorise(a, factors);
    back_substitute(factors, x);
    for (int i = 0; i < 4; ++i) step[i] = hn::Mul(open[i], x[i]);
    for (int c = 0; c < C; ++c) {
        V sum = gradient[4 + c];
        for (int i = 0; i < 4; ++i) sum = fma(row[c][i], step[i], sum);
        step[4 + c] = hn::Neg(hn::Mul(sum, inverse[c]));
    }
    V falls = zero;
    for (int i = 0; i < 4 + C; ++i) {
        const V diagonal =
            i < 4 ? h.common[kAt[std::min(i, 3)][std::min(i, 3)]] : h.diffuse[std::max(i - 4, 0)][4];
        falls = fma(step[i], hn::MulSub(hn::Mul(damping, diagonal), step[i], gradient[i]), falls);
    }
    return falls;
}

// From the inverse of J^T J: the variances of the mean of both slopes, ln alpha, rho_s and the mean of the
// diffuse channels, and the covariance of ln alpha and rho_s.
template <int C>
HWY_INLINE void variances(const System<C>& h, V (&out)[5]) {
    V a[4][4];
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < i; ++j) a[i][j] = h.common[kAt[i][j]];
        a[i][i] = hn::Add(h.common[kAt[i][i]], all(kTiny));
    }
    for (int c = 0; c < C; ++c) {
        const V inverse = hn::Div(all(1), hn::Add(h.diffuse[c][4], all(kTiny)));
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j <= i; ++j)
                a[i][j] = fnma(hn::Mul(h.diffuse[c][i], inverse), h.diffuse[c][j], a[i][j]);
    }
    Factors factors;
    factorise(a, factors);
    V diagonal[4];
    for (int k = 0; k < 4; ++k) {
        V x[4] = {hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats())};
        x[k] = all(1);
        back_substitute(factors, x);
        diagonal[k] = x[k];
        if (k == 3) out[4] = x[2];
    }
    out[0] = hn::Mul(all(0.5f), hn::Add(diagonal[0], diagonal[1]));
    out[1] = diagonal[2];
    out[2] = diagonal[3];
    out[3] = hn::Zero(Floats());
    for (int c = 0; c < C; ++c) {
        const V inverse = hn::Div(all(1), hn::Add(h.diffuse[c][4], all(kTiny)));
        V x[4], sum = inverse;
        for (int i = 0; i < 4; ++i) x[i] = h.diffuse[c][i];
        back_substitute(factors, x);
        for (int i = 0; i < 4; ++i) sum = fma(hn::Mul(hn::Mul(x[i], h.diffuse[c][i]), inverse), inverse, sum);
        out[3] = fma(sum, all(1.0f / C), out[3]);
    }
}

template <int C>
HWY_INLINE void take(M accepted, const System<C>& from, System<C>& to) {
    for (int i = 0; i < 10; ++i) to.common[i] = choose(accepted, from.common[i], to.common[i]);
    for (int c = 0; c < C; ++c)
        for (int i = 0; i < 5; ++i) to.diffuse[c][i] = choose(accepted, from.diffuse[c][i], to.diffuse[c][i]);
    for (int i = 0; i < 4 + C; ++i) to.gradient[i] = choose(accepted, from.gradient[i], to.gradient[i]);
    to.cost = choose(accepted, from.cost, to.cost);
}

// How far the search of some lanes is.
struct Progressed {
    V damping, growth, iterations, converged;
    M alive;
};
HWY_INLINE Progressed progressed(const WardSlots& s, int at) {
    return {load(s.damping, at), load(s.damping_growth, at), load(s.iterations, at), load(s.converged, at),
            hn::Gt(load(s.alive, at), hn::Zero(Floats()))};
}

template <int C>
HWY_INLINE Limits<C> limits_of(const WardFitOptions& options) {
    Limits<C> limits;
    const auto scale = static_cast<float>(options.robust_scale);
    limits.enough = all(1e-3f / (scale * scale));
    limits.most = all(static_cast<float>(options.max_iterations));
    for (int i = 0; i < 4 + C; ++i) {
        const auto [low, high] = ward_interval(options.bounds, i);
        limits.low[i] = all(static_cast<float>(low));
        limits.high[i] = all(static_cast<float>(high));
    }
    return limits;
}

// Nielsen's factor 1 - (2 rho - 1)^3 of an accepted step; a growing one of a rejected step.
HWY_INLINE void damp(M better, M worse, V change, V falls, Progressed& search) {
    const V one = all(1), damping = search.damping, growth = search.growth;
    const V rho = hn::Min(hn::Div(change, hn::Max(falls, all(1e-20f))), all(2));
    const V t = hn::Sub(hn::Add(rho, rho), one);
    const V eased =
        hn::Max(hn::Mul(damping, hn::Max(all(1.0f / 3), fnma(hn::Mul(t, t), t, one))), all(1e-7f));
    search.damping = choose(better, eased, choose(worse, hn::Mul(damping, growth), damping));
    search.growth = choose(better, all(2), choose(worse, hn::Add(growth, growth), growth));
}

// One step of the lanes that are alive; false where none is left before it. Nielsen's damping (Madsen,
// Nielsen & Tingleff 2004, "Methods for non-linear least squares problems", algorithm 3.16), as TinySolver
// has it.
template <int C>
HWY_INLINE bool take_step(const WardSlots& s, const LaneModel& reflectance_model, const Limits<C>& limits,
                          int at, Point<C>& point, System<C>& system, Progressed& search) {
    const Floats d;
    const V zero = hn::Zero(d), one = all(1);
    const V enough = limits.enough;
    V step[4 + C];
    const V falls = step_of<C>(system, point, limits, search.damping, step);
    // NaN counts as done: such lanes are never converged.
    const M done = hn::AndNot(hn::Gt(falls, enough), search.alive);
    search.converged = choose(hn::And(done, hn::Ge(falls, zero)), one, search.converged);
    search.alive = hn::AndNot(done, search.alive);
    if (hn::AllFalse(d, search.alive)) return false;
    Point<C> next;
    for (int i = 0; i < 4 + C; ++i)
        next.theta[i] = hn::Min(hn::Max(hn::Add(point.theta[i], step[i]), limits.low[i]), limits.high[i]);
    System<C> trial;
    evaluate<C>(s, reflectance_model, at, next, trial);
    const V change = hn::Sub(system.cost, trial.cost);
    const M free = hn::Le(search.damping, all(kFree));
    const M better = hn::And(search.alive, hn::Gt(change, zero)), worse = hn::AndNot(better, search.alive);
    damp(better, worse, change, falls, search);
    search.iterations = hn::Add(search.iterations, keep(search.alive, one));
    for (int i = 0; i < 4 + C; ++i) point.theta[i] = choose(better, next.theta[i], point.theta[i]);
    take<C>(better, trial, system);
    // Where the damping is low, a small fall is that of a step which nears the minimum.
    const V little = choose(free, hn::Max(hn::Mul(all(kLittle), system.cost), enough), enough);
    const M small = hn::And(better, hn::Lt(change, little));
    const M stuck = hn::And(worse, hn::Gt(search.damping, all(1e8f)));
    search.converged = choose(hn::Or(small, stuck), one, search.converged);
    const M spent = hn::Ge(search.iterations, limits.most);
    search.alive = hn::AndNot(hn::Or(hn::Or(small, stuck), spent), search.alive);
    return true;
}

// What is left of a search, for the next call and for who reads the results.
template <int C>
HWY_INLINE void leave(const Point<C>& point, System<C>& system, const Progressed& search, int at,
                      WardSlots& s) {
    const V one = all(1);
    for (int i = 0; i < 4 + C; ++i) store(point.theta[i], s.theta[static_cast<std::size_t>(i)], at);
    each<C>(system, [&](V& v, int k) HWY_ATTR { store(v, s.system[static_cast<std::size_t>(k)], at); });
    store(one, s.resumed, at);
    V variance[5];
    variances<C>(system, variance);
    store(search.damping, s.damping, at);
    store(search.growth, s.damping_growth, at);
    store(search.iterations, s.iterations, at);
    store(search.converged, s.converged, at);
    store(keep(search.alive, one), s.alive, at);
    store(system.cost, s.cost, at);
    store(variance[0], s.slope_variance, at);
    store(variance[1], s.ln_alpha_variance, at);
    store(variance[2], s.specular_variance, at);
    store(variance[3], s.diffuse_variance, at);
    store(variance[4], s.lobe_covariance, at);
}

// One register's worth of lanes from `at` on.
template <int C>
HWY_INLINE void run(WardSlots& s, const WardFitOptions& options, int at, int fewest) {
    const Floats d;
    Point<C> point;
    for (int i = 0; i < 4 + C; ++i) point.theta[i] = load(s.theta[static_cast<std::size_t>(i)], at);
    Progressed search = progressed(s, at);
    const Limits<C> limits = limits_of<C>(options);
    const LaneModel reflectance_model = reflectance_model_of(options.reflectance_model);
    System<C> system;
    const bool fresh = hn::AllTrue(d, hn::Eq(load(s.resumed, at), hn::Zero(d)));
    if (fresh)
        evaluate<C>(s, reflectance_model, at, point, system);
    else
        each<C>(system, [&](V& v, int k) HWY_ATTR { v = load(s.system[static_cast<std::size_t>(k)], at); });
    while (!hn::AllFalse(d, search.alive) && static_cast<int>(hn::CountTrue(d, search.alive)) >= fewest)
        if (!take_step<C>(s, reflectance_model, limits, at, point, system, search)) break;
    leave<C>(point, system, search, at, s);
}

void RunSlots(WardSlots& slots, const WardFitOptions& options, int fewest) {
    const int lanes = static_cast<int>(hn::Lanes(Floats()));
    for (int at = 0; at < kWardLanes; at += lanes) {
        // Of 16 lanes; narrower registers stop at their part of it.
        const int part = (fewest * lanes + kWardLanes - 1) / kWardLanes;
        if (slots.channels == 3)
            run<3>(slots, options, at, part);
        else
            run<1>(slots, options, at, part);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tangi {

HWY_EXPORT(RunSlots);

void run_ward_slots(WardSlots& slots, const WardFitOptions& options, int fewest) {
    HWY_DYNAMIC_DISPATCH(RunSlots)(slots, options, fewest);
}

}  // namespace tangi
#endif
