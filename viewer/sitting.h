// sitting.h: the record of a sitting that was not saved yet, and what a crash left of one.
//
// Beside x.exr: x.unsaved.jsonl, the journal of what was done since the painting was saved; x.strokes.jsonl,
// of all that was done before. Saving moves the one to the end of the other.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "paint/journal.h"

namespace tangi {

struct SittingFiles {
    std::filesystem::path painting, unsaved, record;
};
SittingFiles sitting_files(const std::filesystem::path& painting);

// Strokes that were not saved: the journal is there, holds events and is not older than the painting (one
// that is older was saved, but its program died before it could put it away).
std::optional<Journal> left_over(const SittingFiles& files);

class SittingRecord {
public:
    explicit SittingRecord(SittingFiles files) : files_(std::move(files)) {}

    const SittingFiles& files() const { return files_; }
    // Throws Error where it cannot be written; the event was not recorded then.
    void append(const Event& event);
    void sync();
    // Before the painting is saved, which must be seen to be younger than the journal: waits until the clock
    // of the file system, which ticks every 10 ms at worst, has gone on.
    void let_time_pass() const;
    bool empty() const { return !writer_; }
    // After the painting was saved: to the end of the record.
    void put_away();
    // The user does not want it: kept under another name, x.discarded.jsonl.
    void discard();
    // After the painting was saved under another name, which it has from now on: its record is what was
    // recorded so far. A journal that another painting of that name left is put aside, as by discard().
    void move_to(const SittingFiles& files);
    // The same where the painting so far is another window's, whose journal stays with it.
    void leave_for(const SittingFiles& files);

private:
    // `maybe_there`: it may be at the record's end already.
    void move_to_record(bool maybe_there);

    SittingFiles files_;
    std::unique_ptr<JournalWriter> writer_;
};

}  // namespace tangi
