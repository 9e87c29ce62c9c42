// portable_math.h: elementary functions that give the same bits on every processor, compiler and C library.
//
// A journal must paint the same layers in the window and in a browser, and C libraries differ in the last
// bits of exp, pow or sin: between glibc and musl, and within glibc between processors with and without fused
// multiply-add. What changes paint or supports calls these instead. They use +, -, *, / and sqrt only, which
// IEEE 754 defines exactly, and are compiled without fused operations (cmake/Compiler.cmake).
//
// Each is within 4 units in the last place of a double for results that are normal numbers; sine and cosine
// for arguments up to 1e5. Those of float round what they get in double.
#pragma once

#include <cmath>

namespace tangi::portable {

double exp(double x);
double log(double x);            // -infinity at 0, NaN below
double log1p(double x);          // ln(1 + x), exact for small x
double expm1(double x);          // exp(x) - 1, exact for small x
double pow(double x, double y);  // x >= 0
double cbrt(double x);
double sin(double x);
double cos(double x);
double atan2(double y, double x);  // in [-pi, pi]
inline double hypot(double x, double y) { return std::sqrt(x * x + y * y); }

inline float exp(float x) { return static_cast<float>(exp(static_cast<double>(x))); }
inline float log(float x) { return static_cast<float>(log(static_cast<double>(x))); }
inline float log1p(float x) { return static_cast<float>(log1p(static_cast<double>(x))); }
inline float expm1(float x) { return static_cast<float>(expm1(static_cast<double>(x))); }
inline float pow(float x, float y) {
    return static_cast<float>(pow(static_cast<double>(x), static_cast<double>(y)));
}
inline float cbrt(float x) { return static_cast<float>(cbrt(static_cast<double>(x))); }
inline float sin(float x) { return static_cast<float>(sin(static_cast<double>(x))); }
inline float cos(float x) { return static_cast<float>(cos(static_cast<double>(x))); }
inline float atan2(float y, float x) {
    return static_cast<float>(atan2(static_cast<double>(y), static_cast<double>(x)));
}
inline float hypot(float x, float y) {
    return static_cast<float>(hypot(static_cast<double>(x), static_cast<double>(y)));
}

}  // namespace tangi::portable
