// exp_lanes.h: exponentials in loops that are to become vector instructions.
#pragma once

#include <bit>

#include "surface/base/vector_clones.h"

namespace tangi {

TP_INLINE float smaller(float a, float b) { return a < b ? a : b; }
TP_INLINE float larger(float a, float b) { return a > b ? a : b; }

// exp(x) - 1 to rounding, for 0 <= x <= 60.
TP_INLINE float expm1_of(float x) {
    const float halves = x * 1.44269504f + 0.5f;  // x is not negative: cutting off rounds
    const int n = static_cast<int>(halves);
    const float whole = static_cast<float>(n);
    const float r = (x - whole * 0.693359375f) + whole * 2.12194440e-4f;
    const float tail =
        0.5f + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r * (1.0f / 5040)))));
    const float power = std::bit_cast<float>((n + 127) << 23);
    return power * (r + r * r * tail) + (power - 1);
}

}  // namespace tangi
