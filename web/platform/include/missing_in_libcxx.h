// missing_in_libcxx.h: what the rooms use of C++20's library and Emscripten 3.1.6's libc++ (LLVM 14) has not
// yet: std::bit_cast, algorithms of ranges, std::from_chars of numbers with a point. Included before every
// source of the web engine (-include), and by none.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

// NOLINTBEGIN(cert-dcl58-cpp): std is where the rooms look for them.
namespace std {

template <class To, class From>
requires(sizeof(To) == sizeof(From)) constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}

inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    const string text(first, last);
    char* end = nullptr;
    const double read = strtod(text.c_str(), &end);
    if (end == text.c_str()) return {first, errc::invalid_argument};
    value = read;
    return {first + (end - text.c_str()), errc()};
}

namespace ranges {

template <class Range, class Value>
auto find(Range&& range, const Value& value) {
    return std::find(std::begin(range), std::end(range), value);
}
template <class Range, class Test, class By = identity>
auto find_if(Range&& range, Test test, By by = {}) {
    return std::find_if(std::begin(range), std::end(range),
                        [&](const auto& item) -> bool { return std::invoke(test, std::invoke(by, item)); });
}
template <class Range, class Value, class By>
auto find(Range&& range, const Value& value, By by) {
    return std::find_if(std::begin(range), std::end(range),
                        [&](const auto& item) { return std::invoke(by, item) == value; });
}
template <class Range, class Test>
bool any_of(Range&& range, Test test) {
    return std::any_of(std::begin(range), std::end(range), std::ref(test));
}
template <class Range, class Test>
bool all_of(Range&& range, Test test) {
    return std::all_of(std::begin(range), std::end(range), std::ref(test));
}
template <class Range, class Test>
bool none_of(Range&& range, Test test) {
    return std::none_of(std::begin(range), std::end(range), std::ref(test));
}
template <class Range, class Value>
auto count(Range&& range, const Value& value) {
    return std::count(std::begin(range), std::end(range), value);
}
template <class Range, class Test>
auto count_if(Range&& range, Test test) {
    return std::count_if(std::begin(range), std::end(range), std::ref(test));
}
template <class Range, class Out>
auto copy(Range&& range, Out out) {
    return std::copy(std::begin(range), std::end(range), out);
}
template <class Range, class Value>
auto fill(Range&& range, const Value& value) {
    std::fill(std::begin(range), std::end(range), value);
    return std::end(range);
}
template <class Range>
auto max(Range&& range) {
    return *std::max_element(std::begin(range), std::end(range));
}
template <class Range, class Value>
auto lower_bound(Range&& range, const Value& value) {
    return std::lower_bound(std::begin(range), std::end(range), value);
}

// In the order of `by`, with `less` of <.
template <class Less, class By>
auto ordered(Less less, By by) {
    return [less, by](const auto& a, const auto& b) {
        return std::invoke(less, std::invoke(by, a), std::invoke(by, b));
    };
}
struct Below {
    template <class A, class B>
    bool operator()(const A& a, const B& b) const {
        return a < b;
    }
};
template <class Range, class By = identity>
auto max_element(Range&& range, Below less, By by) {
    return std::max_element(std::begin(range), std::end(range), ordered(less, by));
}
template <class Range, class By = identity>
void stable_sort(Range&& range, Below less, By by) {
    std::stable_sort(std::begin(range), std::end(range), ordered(less, by));
}

}  // namespace ranges
}  // namespace std
// NOLINTEND(cert-dcl58-cpp)
