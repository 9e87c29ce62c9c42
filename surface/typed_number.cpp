#include "surface/typed_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tangi {

namespace {

std::string_view without_blanks(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r\n";
    const auto begin = text.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// The typographic minus, U+2212.
constexpr std::string_view kMinus = "\xe2\x88\x92";

// Sign, digits with points and commas, exponent: how many characters of `text` look like a number.
std::size_t length_of_number(std::string_view text) {
    std::size_t i = 0;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    const std::size_t digits = i;
    while (i < text.size() && (is_digit(text[i]) || text[i] == '.' || text[i] == ',')) ++i;
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

// The last mark taken for the decimal one, the others for marks between thousands.
std::string without_thousands(std::string_view number) {
    const auto last = number.find_last_of(".,");
    const bool one_kind = number.find_first_of(".,") == last ||
                          (std::ranges::count(number, '.') == 0 || std::ranges::count(number, ',') == 0);
    std::string plain;
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] != '.' && number[i] != ',')
            plain += number[i];
        else if (i == last && !one_kind)
            plain += '.';
    }
    return plain;
}

// Why these points and commas are no decimal mark; empty where they are one, or none.
std::string told_of_marks(std::string_view number) {
    const auto marks = std::ranges::count_if(number, [](char c) { return c == '.' || c == ','; });
    if (marks > 1)
        return fmt::format("{} has marks between thousands: write {}", number, without_thousands(number));
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
    std::string whole(without_blanks(text));
    if (whole.starts_with(kMinus)) whole.replace(0, kMinus.size(), "-");
    if (whole.empty()) {
        typed.complaint = "a number is needed";
        return typed;
    }
    const std::size_t length = length_of_number(whole);
    const std::string_view number = std::string_view(whole).substr(0, length);
    const std::string_view rest = without_blanks(std::string_view(whole).substr(length));
    const bool goes_on = !rest.empty() && (is_digit(rest.front()) || rest.front() == '\'');
    if (length == 0 || (!rest.empty() && rest != without_blanks(unit))) {
        if (length > 0 && goes_on)
            typed.complaint = fmt::format("{} has marks between thousands: write it without", whole);
        else if (length > 0 && !unit.empty())
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
