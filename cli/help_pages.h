// help_pages.h: man pages and shell completions, made of the commands and flags as the parser knows them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace tangi {

// Below `folder`, as a prefix's share/ has them: man/man1/*.1 for the program and each command,
// bash-completion/completions/, zsh/site-functions/, fish/vendor_completions.d/. Returns the files' paths.
// Throws Error where the folder cannot be written.
std::vector<std::string> write_help_pages(const CLI::App& program, const std::filesystem::path& folder);

}  // namespace tangi
