// treatment_log.h: the record of a treatment: one JSON object a line, append-only, each line chained to the
// one before by SHA-256, so that a log that was edited or cut is recognised.
//
// A line is the object's text with `"sha256"`, the hash of the text without it, as its last field; its
// `previous` is the hash of the line before (of the first: 64 zeros). Beside the log lies its head
// (log.head.json: number of lines, hash of the last), without which lines could be cut off at the end
// unnoticed. Who holds a report, which names the head, can tell a log that was written anew as a whole.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tangi {

inline constexpr const char* kTreatmentFormat = "tangipaint treatment";  // in the first line of a log

struct LogEntry {
    int line = 0;            // of the file, from 1
    nlohmann::json content;  // with `previous`, without `sha256`
    std::string sha256;
};

// What is wrong with a log: the first line that is.
struct LogFault {
    int line = 0;
    std::string what;
};

// Holds a log for one program: whoever else wants to write to it, or to what it tells of, waits until this is
// gone.
class LogHold {
public:
    // Throws Error naming the log where it cannot be read.
    explicit LogHold(const std::filesystem::path& log);
    ~LogHold();
    LogHold(const LogHold&) = delete;
    LogHold& operator=(const LogHold&) = delete;

private:
    int file_;
};

class TreatmentLog {
public:
    // Makes the file with its first line: `content`, to which format and version are added. Throws Error
    // where there is a log already, or it cannot be written.
    static TreatmentLog begin(const std::filesystem::path& path, nlohmann::json content);
    // Reads the log and checks the chain. Throws Error naming the file and the line where it was edited, cut,
    // or is no log. A line that a crash cut short is left out, with a warning, and removed by append().
    static TreatmentLog open(const std::filesystem::path& path);

    const std::vector<LogEntry>& entries() const { return entries_; }
    const std::vector<std::string>& warnings() const { return warnings_; }
    const std::string& head() const { return entries_.back().sha256; }
    const std::filesystem::path& path() const { return path_; }

    // Adds a line and makes sure that it, and the head, are on the disk. Throws Error naming the file where
    // they cannot be written, or the log was changed by somebody else since it was opened. The line is taken
    // back then; is_as_long_as_known() is false where that cannot be done either.
    const LogEntry& append(nlohmann::json content);
    // The same by one who holds the log, and may have found before that nobody else wrote to it.
    // `last` is called when the line is on the disk: what it throws takes the line back.
    const LogEntry& append(nlohmann::json content, const LogHold& held,
                           const std::function<void()>& last = {});
    // Throws Error where it was changed by somebody else since it was opened; while it is held, that is
    // final.
    void require_unchanged() const;
    bool is_as_long_as_known() const;
    // Of a last line that a crash left without its head, and that is known to be of this program: writes it.
    void complete_head(const LogHold& held) const;
    // What a crash left of a last line that is known to be of this program.
    void remove_torn_line(const LogHold& held);

private:
    explicit TreatmentLog(std::filesystem::path path) : path_(std::move(path)) {}
    void write_head() const;
    bool has_head() const;

    std::filesystem::path path_;
    std::vector<LogEntry> entries_;
    std::vector<std::string> warnings_;
    std::uintmax_t whole_bytes_ = 0;  // of the lines that count
    std::uintmax_t seen_bytes_ = 0;   // of the file: more where a line without its end follows them
};

// The first fault of a log's text, by line; nothing where the chain holds. `torn` says whether the text ends
// within a line, which is not looked at.
std::vector<LogEntry> chained_entries(const std::string& text, std::vector<LogFault>& faults, bool& torn);

// "2024-05-31T09:30:00Z" of now.
std::string utc_now();

}  // namespace tangi
