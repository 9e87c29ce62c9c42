// sitting.h: the record of a sitting that was not saved yet, and what a crash left of one.
//
// Beside x.exr: x.unsaved.jsonl, the journal of what was done since the painting was saved; x.strokes.jsonl,
// of all that was done before. Saving moves the one to the end of the other. A journal that could not be read
// is never moved there: it is kept as x.unread.jsonl.
#pragma once

#include <deque>
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
// that is older was saved, but its program died before it could put it away). Of a damaged one, all that can
// be read (recovered_journal()). Throws Error where nothing in it can.
std::optional<Journal> left_over(const SittingFiles& files);

class SittingRecord {
public:
    explicit SittingRecord(SittingFiles files) : files_(std::move(files)) {}

    const SittingFiles& files() const { return files_; }
    // Records an event, and what could not be written before it. Throws Error where that fails: the event
    // waits in memory then, and is written by the next append() or sync() that can.
    void append(const Event& event);
    std::size_t waiting() const { return waiting_.size(); }
    // Once a second: writes what waits, and makes sure that all of it survives a crash of the machine.
    void sync();
    // The journal that is there was recovered: these events are on the canvas again, and what follows comes
    // after them. Where it holds others too, it is kept as x.unread.jsonl, and these are written anew.
    void take_over(std::span<const Journal::Entry> events, bool all_of_it);
    // Before the painting is saved, which must be seen to be younger than the journal: waits until the clock
    // of the file system, which ticks every 10 ms at worst, has gone on.
    void let_time_pass() const;
    bool empty() const { return !ours_ && waiting_.empty(); }
    // After the painting was saved: to the end of the record. Where that fails, sync() tries it again.
    void put_away();
    // The user does not want it: kept under another name, x.discarded.jsonl.
    void discard();
    // After the painting was saved under another name, which it has from now on: its record is what was
    // recorded so far. A journal that another painting of that name left is put aside, as by discard().
    // Throws Error where some of it fails; then sync() tries to write the record again.
    void move_to(const SittingFiles& files);
    // The same where the painting so far is another window's, whose journal stays with it.
    void leave_for(const SittingFiles& files);

private:
    void write_waiting();
    void begin();
    void put_older_away();
    void settle();

    SittingFiles files_;
    std::unique_ptr<JournalWriter> writer_;
    bool ours_ = false;          // the unsaved journal: it holds what is on the canvas, and nothing else
    std::deque<Event> waiting_;  // that could not be written
    struct Owed {
        std::string text;           // all of the record
        bool with_unsaved = false;  // the journal is in it, and goes when it is written
    };
    std::optional<Owed> owed_;  // what the record is to be, and could not be written yet
};

}  // namespace tangi
