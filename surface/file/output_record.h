// output_record.h: what is to be put in place together, written down beside it (surface/file/output_set.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tangi {

// One step of putting a set in place, within one folder. Doing it again, or what is left of it, comes to the
// same, so that a set that was interrupted anywhere can be finished.
struct OutputMove {
    enum class Kind {
        put,      // `from`, a temporary file or folder, becomes `to`
        withdraw  // `to`, of an earlier run, is no more: it becomes `from` until the set is in place
    };
    Kind kind = Kind::put;
    std::filesystem::path from, to;  // relative to the folder, and in it

    // Throws Error naming `to`.
    void prepare(const std::filesystem::path& folder) const;  // so that it can be undone
    void forward(const std::filesystem::path& folder) const;
    void back(const std::filesystem::path& folder) const;  // where prepare() found that it can be
    void clean(const std::filesystem::path& folder) const noexcept;
    std::filesystem::path aside() const;  // where what was at `to` is kept meanwhile
};

// A record lies in each folder of a set, under one name. The set counts as in place once that of its first
// folder is there; the others name it.
struct OutputRecord {
    std::vector<OutputMove> moves;                 // in its folder
    std::optional<std::filesystem::path> first;    // relative to its folder: the set's first record
    std::vector<std::filesystem::path> elsewhere;  // of the first one: the other folders, relative to its own

    std::string text() const;
    // Whether all that it names lies in the folder, wherever links there lead.
    bool stays_within(const std::filesystem::path& folder) const;
};

// Whether a file may be a record by its name.
bool is_record_name(const std::string& name);
// Of this program, another for each set.
std::string new_record_name();
// Nothing where the text is no record, or one that would reach out of its folder.
std::optional<OutputRecord> record_in(const std::string& text);

// A record on the disk. Held: nobody else takes it for that of a program that was stopped.
class RecordFile {
public:
    // Writes it whole, or throws Error naming `named`. A record that is destroyed before it is placed is
    // gone.
    RecordFile(std::filesystem::path path, const OutputRecord& record, std::filesystem::path named);
    // Waits until nobody holds it. is_there() is false where it is gone then.
    explicit RecordFile(std::filesystem::path path);
    ~RecordFile();
    RecordFile(const RecordFile&) = delete;
    RecordFile& operator=(const RecordFile&) = delete;

    void place();  // throws Error
    void remove() noexcept;
    void keep() { placed_ = true; }
    bool is_there() const { return placed_; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_, temporary_, named_;
    int file_ = -1;
    bool placed_ = false;
};

}  // namespace tangi
