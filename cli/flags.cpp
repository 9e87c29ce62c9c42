#include "cli/flags.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <cstdint>

#include "surface/base/typed_number.h"

namespace tangi {

namespace {

// What is wrong with "0,3" or "1.234,5", and what to write; empty where the text has no such marks. Without
// it, "2,5" would be taken for 2 by what looks at the beginning alone. Commas separate numbers on the command
// line, so a decimal comma is told of here, and not taken as in the window.
std::string told_of_comma(const std::string& text) {
    if (text.find(',') == std::string::npos) return "";
    const TypedNumber typed = typed_number(text);
    if (typed.comma) return fmt::format("{} has a decimal comma: write {} with a point", text, typed.plain);
    const bool of_digits = text.find_first_not_of("+-.,0123456789eE") == std::string::npos;
    return of_digits ? typed.complaint : "";
}

}  // namespace

FlagCheck within(double minimum, double maximum) {
    return [=](const std::string& text) {
        if (std::string comma = told_of_comma(text); !comma.empty()) return comma;
        try {
            const double x = std::stod(text);
            if (x >= minimum && x <= maximum) return std::string();
        } catch (const std::exception&) {  // not a number at all: the same remedy
        }
        return fmt::format("{} is not in [{}, {}]", text, minimum, maximum);
    };
}

FlagCheck positive() {
    return [](const std::string& text) {
        if (std::string comma = told_of_comma(text); !comma.empty()) return comma;
        try {
            const double x = std::stod(text);
            if (x > 0 && std::isfinite(x)) return std::string();
        } catch (const std::exception&) {
        }
        return fmt::format("{} is not a positive number", text);
    };
}

std::string OneOf::operator()(const std::string& text) const {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return fmt::format("{} is none of {}", text, fmt::join(words, ", "));
}

Flag& Flag::required() {
    option_->required();
    return *this;
}

Flag& Flag::check(const FlagCheck& check) {
    const auto* one = check.target<OneOf>();
    option_->check(check, "", one ? fmt::format("{}", fmt::join(one->words, " ")) : "");
    return *this;
}

Flag& Flag::show_default() {
    option_->capture_default_str();
    return *this;
}

Flag& Flag::one_value() {
    option_->allow_extra_args(false);
    return *this;
}

Flag& Flag::value_name(std::string text) {
    option_->option_text(std::move(text));
    return *this;
}

template <class T>
Flag Flags::option(const std::string& name, T& value, const std::string& help) {
    return Flag(app_.add_option(name, value, help));
}

template Flag Flags::option(const std::string&, std::string&, const std::string&);
template Flag Flags::option(const std::string&, std::vector<std::string>&, const std::string&);
template Flag Flags::option(const std::string&, int&, const std::string&);
template Flag Flags::option(const std::string&, std::uint64_t&, const std::string&);
template Flag Flags::option(const std::string&, float&, const std::string&);
template Flag Flags::option(const std::string&, double&, const std::string&);
template Flag Flags::option(const std::string&, std::optional<int>&, const std::string&);
template Flag Flags::option(const std::string&, std::optional<float>&, const std::string&);
template Flag Flags::option(const std::string&, std::optional<double>&, const std::string&);

Flag Flags::flag(const std::string& names, bool& value, const std::string& help) {
    return Flag(app_.add_flag(names, value, help));
}

Flag Flags::flag(const std::string& name, std::optional<bool>& value, const std::string& help) {
    const auto say = [&value](std::int64_t count) { value = count > 0; };
    return Flag(app_.add_flag_function(name + ",!--no-" + name.substr(2), say, help));
}

std::function<std::vector<std::string>()> Flags::typed() const {
    return [&app = app_] {
        std::vector<std::string> names;
        for (const CLI::Option* option : app.get_options())
            if (option->count() > 0) names.push_back(option->get_name());
        return names;
    };
}

void Flags::field(const FieldInfo& info, bool& value) {
    const std::string name = flag_name(info);
    flag(name + ",!--no-" + name.substr(2), value, std::string(info.help));
}

void Flags::field(const FieldInfo& info, std::optional<bool>& value) {
    flag(flag_name(info), value, std::string(info.help));
}

std::string Flags::flag_name(const FieldInfo& info) {
    std::string name = "--" + std::string(info.name);
    for (char& c : name) c = c == '_' ? '-' : c;
    return name;
}

}  // namespace tangi
