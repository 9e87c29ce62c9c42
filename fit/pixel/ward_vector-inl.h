// ward_vector-inl.h: the model of ward_residual.h on the lanes of vector registers. Included once for each
// instruction set by ward_kernel.cpp (Google Highway's foreach_target).
#if defined(TANGI_WARD_VECTOR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANGI_WARD_VECTOR_INL_H
#undef TANGI_WARD_VECTOR_INL_H
#else
#define TANGI_WARD_VECTOR_INL_H
#endif

#include <hwy/highway.h>

#include <numbers>

#include "fit/pixel/ward_batch.h"
#include "surface/base/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

HWY_INLINE V load(const WardLane& lane, int at) { return hn::Load(Floats(), lane.data() + at); }
HWY_INLINE void store(V v, WardLane& lane, int at) { hn::Store(v, Floats(), lane.data() + at); }

// What a slope and a view mean, before any light.
struct Facing {
    V p, q;
    V length2, inverse;        // of (-p, -q, 1): squared, 1 / length
    V view_x, view_y, view_n;  // view_n: v . (-p, -q, 1)
    V view_z;
};
HWY_INLINE Facing facing(V p, V q, V vx, V vy, V vz) {
    const V length2 = fma(p, p, fma(q, q, all(1)));
    return {p, q, length2, hn::Div(all(1), hn::Sqrt(length2)), vx, vy, fnma(p, vx, fnma(q, vy, vz)), vz};
}

// Where light is: both cosines, and the lobe but for its Gaussian.
struct Geometry {
    M lit;               // light, viewer and half vector are above the surface
    V n_l;               // 0 where not lit
    V h_n, inverse_h_n;  // h . n, not 0
    V tan2;              // of the angle between h and n
    V shape;             // h.h / (h.n)^4
    V ratio;             // h.h / (h.n)^2
};
HWY_INLINE Geometry geometry(const Facing& f, V lx, V ly, V lz, V h_h) {
    const V along = fnma(f.p, lx, fnma(f.q, ly, lz));
    const V half = hn::Add(along, f.view_n);
    const V zero = hn::Zero(Floats());
    Geometry g;
    g.lit = hn::And(hn::Gt(along, zero), hn::And(hn::Gt(half, all(1e-4f)), hn::Gt(f.view_n, zero)));
    g.n_l = keep(g.lit, hn::Mul(along, f.inverse));
    g.h_n = hn::Mul(choose(g.lit, half, all(1)), f.inverse);
    g.inverse_h_n = hn::Div(all(1), g.h_n);
    const V inverse2 = hn::Mul(g.inverse_h_n, g.inverse_h_n);
    g.ratio = hn::Mul(h_h, inverse2);
    g.tan2 = hn::Max(hn::Sub(g.ratio, all(1)), zero);
    g.shape = hn::Mul(g.ratio, inverse2);
    return g;
}

// How lobes are anisotropic (surface/reflectance/anisotropy.h), and the frame of the tangent plane. Lanes
// without a stretch come to the same bits whether others have one or not.
struct Shape {
    bool some;  // a lane has a stretch
    V c, a, b;
    V nx, ny, over_z;  // of the normal; 1 / (1 + n.z)
};
HWY_INLINE Shape shape_at(const WardSlots& s, int at, const Facing& f) {
    const V a = load(s.shape[1], at), b = load(s.shape[2], at), zero = hn::Zero(Floats());
    const bool some = !hn::AllTrue(Floats(), hn::And(hn::Eq(a, zero), hn::Eq(b, zero)));
    return {some,
            load(s.shape[0], at),
            a,
            b,
            hn::Neg(hn::Mul(f.p, f.inverse)),
            hn::Neg(hn::Mul(f.q, f.inverse)),
            hn::Div(all(1), hn::Add(all(1), f.inverse))};
}

