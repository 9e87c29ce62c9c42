#include "surface/math/portable_math.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

namespace tangi::portable {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// ln 2 in two parts, the first with 32 bits, so that its multiples by an exponent are exact (Cody & Waite
// 1980).
constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;
// pi / 2 in three parts of 33 bits.
constexpr double kHalfPi1 = 0x1.921fb544p0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2e037073p-69;

// std::bit_cast, which libc++ has only since 14.
std::uint64_t bits_of(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    return bits;
}
double of_bits(std::uint64_t bits) {
    double x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

double power_of_2(int n) { return of_bits(static_cast<std::uint64_t>(n + 1023) << 52); }  // -1022..1023

// The whole number nearest to |x| < 2^31.
int nearest(double x) { return static_cast<int>(x < 0 ? x - 0.5 : x + 0.5); }

template <std::size_t N>
double polynomial(const std::array<double, N>& coefficients, double x) {  // the highest first
    double sum = 0;
    for (const double c : coefficients) sum = sum * x + c;
    return sum;
}

// Taylor's series: of exp to r^13 / 13!, of sine and cosine to the 17th and 18th power.
template <std::size_t N>
constexpr std::array<double, N> series(int first, int step, bool alternates) {
    std::array<double, N> result{};
    double factorial = 1;
    int reached = 0;
    for (std::size_t i = 0; i < N; ++i) {
        for (const int power = first + static_cast<int>(i) * step; reached < power;) factorial *= ++reached;
        result[N - 1 - i] = (alternates && i % 2 ? -1 : 1) / factorial;
    }
    return result;
}
constexpr auto kExp = series<14>(0, 1, false);
constexpr auto kSine = series<9>(1, 2, true);
constexpr auto kCosine = series<10>(0, 2, true);

// Of (atanh t) / t, and with alternating signs of (atan t) / t, in powers of t^2.
template <std::size_t N>
constexpr std::array<double, N> inverse_series(bool alternates) {
    std::array<double, N> result{};
    for (std::size_t i = 0; i < N; ++i)
        result[N - 1 - i] = (alternates && i % 2 ? -1.0 : 1.0) / static_cast<double>(2 * i + 1);
    return result;
}
constexpr auto kAtanh = inverse_series<12>(false);  // |t| <= 0.172
constexpr auto kAtan = inverse_series<21>(true);    // |t| <= 0.415

struct Reduced {
    int quarter;  // of a turn, 0..3
    double rest;  // [rad] within a quarter of pi
};
Reduced reduced(double x) {
    const int n = nearest(x * (2 / std::numbers::pi));
    return {n & 3, ((x - n * kHalfPi1) - n * kHalfPi2) - n * kHalfPi3};
}
double near_sine(double r) { return r * polynomial(kSine, r * r); }
double near_cosine(double r) { return polynomial(kCosine, r * r); }

double atan_up_to_1(double t) {  // t in [0, 1]
    if (t <= 0.4142135623730951) return t * polynomial(kAtan, t * t);
    const double turned = (t - 1) / (t + 1);
    return std::numbers::pi / 4 + turned * polynomial(kAtan, turned * turned);
}

}  // namespace

double exp(double x) {
    if (x != x) return x;
    if (x > 709.782712893384) return kInfinity;
    if (x < -745.2) return 0;
    const int n = nearest(x * (1 / std::numbers::ln2));
    const double r = (x - n * kLn2High) - n * kLn2Low;
    // In two steps, since powers at both ends are no normal numbers.
    const int half = n / 2;
    return polynomial(kExp, r) * power_of_2(half) * power_of_2(n - half);
}

double log(double x) {
    if (x != x || x < 0) return kNaN;
    if (x == 0) return -kInfinity;
    if (x == kInfinity) return x;
    int exponent = 0;
    if (x < std::numeric_limits<double>::min()) {
        x *= 0x1p54;
        exponent = -54;
    }
    // x = m 2^exponent, m from 1 / sqrt 2 to sqrt 2.
    constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd;
    const std::uint64_t shifted = bits_of(x) - kRootHalf;
    const int n = static_cast<int>(static_cast<std::int64_t>(shifted) >> 52);
    const double m = of_bits(bits_of(x) - (static_cast<std::uint64_t>(n) << 52));
    exponent += n;
    const double t = (m - 1) / (m + 1);
    return exponent * kLn2High + (2 * t * polynomial(kAtanh, t * t) + exponent * kLn2Low);
}

double log1p(double x) {
    const double sum = 1 + x;
    if (sum == 1) return x;
    // What was lost in the sum is made up for (Hewlett-Packard HP-15C, by Kahan).
    return sum == kInfinity ? sum : log(sum) * x / (sum - 1);
}

double expm1(double x) {
    const double power = exp(x);
    if (power == 1) return x;
    const double rest = power - 1;
    return rest == -1 || power == kInfinity ? rest : rest * x / log(power);  // as in log1p()
}

double pow(double x, double y) {
    if (y == 0 || x == 1) return 1;
    if (y == 1) return x;
    if (x == 0) return y > 0 ? 0 : kInfinity;
    return exp(y * log(x));
}

double cbrt(double x) {
    if (x == 0 || x != x) return x;
    const double size = x < 0 ? -x : x;
    const double root = exp(log(size) / 3);
    const double better = root - (root * root * root - size) / (3 * root * root);  // Newton's step
    return x < 0 ? -better : better;
}

double sin(double x) {
    const Reduced r = reduced(x);
    const double value = r.quarter & 1 ? near_cosine(r.rest) : near_sine(r.rest);
    return r.quarter & 2 ? -value : value;
}

double cos(double x) {
    const Reduced r = reduced(x);
    const double value = r.quarter & 1 ? near_sine(r.rest) : near_cosine(r.rest);
    return r.quarter == 1 || r.quarter == 2 ? -value : value;
}

double atan2(double y, double x) {
    const double across = x < 0 ? -x : x, up = y < 0 ? -y : y;
    if (!(across > 0 || up > 0)) return std::signbit(x) ? std::copysign(std::numbers::pi, y) : y;
    double angle =
        up <= across ? atan_up_to_1(up / across) : std::numbers::pi / 2 - atan_up_to_1(across / up);
    if (std::signbit(x)) angle = std::numbers::pi - angle;
    return std::signbit(y) ? -angle : angle;
}

}  // namespace tangi::portable
