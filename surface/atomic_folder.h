// atomic_folder.h: folders of files that belong together and appear whole or not at all.
#pragma once

#include <filesystem>
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
    // `contents`: name of the file that lists the folder's files. Throws Error naming the target: its parent
    // is missing or cannot be written, it is a file, or it holds what the list does not have, with the first
    // such file.
    AtomicFolder(std::filesystem::path target, std::string contents);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    // Where to write.
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& target() const { return target_; }

    // Writes the list and puts the folder in place. Throws Error naming the target. Returns the list: the
    // files, relative to the folder.
    std::vector<std::string> commit();

private:
    std::filesystem::path target_, temporary_;
    std::string contents_;
};

}  // namespace tangi
