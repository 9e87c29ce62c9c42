#include "capture/photo/photo_folder.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <system_error>

#include "capture/photo/photo_file.h"
#include "capture/photo/photo_names.h"
#include "surface/base/error.h"
#include "surface/file/file_name.h"
#include "surface/file/visible_files.h"

namespace tangi {

namespace fs = std::filesystem;

void require_folder(const fs::path& folder) {
    std::error_code reason;
    if (!fs::exists(folder, reason) && !reason) fail("{}: no such folder", folder.string());
    if (!reason && !fs::is_directory(folder, reason))
        fail("{}: is not a folder; give the folder that holds the photographs", folder.string());
    if (!reason) (void)fs::directory_iterator(folder, reason);
    if (reason == std::errc::filename_too_long) fail("{}", words_of({"", folder, reason}));
    if (reason)
        fail("{}: the folder cannot be read: {}; give yourself the right to, or copy it to another place",
             folder.string(), reason.message());
}

std::vector<fs::path> photos_in(const fs::path& folder) {
    std::vector<fs::path> photos;
    for (const fs::path& path : visible_files(folder))
        if (is_photo_name(path)) photos.push_back(path);
    return photos;
}

std::vector<fs::path> take_masks(std::vector<fs::path>& pictures) {
    const auto says_mask = [](const fs::path& path) {
        return alike(path.filename().string()).find("mask") != std::string::npos;
    };
    std::vector<fs::path> masks;
    std::copy_if(pictures.begin(), pictures.end(), std::back_inserter(masks), says_mask);
    if (2 * masks.size() >= pictures.size()) return {};
    std::erase_if(pictures, says_mask);
    return masks;
}

}  // namespace tangi