// h in the axes of the tangent plane, and what that takes off c tan2 (AnisotropicTerms of ward_residual.h).
struct StretchedHalfVector {
    V u, x, y, inverse_h_n2, part;
};
HWY_INLINE StretchedHalfVector stretch_half_vector(const Shape& shape, const Facing& f, V lx, V ly, V lz,
                                                   Geometry& g) {
    StretchedHalfVector d;
    d.u = hn::Mul(hn::Add(g.h_n, hn::Add(lz, f.view_z)), shape.over_z);
    d.x = fnma(shape.nx, d.u, hn::Add(lx, f.view_x));
    d.y = fnma(shape.ny, d.u, hn::Add(ly, f.view_y));
    d.inverse_h_n2 = hn::Mul(g.inverse_h_n, g.inverse_h_n);
    const V difference = hn::Mul(hn::Sub(d.x, d.y), hn::Add(d.x, d.y)), half = hn::Mul(d.x, d.y);
    d.part = hn::Mul(fma(shape.a, difference, hn::Mul(shape.b, hn::Add(half, half))), d.inverse_h_n2);
    g.tan2 = hn::Max(hn::MulSub(shape.c, g.tan2, d.part), hn::Zero(Floats()));
    return d;
}
// d part by slope x (i = 0) or y, given that of h.n.
HWY_INLINE V stretch_derivative(const Shape& shape, const Facing& f, const Geometry& g,
                                const StretchedHalfVector& d, int i, V dh_n) {
    const V across = hn::Mul(hn::Mul(shape.nx, shape.ny), f.inverse);
    const V n = i == 0 ? shape.nx : shape.ny;
    const V along = hn::Mul(hn::MulSub(n, n, all(1)), f.inverse);
    const V dn_x = i == 0 ? along : across, dn_y = i == 0 ? across : along;
    const V dn_z = hn::Mul(hn::Mul(f.inverse, f.inverse), n);
    const V du = hn::Mul(fnma(d.u, dn_z, dh_n), shape.over_z);
    const V dx = hn::Neg(fma(dn_x, d.u, hn::Mul(shape.nx, du)));
    const V dy = hn::Neg(fma(dn_y, d.u, hn::Mul(shape.ny, du)));
    const V sum =
        fma(shape.a, hn::MulSub(d.x, dx, hn::Mul(d.y, dy)), hn::Mul(shape.b, fma(d.x, dy, hn::Mul(d.y, dx))));
    return hn::Mul(all(2), hn::MulSub(sum, d.inverse_h_n2, hn::Mul(hn::Mul(d.part, g.inverse_h_n), dh_n)));
}

// The reflectance model of surface/reflectance/ward.h on all lanes.
struct LaneModel {
    bool rough, has_second_lobe;
    V roughness, scale;          // of the diffuse reflection, as rough_diffuse() has them
    V core, second_lobe_weight;  // parts of the lobe
};
HWY_INLINE LaneModel reflectance_model_of(const ReflectanceModel& reflectance_model) {
    const auto roughness = static_cast<float>(reflectance_model.diffuse_roughness),
               second_lobe_weight = static_cast<float>(reflectance_model.second_lobe_weight);
    const float scale = 1 / (1 + (0.5f - 2 / (3 * std::numbers::pi_v<float>)) * roughness);
    return {roughness > 0, second_lobe_weight > 0,      all(roughness),
            all(scale),    all(1 - second_lobe_weight), all(second_lobe_weight)};
}

// rough_diffuse() of surface/reflectance/oren_nayar.h; of any use only where the light is above the surface.
struct Diffuse {
    V value, by_n_l, by_n_v;
};
HWY_INLINE Diffuse rough_diffuse(const LaneModel& reflectance_model, V n_l, V n_v, V l_v) {
    const V zero = hn::Zero(Floats()), one = all(1);
    const V s = fnma(n_l, n_v, l_v);
    const M above = hn::Gt(s, zero), steep = hn::Gt(n_l, n_v);
    const V inverse = hn::Div(one, hn::Max(hn::Max(n_l, n_v), all(1e-3f)));
    const V falls = hn::Neg(hn::Mul(hn::Mul(l_v, inverse), inverse));
    const V ratio = choose(above, hn::Mul(s, inverse), s);
    const V by_n_l = choose(above, choose(steep, falls, all(-1)), hn::Neg(n_v));
    const V by_n_v = choose(above, choose(steep, all(-1), falls), hn::Neg(n_l));
    const V rough_n_l = hn::Mul(reflectance_model.roughness, n_l);
    return {hn::Mul(hn::Mul(n_l, reflectance_model.scale), fma(reflectance_model.roughness, ratio, one)),
            hn::Mul(reflectance_model.scale,
                    fma(reflectance_model.roughness, ratio, fma(rough_n_l, by_n_l, one))),
            hn::Mul(hn::Mul(reflectance_model.scale, rough_n_l), by_n_v)};
}

