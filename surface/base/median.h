// median.h: the median of a list, and other quantiles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace tangi {

// The value that one of `parts` of the others are below; 0 of nothing.
template <class T>
T quantile_of(std::vector<T> values, std::size_t parts) {
    if (values.empty()) return T(0);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / parts);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// The upper of the two in the middle where the number is even.
template <class T>
T median(std::vector<T> values) {
    return quantile_of(std::move(values), 2);
}

}  // namespace tangi
