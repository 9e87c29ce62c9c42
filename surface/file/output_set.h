// output_set.h: files that belong together, put in place together: a painting and the page that tells of it,
// the pictures of a folder and the list of them.
//
// A file system renames one name at a time, and a program may be stopped between two. So what is about to be
// renamed is written down first, in a record beside it that is on the disk before the first name changes;
// after the last, the record is removed. Until the record is there nothing has happened; from then on,
// whichever command next reads or writes in that folder finishes what was begun. A name that cannot be given
// (a disk that fails) takes the others back. For other programs there is a moment, of as many renames as the
// set has files, in which new ones lie beside old ones; for this one there is none.
//
// A set that is one file, or one new folder, is one rename and needs no record.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "surface/file/output_record.h"

namespace tangi {

class AtomicFile;
class FolderFiles;

class OutputSet {
public:
    // Files that are written under their temporary names; they must live until commit(), which does what
    // their own commit() or place() would.
    void add(AtomicFile& file);
    void add(FolderFiles& files);
    // A folder that takes the place of one that may be there, with all that is in that. Told when it is in
    // place; without `cleaned`, what lies at `temporary` is to stay, since the next command goes on with it.
    void add_folder(const std::filesystem::path& temporary, const std::filesystem::path& target,
                    std::function<void(bool cleaned)> when_done);
    // What an earlier run left in a folder, or below it, that is not of this set: gone when the set is in
    // place, with a folder below that is empty then. Need not be there.
    void withdraw(const std::filesystem::path& folder, const std::filesystem::path& file);

    // Throws Error naming the file that could not be put in place: then none is, or, where that could not be
    // taken back either, the next command finishes it.
    void commit();

private:
    struct Part {
        std::filesystem::path folder;
        OutputMove move;
        std::filesystem::path named;  // as Errors name the target
    };
    void put_in_place(std::vector<std::unique_ptr<RecordFile>>& records);
    void take_back(std::size_t moved, std::vector<std::unique_ptr<RecordFile>>& records);
    void done(bool cleaned);

    std::vector<Part> parts_;
    std::vector<std::function<void(bool cleaned)>> when_done_;
};

// Finishes sets that were interrupted in this folder. Throws Error naming a file that cannot be put in its
// place.
void settle_outputs(const std::filesystem::path& folder);

// The same of the folder that a file lies in, and of a folder itself. Where neither is there, nothing.
void settle_outputs_at(const std::filesystem::path& path);

// The same before something is written to a folder, where also what programs left that were stopped is
// removed; once in the life of this program.
void tidy_folder(const std::filesystem::path& folder);

}  // namespace tangi
