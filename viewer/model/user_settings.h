// user_settings.h: what the program remembers of its user: a folder, and in it the paintings opened last.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/file/file_stamp.h"

namespace tangi {

// $XDG_CONFIG_HOME/tangipaint, else ~/.config/tangipaint; empty where there is neither. May not exist yet.
std::filesystem::path settings_folder();

// Where a new canvas is saved if nothing is said: untitled-1.exr in this folder, or the next that is free.
std::filesystem::path untitled(const std::filesystem::path& folder);

// A file of settings that is read once and written anew when they change in the window. What somebody else
// made of it meanwhile (by hand, in another window), or what could not be read, is kept beside it.
class SettingsFile {
public:
    SettingsFile() = default;
    explicit SettingsFile(std::filesystem::path file) : file_(std::move(file)), stamp_(stamp_of(file_)) {}

    const std::filesystem::path& path() const { return file_; }
    void cannot_be_read() { is_bad_ = true; }
    // Before it is written: renames what is to be kept, as NAME.wrong.json or NAME.other.json, and gives what
    // the user should know; empty where there is nothing. Throws Error where it cannot be renamed.
    std::string make_way();
    void is_written();

private:
    std::filesystem::path file_;
    std::optional<FileStamp> stamp_;  // as it was read or written last
    bool is_bad_ = false;
};

// The last ten, newest first, as recent.json in the folder has them; those that are gone are passed over, and
// a file that cannot be read counts as empty.
std::vector<std::filesystem::path> recent_paintings(const std::filesystem::path& folder);

// Puts one in front. Throws Error where it cannot be written.
void remember_painting(const std::filesystem::path& folder, const std::filesystem::path& painting);

}  // namespace tangi
