// three_terms.h: systems of up to three equations, for pixels that three numbers explain.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace tangi {

using Three = std::array<double, 3>;
using Small = std::array<Three, 3>;

// In place: the Cholesky factor of the leading n x n part; false where it has none.
inline bool factorise(Small& a, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = a[i][j];
            for (std::size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
            if (i == j && !(sum > 0)) return false;
            a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
        }
    return true;
}

// In place, by that factor.
inline void solve(const Small& l, std::size_t n, Three& x) {
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
}

inline double dot(const Three& a, const Three& b, std::size_t n) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += a[k] * b[k];
    return sum;
}

}  // namespace tangi
