// settings.h: what the program remembers of its user: a folder, and in it the paintings opened last.
#pragma once

#include <filesystem>
#include <vector>

namespace tangi {

// $XDG_CONFIG_HOME/tangipaint, else ~/.config/tangipaint; empty where there is neither. May not exist yet.
std::filesystem::path settings_folder();

// Where a new canvas is saved if nothing is said: untitled-1.exr in this folder, or the next that is free.
std::filesystem::path untitled(const std::filesystem::path& folder);

// The last ten, newest first, as recent.json in the folder has them; those that are gone are passed over, and
// a file that cannot be read counts as empty.
std::vector<std::filesystem::path> recent_paintings(const std::filesystem::path& folder);

// Puts one in front. Throws Error where it cannot be written.
void remember_painting(const std::filesystem::path& folder, const std::filesystem::path& painting);

}  // namespace tangi
