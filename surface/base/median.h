// median.h: the median of a list.
#pragma once

#include <algorithm>
#include <vector>

namespace tangi {

// The upper of the two in the middle where the number is even; 0 of nothing.
template <class T>
T median(std::vector<T> values) {
    if (values.empty()) return T(0);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace tangi
