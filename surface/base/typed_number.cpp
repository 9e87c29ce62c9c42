#include "surface/base/typed_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "surface/base/words.h"

namespace tangi {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// The typographic minus, U+2212, and blanks that programs write between thousands: no-break, thin, and both.
constexpr std::string_view kMinus = "\xe2\x88\x92";
constexpr std::array<std::string_view, 3> kBlanks = {"\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf"};

std::string in_plain_signs(std::string_view text) {
    std::string plain(text);
    for (const std::string_view blank : kBlanks)
        for (std::size_t at = 0; (at = plain.find(blank, at)) != std::string::npos;)
            plain.replace(at, blank.size(), " ");
    plain = without_blanks(plain);
    if (plain.starts_with(kMinus)) plain.replace(0, kMinus.size(), "-");
    return plain;
}

// "mm2" and "mm²" are one unit.
std::string unit_in_plain_signs(std::string_view unit) {
    constexpr std::string_view kSquared = "\xc2\xb2";
    std::string plain(without_blanks(unit));
    if (plain.ends_with(kSquared)) plain.replace(plain.size() - kSquared.size(), kSquared.size(), "2");
    return plain;
}

// Sign, digits with marks between them, exponent: how many characters of `text` look like a number.
std::size_t length_of_number(std::string_view text) {
    std::size_t i = 0;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    const std::size_t digits = i;
    const auto is_part = [&](std::size_t at) {
        if (text[at] == ' ') return at > digits && at + 1 < text.size() && is_digit(text[at + 1]);
        return is_digit(text[at]) || text[at] == '.' || text[at] == ',' || (text[at] == '\'' && at > digits);
    };
    while (i < text.size() && is_part(i)) ++i;
    if (std::none_of(text.begin() + static_cast<std::ptrdiff_t>(digits),
                     text.begin() + static_cast<std::ptrdiff_t>(i), is_digit))
        return 0;
    std::size_t e = i;
    if (e < text.size() && (text[e] == 'e' || text[e] == 'E')) {
        ++e;
        if (e < text.size() && (text[e] == '-' || text[e] == '+')) ++e;
        const std::size_t from = e;
        while (e < text.size() && is_digit(text[e])) ++e;
        if (e > from) i = e;
    }
    return i;
}

constexpr std::string_view kMarks = ".,' ";

// Digits in groups of three, the first one of one to three and beginning with no 0, each `mark` between two:
// how thousands are written (ISO 80000-1, 7.3.1, but for its mark, which is a space).
bool is_in_thousands(std::string_view digits, char mark) {
    if (!digits.empty() && (digits.front() == '-' || digits.front() == '+')) digits.remove_prefix(1);
    const std::size_t first = digits.find(mark);
    if (first == std::string_view::npos || first < 1 || first > 3 || digits.front() == '0') return false;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        const bool at_mark = i >= first && (i - first) % 4 == 0;
        if (at_mark ? digits[i] != mark : !is_digit(digits[i])) return false;
    }
    return (digits.size() - first) % 4 == 0;
}

// With no marks between thousands and a decimal point; empty where its marks are at no such places.
std::string without_thousands(std::string_view number) {
    const auto first = number.find_first_of(kMarks), last = number.find_last_of(kMarks);
    if (first == std::string_view::npos) return {};
    const char mark = number[first];
    const bool has_decimals = number[last] != mark && (number[last] == '.' || number[last] == ',');
    const std::string_view whole = has_decimals ? number.substr(0, last) : number;
    const std::string_view decimals = has_decimals ? number.substr(last + 1) : std::string_view();
    if (!is_in_thousands(whole, mark) || !std::ranges::all_of(decimals, is_digit)) return {};
    std::string plain(whole);
    std::erase(plain, mark);
    return has_decimals ? fmt::format("{}.{}", plain, decimals) : plain;
}

// Why these marks are no decimal mark; empty where they are one, or none.
std::string told_of_marks(std::string_view number) {
    const auto marks =
        std::ranges::count_if(number, [](char c) { return kMarks.find(c) != std::string_view::npos; });
    if (marks > 1 || number.find_first_of(" '") != std::string_view::npos) {
        const std::string plain = without_thousands(number);
        return plain.empty()
                   ? fmt::format("{} is not a number: write it with one decimal mark, and no other", number)
                   : fmt::format("{} has marks between thousands: write {}", number, plain);
    }
    const auto comma = number.find(',');
    if (comma == std::string_view::npos) return {};
    // Groups of thousands begin with one to three digits, the first of them no 0.
    const auto begin = number.find_first_of("0123456789");
    const auto behind = number.find_first_not_of("0123456789", comma + 1);
    const std::size_t after = std::min(behind, number.size()) - comma - 1,
                      before = comma - std::min(begin, comma);
    if (behind == std::string_view::npos && after == 3 && before >= 1 && before <= 3 &&
        number[begin] != '0') {
        std::string point(number), whole(number);
        point[comma] = '.';
        whole.erase(comma, 1);
        return fmt::format("{} may be {} or {}: write one of these", number, point, whole);
    }
    return {};
}

}  // namespace

TypedNumber typed_number(std::string_view text, std::string_view unit) {
    TypedNumber typed;
    const std::string whole = in_plain_signs(text);
    if (whole.empty()) {
        typed.complaint = "a number is needed";
        return typed;
    }
    const std::size_t length = length_of_number(whole);
    const std::string_view number = std::string_view(whole).substr(0, length);
    const std::string_view rest = without_blanks(std::string_view(whole).substr(length));
    if (length == 0 || (!rest.empty() && unit_in_plain_signs(rest) != unit_in_plain_signs(unit))) {
        if (length > 0 && !unit.empty())
            typed.complaint = fmt::format("{}: give it in {}", whole, without_blanks(unit));
        else
            typed.complaint = fmt::format("{} is not a number", whole);
        return typed;
    }
    typed.complaint = told_of_marks(number);
    if (!typed.complaint.empty()) return typed;
    std::string plain(number);
    if (const auto comma = plain.find(','); comma != std::string::npos) {
        typed.comma = true;
        plain[comma] = '.';
    }
    typed.value = std::strtod(plain.c_str(), nullptr);
    if (!std::isfinite(typed.value)) {
        typed.complaint = fmt::format("{} is out of range", number);
        typed.value = 0;
        return typed;
    }
    typed.plain = std::move(plain);
    return typed;
}

}  // namespace tangi
