// command.h: what every command of the program is made of: its flags, its run, and how it talks to the user.
#pragma once

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "surface/base/progress.h"

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

// Runs `call`, an Error of which is about what was typed.
template <class Call>
auto of_words(const Call& call) {
    try {
        return call();
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
}

// A command: adds its `flags` and gives what to run once they are parsed. The run returns the one JSON
// result that goes to stdout; a list "poor" in it makes the exit code 3.
struct Command {
    const char* name;
    const char* summary;
    std::function<std::function<nlohmann::json()>(Flags& flags)> set_up;
    // Lines for a person at a terminal, of a result; null where the JSON is short (cli/result_summary.h).
    std::vector<std::string> (*in_words)(const nlohmann::json& result) = nullptr;
};

// The table of commands, in the order in which help lists them.
const std::vector<Command>& commands();

// How the program talks while it works: flags of every command.
struct ConsoleOptions {
    std::string progress = "auto";  // "auto", or "json": each line of stderr is one event, a JSON object
    bool quiet = false;             // errors alone
    std::string log;                // file that events are added to, each with its time
};

// To be called before anything is told. `words`: the command line, for the log. Throws Error naming the log:
// it cannot be written, or holds something else.
void set_console(const ConsoleOptions& options, const std::vector<std::string>& words);

// Makes stdin, stdout and stderr safe to use, whatever they are. To be called before anything is opened.
void prepare_streams();

// Writes to stderr. One that takes nothing (closed, a full disk) is no reason to lose the work: nothing
// happens then.
void write_stderr(std::string_view text);

// Progress on stderr: a bar where stderr is a terminal, else a line every few seconds. Asks for a stop after
// Ctrl-C, a kill, or when the terminal is closed.
Progress console_progress();

// True once a stop was asked for, in the same ways; console_progress() must have been called.
bool interrupted();

// Text with what file names may hold: control characters become \n, \t, \xHH, \uHHHH, so that they do not
// move the cursor, colour the terminal or look like another message.
std::string printable(std::string_view text);

// Writes a warning to stderr, without disturbing the bar.
void warn(const std::string& text);

// The same of a line that is none, and of several lines for people, as they are.
void tell(const std::string& text);
void tell_lines(const std::string& text);

// Why a command ends, also where it is quiet; into the log with its exit code.
void tell_end(int code, const std::string& message, double seconds);

// True where standard output is a terminal: a person reads what is written there, and not a program.
bool stdout_is_terminal();

// The one JSON value for numbers that JSON has no word for.
inline nlohmann::json finite(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace tangi
