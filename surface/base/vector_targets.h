// vector_targets.h: for which instruction sets code written with Highway is compiled; before any header of
// it.
#pragma once

#ifdef __SANITIZE_ADDRESS__
// One besides the baseline: the source is the same, and each takes a minute to compile with the sanitizers.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)
#else
// Sets between these give no speed that is worth compiling them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#endif

namespace tangi {

constexpr int kVectorLanes = 16;  // floats of the widest registers

}  // namespace tangi
