// vector_clones.h: TP_VECTOR_CLONES before a function compiles it for AVX2 and AVX-512 too; which one runs is
// decided when the program starts. Without fused multiply-add (such files are compiled with
// -ffp-contract=off), so that every processor gives the same bits.
#pragma once

#include <type_traits>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define TP_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#define TP_HAS_VECTOR_CLONES 1
#else
#define TP_VECTOR_CLONES
#define TP_HAS_VECTOR_CLONES 0
#endif

// What such a function calls becomes part of it.
#define TP_INLINE inline __attribute__((always_inline))
#define TP_INLINE_LAMBDA __attribute__((always_inline))

namespace tangi {

// N floats that are computed with at once.
template <int N>
using FloatLanes __attribute__((vector_size(N * sizeof(float)))) = float;

// Floats that a register holds in the clone that runs here. Compilers keep vectors of more of them in memory,
// which takes up to twice as long as one of these after the other.
inline int lanes_of_clone() {
#if TP_HAS_VECTOR_CLONES
    if (__builtin_cpu_supports("avx512f")) return 16;
    if (__builtin_cpu_supports("avx2")) return 8;
#endif
    return 4;
}

// Calls body(std::integral_constant) with that number. `body` is a TP_INLINE_LAMBDA, or it is not compiled
// for the clone.
template <class Body>
TP_INLINE void with_lanes(const Body& body) {
    switch (lanes_of_clone()) {
        case 16:
            return body(std::integral_constant<int, 16>());
        case 8:
            return body(std::integral_constant<int, 8>());
        default:
            return body(std::integral_constant<int, 4>());
    }
}

}  // namespace tangi
