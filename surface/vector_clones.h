// vector_clones.h: TP_VECTOR_CLONES before a function compiles it for AVX2 and AVX-512 too; which one runs is
// decided when the program starts. Without fused multiply-add (such files are compiled with
// -ffp-contract=off), so that every processor gives the same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define TP_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define TP_VECTOR_CLONES
#endif

// What such a function calls becomes part of it.
#define TP_INLINE inline __attribute__((always_inline))
