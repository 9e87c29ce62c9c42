// simd_math-inl.h: exponentials, logarithms and roots on the lanes of vector registers, the same bits for
// every instruction set. Included once for each by sources with Google Highway's foreach_target.
#if defined(TANGI_SIMD_MATH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANGI_SIMD_MATH_INL_H
#undef TANGI_SIMD_MATH_INL_H
#else
#define TANGI_SIMD_MATH_INL_H
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "surface/base/vector_targets.h"

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kVectorLanes>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

HWY_INLINE V all(float value) { return hn::Set(Floats(), value); }
HWY_INLINE V fma(V a, V b, V c) { return hn::MulAdd(a, b, c); }      // a b + c
HWY_INLINE V fnma(V a, V b, V c) { return hn::NegMulAdd(a, b, c); }  // c - a b
HWY_INLINE V keep(M m, V v) { return hn::IfThenElseZero(m, v); }
HWY_INLINE V choose(M m, V yes, V no) { return hn::IfThenElse(m, yes, no); }

// exp(x) for x <= 0, within 3e-7 of it; 0 below -36, where squares would no longer be normal numbers. Cody &
// Waite's reduction by multiples of ln 2, then Taylor's series on [-0.35, 0.35].
HWY_INLINE V exp_negative(V x) {
    const V n = hn::Round(hn::Mul(x, all(1.44269504f)));
    V r = fnma(n, all(0.693145752f), x);
    r = fnma(n, all(1.42860677e-6f), r);
    V p = all(1.0f / 720);
    p = fma(p, r, all(1.0f / 120));
    p = fma(p, r, all(1.0f / 24));
    p = fma(p, r, all(1.0f / 6));
    p = fma(p, r, all(0.5f));
    p = fma(p, r, all(1));
    p = fma(p, r, all(1));
    const auto exponent = hn::ShiftLeft<23>(hn::ConvertTo(Ints(), n));
    const V value = hn::BitCast(Floats(), hn::Add(hn::BitCast(Ints(), p), exponent));
    return keep(hn::Gt(x, all(-36.0f)), value);
}

// Of numbers from 0 to 1; 0 below exp(-36), as exp_negative().
HWY_INLINE V squared(V x) { return keep(hn::Gt(x, all(1.5230e-8f)), hn::Mul(x, x)); }

// 1 / sqrt(x) for normal x > 0, within 3e-7 of it: an estimate from the bits of x, then Newton's steps (the
// processors' own estimates differ from one to another).
HWY_INLINE V inverse_root(V x) {
    const auto bits = hn::Sub(hn::Set(Ints(), 0x5f375a86), hn::ShiftRight<1>(hn::BitCast(Ints(), x)));
    V y = hn::BitCast(Floats(), bits);
    const V half = hn::Mul(x, all(0.5f));
    for (int i = 0; i < 3; ++i) y = hn::Mul(y, fnma(hn::Mul(half, y), y, all(1.5f)));
    return y;
}

// ln(x) for normal x >= 1, within 3e-7 of ln(x) + 1: the series of atanh on [1/sqrt 2, sqrt 2].
HWY_INLINE V log_of(V x) {
    const auto bits = hn::BitCast(Ints(), x);
    const auto shifted = hn::Sub(bits, hn::Set(Ints(), 0x3f3504f3));
    const auto exponent = hn::ShiftRight<23>(shifted);
    const V m = hn::BitCast(Floats(), hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
    const V t = hn::Div(hn::Sub(m, all(1)), hn::Add(m, all(1)));
    const V t2 = hn::Mul(t, t);
    V p = all(2.0f / 9);
    p = fma(p, t2, all(2.0f / 7));
    p = fma(p, t2, all(2.0f / 5));
    p = fma(p, t2, all(2.0f / 3));
    p = fma(p, t2, all(2));
    return fma(hn::ConvertTo(Floats(), exponent), all(0.693147181f), hn::Mul(p, t));
}

// Product of many factors from 1 to 1e36, without overflow; its logarithm.
struct LogProduct {
    V mantissa;  // in [1, 2)
    hn::Vec<Ints> exponent;
};
HWY_INLINE LogProduct empty_product() { return {all(1), hn::Zero(Ints())}; }
HWY_INLINE void multiply(LogProduct& product, V factor) {
    const auto bits = hn::BitCast(Ints(), hn::Mul(product.mantissa, factor));
    product.exponent = hn::Add(product.exponent, hn::Sub(hn::ShiftRight<23>(bits), hn::Set(Ints(), 127)));
    product.mantissa =
        hn::BitCast(Floats(), hn::Or(hn::And(bits, hn::Set(Ints(), 0x7fffff)), hn::Set(Ints(), 0x3f800000)));
}
HWY_INLINE V logarithm(const LogProduct& product) {
    return fma(hn::ConvertTo(Floats(), product.exponent), all(0.693147181f), log_of(product.mantissa));
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#endif
