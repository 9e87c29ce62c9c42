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
    // and by which program it is, and puts the folder in place. Throws Error naming the target. Returns the
    // list: the files, relative to the folder.
    std::vector<std::string> commit();

private:
    void require_own() const;

    std::filesystem::path target_, temporary_;
    std::string contents_;
};

// Folders that were made for something: unless that came about they are gone again, where they are empty.
class MadeFolders {
public:
    MadeFolders() = default;
    ~MadeFolders();
    MadeFolders(const MadeFolders&) = delete;
    MadeFolders& operator=(const MadeFolders&) = delete;

    // Makes a folder and its parents. Throws Error as make_folder() does.
    void make(const std::filesystem::path& folder);
    void keep() { made_.clear(); }

private:
    std::vector<std::filesystem::path> made_;
};

// Files for a folder that other things may lie in, and stay: they are kept in a hidden folder until place()
// puts all of them in their places, together (OutputSet). Where the folder is not there yet, the hidden one
// becomes it. Destroyed without place(), it removes them.
class FolderFiles {
public:
    // Throws Error naming the folder where there can be none, or nothing can be written.
    explicit FolderFiles(std::filesystem::path folder);
    ~FolderFiles();
    FolderFiles(const FolderFiles&) = delete;
    FolderFiles& operator=(const FolderFiles&) = delete;

    // Where to write, in folders as the target is to have them.
    const std::filesystem::path& temporary() const { return temporary_; }

    // Throws Error naming the file; then none of them is in place.
    void place();

private:
    friend class OutputSet;
    struct Move {
        std::filesystem::path folder, from, to, named;  // from, to: relative to the folder
    };
    std::vector<Move> moves();
    void placed(bool cleaned);

    std::filesystem::path folder_, temporary_;
    MadeFolders made_;
    bool is_new_ = false, left_ = false;
};

// Runs `write`, which writes to `temporary`; what its Errors say of that, they say of `target`.
void told_of(const std::filesystem::path& temporary, const std::filesystem::path& target,
             const std::function<void()>& write);

// Puts `from` where `to` is, and `to` where `from` was, at once where the file system can. False, with errno,
// where it fails.
bool exchange_folders(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace tangi
