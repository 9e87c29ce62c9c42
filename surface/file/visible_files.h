// visible_files.h: the files of a folder that somebody put there.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

namespace tangi {

// By name, without those whose names begin with a point: macOS puts "._name" beside each file that it writes
// to a disk of another system (AppleDouble), with the same extension and no picture or text in it.
inline std::vector<std::filesystem::path> visible_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::error_code unreadable;
        if (entry.is_regular_file(unreadable) && !entry.path().filename().string().starts_with('.'))
            files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace tangi
