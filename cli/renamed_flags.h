// renamed_flags.h: flags that had other names in version 0.1, and are still taken by them.
#pragma once

#include <string>
#include <vector>

namespace tangi {

struct RenamedFlags {
    std::vector<std::string> words;  // of the command line, by the names that flags have now
    std::vector<std::string> notes;  // one for each that was renamed: "--matt-ball is now --diffuse-sphere"
    // Flags that say what another one given says, too, and what to write instead; empty where none does.
    std::string given_twice;
};

// `words`: what follows the program's name.
RenamedFlags with_present_flags(const std::vector<std::string>& words);

}  // namespace tangi