// The Gaussians of lobe and second lobe times their parts, before `shape`. The second lobe is twice as wide,
// so that its exponential is the fourth root of the core's.
static_assert(kSecondLobeWidth == 2);
struct Gaussians {
    V core, second_lobe_weight;  // second lobe: of any use only where there is some
};
HWY_INLINE Gaussians gaussians(const LaneModel& reflectance_model, V tan2, V inverse_alpha2) {
    const V exponent = hn::Neg(hn::Mul(tan2, inverse_alpha2));
    if (!reflectance_model.has_second_lobe)
        return {hn::Mul(exp_negative(exponent), inverse_alpha2), inverse_alpha2};
    const V root = exp_negative(hn::Mul(exponent, all(0.25f)));
    return {
        hn::Mul(hn::Mul(squared(squared(root)), inverse_alpha2), reflectance_model.core),
        hn::Mul(hn::Mul(root, hn::Mul(inverse_alpha2, all(0.25f))), reflectance_model.second_lobe_weight)};
}

// ward_terms() of ward_residual.h: the model but for rho_d and rho_s, and its derivatives by slope x, slope y
// and (the lobe only) ln alpha.
struct Terms {
    V matt, lobe;
    V dmatt[2], dlobe[3];
};
HWY_INLINE Terms ward_terms(const LaneModel& reflectance_model, const Facing& f, const Shape& shape,
                            V inverse_alpha2, V lx, V ly, V lz, V ambient, V l_v) {
    Geometry g = geometry(f, lx, ly, lz, fma(l_v, all(2), all(2)));
    V ratio2 = hn::Add(g.ratio, g.ratio);
    StretchedHalfVector anisotropic;
    if (shape.some) {
        anisotropic = stretch_half_vector(shape, f, lx, ly, lz, g);
        ratio2 = hn::Mul(ratio2, shape.c);
    }
    const Gaussians gauss = gaussians(reflectance_model, g.tan2, inverse_alpha2);
    V lobe = hn::Mul(gauss.core, g.shape);
    V by_h_n = hn::Mul(lobe, hn::MulSub(ratio2, inverse_alpha2, all(4)));
    V by_ln_alpha = hn::Mul(lobe, hn::MulSub(g.tan2, inverse_alpha2, all(1)));
    V by_tan2 = hn::Mul(lobe, inverse_alpha2);  // less than 0: its absolute value
    if (reflectance_model.has_second_lobe) {
        const V wide = hn::Mul(gauss.second_lobe_weight, g.shape),
                inverse_width2 = hn::Mul(inverse_alpha2, all(0.25f));
        lobe = hn::Add(lobe, wide);
        by_tan2 = fma(wide, inverse_width2, by_tan2);
        by_h_n = fma(wide, hn::MulSub(ratio2, inverse_width2, all(4)), by_h_n);
        by_ln_alpha = fma(wide, hn::MulSub(g.tan2, inverse_width2, all(1)), by_ln_alpha);
    }
    const V weighted = hn::Mul(hn::Mul(by_h_n, g.inverse_h_n), g.n_l);
    const V inverse = keep(g.lit, f.inverse), inverse2 = hn::Mul(f.inverse, f.inverse);
    const V slope[2] = {hn::Mul(f.p, inverse2), hn::Mul(f.q, inverse2)};
    const V lateral[2] = {lx, ly}, half[2] = {hn::Add(lx, f.view_x), hn::Add(ly, f.view_y)};
    Terms t;
    t.lobe = hn::Mul(lobe, g.n_l);
    for (int i = 0; i < 2; ++i) {
        t.dmatt[i] = hn::Neg(fma(lateral[i], inverse, hn::Mul(g.n_l, slope[i])));
        const V dh_n = hn::Neg(fma(half[i], f.inverse, hn::Mul(g.h_n, slope[i])));
        t.dlobe[i] = fma(weighted, dh_n, hn::Mul(lobe, t.dmatt[i]));
        if (shape.some)
            t.dlobe[i] = fma(hn::Mul(by_tan2, g.n_l), stretch_derivative(shape, f, g, anisotropic, i, dh_n),
                             t.dlobe[i]);
    }
    t.matt = hn::Add(g.n_l, ambient);
    if (reflectance_model.rough) {
        const Diffuse d = rough_diffuse(reflectance_model, g.n_l, hn::Mul(f.view_n, f.inverse), l_v);
        t.matt = hn::Add(keep(g.lit, d.value), ambient);
        for (int i = 0; i < 2; ++i) {
            const V dn_v = hn::Neg(fma(i == 0 ? f.view_x : f.view_y, f.inverse,
                                       hn::Mul(hn::Mul(f.view_n, f.inverse), slope[i])));
            t.dmatt[i] = keep(g.lit, fma(d.by_n_l, t.dmatt[i], hn::Mul(d.by_n_v, dn_v)));
        }
    }
    t.dlobe[2] = hn::Mul(hn::Add(by_ln_alpha, by_ln_alpha), g.n_l);
    return t;
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#endif
