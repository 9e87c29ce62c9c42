// atomic_file.h: files that appear whole or not at all (temporary file, fsync, rename).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tangi {

// The path that a link, and links that it leads to, stand for, also where no file is there yet; any other
// path as it is. Throws Error for links in a circle.
std::filesystem::path where_links_lead(std::filesystem::path path);

// Holds a temporary file beside the target until commit() puts it in the target's place. Destroyed without
// commit(), it removes the temporary file, and what was at the target before is still there. Where the target
// is a link, it stays one, and the file that it leads to is written.
class AtomicFile {
public:
    // Creates the temporary file, so that an output that cannot be written is known before hours of work.
    // Throws Error naming the target where its folder is missing or not writable.
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    // Where to write. It has the target's extension, since libraries choose formats by it.
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& target() const { return target_; }

    // Makes `bytes` the content of the temporary file. Throws Error naming the target, as on a full disk.
    void write(std::string_view bytes);
    // The same of another file's content. Throws Error naming both.
    void copy_from(const std::filesystem::path& file);
    // Throws Error naming the target, also where it is in place but the disk did not say that it holds it.
    void commit();

private:
    friend class OutputSet;  // which commits several as one

    std::filesystem::path target_, place_, temporary_;  // place_: what a link as the target leads to
    bool committed_ = false;
};

// Makes sure that what is in a file, or which names are in a folder, is on the disk; `named` is what Errors
// name. A file system that cannot sync folders is no reason to fail.
void sync_to_disk(const std::filesystem::path& file, const std::filesystem::path& named);
void sync_folder(const std::filesystem::path& folder, const std::filesystem::path& named);

// Writes a text file whole or not at all.
void write_text_file(const std::filesystem::path& path, std::string_view text);
std::string read_text_file(const std::filesystem::path& path);

// Makes a folder and its parents. Throws Error where that can't be, or where a file has its name.
void make_folder(const std::filesystem::path& path);

}  // namespace tangi
