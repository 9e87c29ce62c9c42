// error.h: the three ways in which things go wrong, each with its own type.
//
//   Error          the world is wrong (a file, a flag, the data): the message is for the user.  exit code 1
//   Cancelled      the user asked to stop; nothing half-written stays behind.                     exit code
//   130 ContractError  our code is wrong: a broken precondition, with file and line.                  exit
//   code 70
//
// Numbers that are poor (no convergence, too few lights) are not errors: they are fields of the reports.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace tangi {

class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Cancelled : public std::runtime_error {
public:
    Cancelled() : std::runtime_error("stopped at your request") {}
};

class ContractError : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

// Throws Error with a fmt-formatted message: say what is wrong, where, and what to do about it.
template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(fmt::format(format, std::forward<Args>(args)...));
}

#define TP_REQUIRE(condition, what)                                                   \
    do {                                                                              \
        if (!(condition))                                                             \
            throw ::tangi::ContractError(                                             \
                fmt::format("{}:{}: {} ({})", __FILE__, __LINE__, what, #condition)); \
    } while (false)

}  // namespace tangi
