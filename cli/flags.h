// flags.h: what a command can be told. The parser's own headers (CLI11) are in flags.cpp and main.cpp only:
// they take half a minute to compile.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "surface/base/options.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tangi {

// Says what is wrong with a value; nothing where it is fine.
using FlagCheck = std::function<std::string(const std::string&)>;

FlagCheck within(double minimum, double maximum);  // NaN is outside
FlagCheck positive();                              // and finite

// One of a few words, which shell completions know by themselves.
struct OneOf {
    std::vector<std::string> words;
    std::string operator()(const std::string& text) const;
};
inline OneOf one_of(std::vector<std::string> words) { return {std::move(words)}; }

// A flag that was added, to say more about it.
class Flag {
public:
    explicit Flag(CLI::Option* option) : option_(option) {}

    Flag& required();
    Flag& check(const FlagCheck& check);
    Flag& show_default();
    Flag& one_value();                   // each time it is given; for lists
    Flag& value_name(std::string text);  // what help shows for the value

private:
    CLI::Option* option_;
};

// The flags of one command. What they are bound to must outlive the parsing.
class Flags {
public:
    explicit Flags(CLI::App& app) : app_(app) {}

    // `T`: std::string, a number, std::optional of one, or std::vector<std::string>. A name without dashes is
    // a position.
    template <class T>
    Flag option(const std::string& name, T& value, const std::string& help);

    Flag flag(const std::string& names, bool& value, const std::string& help);
    // Said or not: --name or --no-name.
    Flag flag(const std::string& name, std::optional<bool>& value, const std::string& help);

    // The flags of the command that were typed, as "--seed"; known once the command line is parsed.
    std::function<std::vector<std::string>()> typed() const;

    // Flags for the fields of an options struct: --max-iterations for max_iterations. Values outside their
    // interval are usage errors. `wanted` chooses fields by name; all where empty.
    template <class Options>
    void fields(Options& options, const std::function<bool(std::string_view)>& wanted = {}) {
        Options::fields(options, [&](const FieldInfo& info, auto& value) {
            if (!wanted || wanted(info.name)) field(info, value);
        });
    }

private:
    void field(const FieldInfo& info, bool& value);
    void field(const FieldInfo& info, std::optional<bool>& value);
    template <class T>
    void field(const FieldInfo& info, T& value) {
        option(flag_name(info), value, std::string(info.help))
            .value_name(info.unit == "1" || info.unit.empty() ? "NUMBER" : std::string(info.unit))
            .check(within(info.minimum, info.maximum));
    }
    static std::string flag_name(const FieldInfo& info);

    CLI::App& app_;
};

}  // namespace tangi
