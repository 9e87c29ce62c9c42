// bad_stack.h: what fit says of a stack with something wrong in it.
#pragma once

#include <algorithm>

#include "tests/programs/support/cli_program.h"

namespace tangi {

// fit refuses the stack with exit code 1 and all of `words`, and leaves nothing behind.
inline void expect_refused(const TinyStack& stack, const std::vector<std::string>& words,
                           std::vector<std::string> flags = {}, const std::string& folder = {}) {
    const auto before = everything_in(stack.root());
    flags.insert(flags.begin(), {"fit", folder.empty() ? stack.path() : folder, "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(tangipaint(flags), 1, words));
    EXPECT_EQ(everything_in(stack.root()), before);
}

// fit goes on, with a warning that says all of `words`, on stderr and in the result.
inline nlohmann::json expect_warned(const TinyStack& stack, const std::vector<std::string>& words,
                                    std::vector<std::string> flags = {}) {
    flags.insert(flags.begin(), {"fit", stack.path(), "--out", stack.out("a.exr")});
    const Finished run = tangipaint(flags);
    EXPECT_TRUE(ended(run, 0, words));
    const nlohmann::json result = run.json();
    bool told = false;
    for (const auto& warning : result["warnings"])
        told = told || std::all_of(words.begin(), words.end(), [&](const std::string& word) {
                   return warning.get<std::string>().find(word) != std::string::npos;
               });
    EXPECT_TRUE(told) << result["warnings"];
    return result;
}

inline std::vector<std::string> names_rejected(const nlohmann::json& result) {
    std::vector<std::string> names;
    for (const auto& photo : result["photographs"]["rejected"]) names.push_back(photo["name"]);
    return names;
}

}  // namespace tangi
