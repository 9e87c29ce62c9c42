// atomic_folder.h: folders of files that belong together and appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tangi {

// Holds a temporary folder beside the target until commit() puts it in the target's place. Destroyed without
// commit(), it removes the temporary folder, and what was at the target before is still there.
//
// A folder of the same kind is replaced as a whole, so that nothing of an older one stays between the new
// files. What it wrote itself it knows by the list that it keeps in the folder (`contents`); a folder that
// holds anything else is not touched.
class AtomicFolder {
public:
    // `contents`: name of the file that lists the folder's files, as its field "files". Throws Error naming
    // the target: its parent is missing or cannot be written, it is a file, or it holds a file or a folder
    // that is not of the list, with the first such one.
    AtomicFolder(std::filesystem::path target, std::string contents);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    // Where to write.
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& target() const { return target_; }

    // Writes the list into the file of contents, which may be there with fields of its own (a JSON object),
    // and puts the folder in place. Throws Error naming the target. Returns the list: the files, relative to
    // the folder.
    std::vector<std::string> commit();

private:
    void require_own() const;

    std::filesystem::path target_, temporary_;
    std::string contents_;
};

// Files for a folder that other things may lie in, and stay: they are kept in a hidden folder in it until
// place() puts all of them in their places. Destroyed without place(), it removes them, and the folder where
// it made that.
class FolderFiles {
public:
    // Makes the folder. Throws Error naming it.
    explicit FolderFiles(std::filesystem::path folder);
    ~FolderFiles();
    FolderFiles(const FolderFiles&) = delete;
    FolderFiles& operator=(const FolderFiles&) = delete;

    // Where to write, in folders as the target is to have them.
    const std::filesystem::path& temporary() const { return temporary_; }

    // Those in folders first. Throws Error naming the file; those before it are in place then.
    void place();

private:
    std::filesystem::path folder_, temporary_;
    bool made_ = false, placed_ = false;
};

// Runs `write`, which writes to `temporary`; what its Errors say of that, they say of `target`.
void told_of(const std::filesystem::path& temporary, const std::filesystem::path& target,
             const std::function<void()>& write);

// Puts `from` where `to` is, and `to` where `from` was, at once where the file system can. False, with errno,
// where it fails.
bool exchange_folders(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace tangi
