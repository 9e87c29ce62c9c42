// command.h: what every command of the program is made of: its flags, its run, and how it talks to the user.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surface/options.h"
#include "surface/progress.h"

namespace tangi {

enum ExitCode {
    kDone = 0,
    kWorldIsWrong = 1,
    kUsage = 2,
    kPoorNumbers = 3,
    kOurBug = 70,
    kInterrupted = 130
};

// What was typed makes no sense: exit code 2.
class UsageError : public Error {
public:
    using Error::Error;
};

// A command: adds its flags to `app` and gives what to run once they are parsed. The run returns the one JSON
// result that goes to stdout; a list "poor" in it makes the exit code 3.
struct Command {
    const char* name;
    const char* summary;
    std::function<std::function<nlohmann::json()>(CLI::App& app)> set_up;
};

// The table of commands, in the order in which help lists them.
const std::vector<Command>& commands();

// Makes stdin, stdout and stderr safe to use, whatever they are. To be called before anything is opened.
void prepare_streams();

// Writes to stderr. One that takes nothing (closed, a full disk) is no reason to lose the work: nothing
// happens then.
void write_stderr(std::string_view text);

// Progress on stderr: a bar where stderr is a terminal, else a line every few seconds. Asks for a stop after
// Ctrl-C, a kill, or when the terminal is closed.
Progress console_progress();

// Writes a warning to stderr, without disturbing the bar.
void warn(const std::string& text);

// A check of a flag: a number from `minimum` to `maximum`. CLI::Range lets NaN pass.
inline std::function<std::string(const std::string&)> within(double minimum, double maximum) {
    return [=](const std::string& text) {
        try {
            const double x = std::stod(text);
            if (x >= minimum && x <= maximum) return std::string();
        } catch (const std::exception&) {  // not a number at all: the same remedy
        }
        return fmt::format("{} is not in [{}, {}]", text, minimum, maximum);
    };
}

// Flags for the fields of an options struct: --max-iterations for max_iterations. Values outside their
// interval are usage errors. `wanted` chooses fields by name; all where empty.
template <class Options>
void add_fields(CLI::App& app, Options& options, const std::function<bool(std::string_view)>& wanted = {}) {
    Options::fields(options, [&](const FieldInfo& info, auto& value) {
        if (wanted && !wanted(info.name)) return;
        using T = std::remove_cvref_t<decltype(value)>;
        std::string flag = "--" + std::string(info.name);
        for (char& c : flag) c = c == '_' ? '-' : c;
        if constexpr (std::same_as<T, bool>) {
            app.add_flag(flag + ",!--no-" + flag.substr(2), value, std::string(info.help));
        } else {
            auto* option = app.add_option(flag, value, std::string(info.help));
            std::string type = info.unit == "1" || info.unit.empty() ? "NUMBER" : std::string(info.unit);
            option->option_text(type);
            option->check(within(info.minimum, info.maximum));
        }
    });
}

// The one JSON value for numbers that JSON has no word for.
inline nlohmann::json finite(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace tangi
