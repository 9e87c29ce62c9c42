// options.h: one list of fields per options struct, from which flags, help, validation and JSON are derived.
//
// An options struct is an aggregate with a default for every field, plus
//     static constexpr std::string_view name = "ward_fit";
//     template <class Self, class Visit> static void fields(Self& self, Visit&& visit) {
//         visit(FieldInfo{"max_iterations", 1, 1000, "1", "Levenberg-Marquardt steps"}, self.max_iterations);
//     }
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <type_traits>

#include "surface/base/error.h"

namespace tangi {

struct FieldInfo {
    std::string_view name;  // as in the struct; the flag is the same with '-' for '_'
    double minimum = 0;     // smallest and largest value allowed; ignored for flags (bool)
    double maximum = 1;
    std::string_view unit;  // "mm", "deg", "1" for ratios and counts
    std::string_view help;
};

template <class T>
struct is_optional : std::false_type {};
template <class T>
struct is_optional<std::optional<T>> : std::true_type {};

// Throws Error naming the first field outside its interval. NaN is outside every interval.
template <class Options>
void validate(const Options& options) {
    Options::fields(options, [](const FieldInfo& info, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        const auto check = [&](auto v) {
            const double x = static_cast<double>(v);
            if (!(x >= info.minimum && x <= info.maximum))
                fail("{}.{} = {} is outside [{}, {}]{}{}", Options::name, info.name, v, info.minimum,
                     info.maximum, info.unit.empty() || info.unit == "1" ? "" : " ",
                     info.unit == "1" ? std::string_view() : info.unit);
        };
        if constexpr (is_optional<T>::value) {
            if (value) check(*value);
        } else if constexpr (std::is_arithmetic_v<T> && !std::same_as<T, bool>) {
            check(value);
        }
    });
}

// The options as JSON, for provenance. Optional fields that are not set are null.
template <class Options>
nlohmann::json to_json(const Options& options) {
    nlohmann::json result = nlohmann::json::object();
    Options::fields(options, [&](const FieldInfo& info, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        auto& slot = result[std::string(info.name)];
        if constexpr (is_optional<T>::value) {
            if (value) slot = *value;
        } else {
            slot = value;
        }
    });
    return result;
}

}  // namespace tangi
