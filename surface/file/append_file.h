// append_file.h: a file that grows record by record, of which a write that broke off leaves nothing.
//
// A disk that is full for a moment, a quota, an I/O error: the part of a record that was written then would
// run into the next one. It is cut off at once or, where the system does not let it, before the next record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace tangi {

class AppendFile {
public:
    enum class Open {
        make,     // where it is not there yet
        existing  // only one that is there
    };
    // What the file holds already counts as whole; cut() takes a part of it off. Throws Error naming the file
    // where it cannot be written.
    explicit AppendFile(std::filesystem::path path, Open how = Open::make);
    ~AppendFile();
    AppendFile(const AppendFile&) = delete;
    AppendFile& operator=(const AppendFile&) = delete;

    // [bytes] of the records that are whole.
    std::uint64_t length() const { return length_; }
    const std::filesystem::path& path() const { return path_; }

    // All of the record or, where it throws Error naming the file, nothing. Throws too where another program
    // has made the file longer or shorter meanwhile, or removed it: nothing is written then.
    void append(std::string_view record);
    // The same, and it is on the disk: a record of which that is not known is cut off again.
    void append_synced(std::string_view record);
    // That what was appended survives a crash of the machine. Throws Error naming the file. After a sync that
    // failed the system may have dropped what it did not get onto the disk, and says nothing of it the next
    // time: all that was appended since the last good one is written again first.
    void sync();
    // The file is as long as this from now on, and no longer than it was. Throws Error naming the file; then
    // it is tried again before the next record.
    void cut(std::uint64_t length);

private:
    void require_own_length() const;
    bool cut_rest();
    void write_at(std::uint64_t offset, std::string_view bytes) const;  // throws Error

    std::filesystem::path path_;
    int file_ = -1;
    std::uint64_t length_ = 0;
    bool has_rest_ = false;     // something that does not count may follow the records
    std::string unsynced_;      // the end of the records, of which it is not known that the disk has it
    bool is_in_doubt_ = false;  // whether the file has it
};

}  // namespace tangi
