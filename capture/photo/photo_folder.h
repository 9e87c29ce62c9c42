// photo_folder.h: the pictures and masks that a folder holds.
#pragma once

#include <filesystem>
#include <vector>

namespace tangi {

// Throws Error where there is no such folder, or it cannot be read.
void require_folder(const std::filesystem::path& folder);

// The pictures in a folder, by name; hidden ones are none.
std::vector<std::filesystem::path> photos_in(const std::filesystem::path& folder);

// Takes pictures whose names say that they are masks out of a list, and returns them; none where at least
// half of the names say so, since then it is the painting's name ("damask_01.jpg").
std::vector<std::filesystem::path> take_masks(std::vector<std::filesystem::path>& pictures);

}  // namespace tangi
