// ward_targets.h: for which instruction sets the vector code of the fit is compiled; before any header of
// Highway.
#pragma once

// Sets between these give no speed that is worth compiling them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
