// crash_recovery.h: the record of a sitting that was not saved yet, and what a crash left of one.
//
// Beside x.exr: x.unsaved.jsonl, the journal of what was done since the painting was saved; x.strokes.jsonl,
// of all that was done before. Saving puts painting and record in place together (OutputSet), and with them
// the journal goes. Each says which painting it is of (JournalHead): what is of another one, which came to
// lie here, or cannot be read, is kept under another name and never becomes a part of the record.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "paint/session/journal.h"
#include "surface/file/atomic_file.h"
#include "surface/file/output_set.h"

namespace tangi {

struct RecoveryFiles {
    std::filesystem::path painting, unsaved, record;
};
RecoveryFiles recovery_files(const std::filesystem::path& painting);

// Strokes that were not saved: the journal is there and holds events. One of an earlier version, which does
// not say what it is of, counts only where it is not older than the painting. Of a damaged one, all that can
// be read (recovered_journal()). Throws Error where nothing in it can.
std::optional<Journal> left_over(const RecoveryFiles& files);

// Whether a journal goes on from this painting (hash_of(Canvas)), as far as it says.
bool is_of(const Journal& journal, const std::string& painting);

class RecoveryRecord {
public:
    explicit RecoveryRecord(RecoveryFiles files) : files_(std::move(files)) {}

    const RecoveryFiles& files() const { return files_; }
    // What is in the painting's file from now on (hash_of(Canvas)), and whether it was never painted on: what
    // is recorded goes on from it. Throws Error where what is recorded already cannot be written anew.
    void painting_is(std::string hash, bool bare = false);
    // Records an event, and what could not be written before it. Throws Error where that fails: the event
    // waits in memory then, and is written by the next append() or sync() that can.
    void append(const Event& event);
    std::size_t waiting() const { return waiting_.size(); }
    // Once a second: writes what waits, and makes sure that all of it survives a crash of the machine.
    void sync();
    // The journal that is there was recovered: these events are on the canvas again, and what follows comes
    // after them. Where it holds others too, or is of another painting, it is kept under another name, and
    // these are written anew.
    void take_over(std::span<const Journal::Entry> events, bool all_of_it);
    // Nothing was done since the painting was saved.
    bool empty() const { return lines_.empty(); }
    // All of it: what is in the journal, and what waits.
    std::string text() const { return journal_text({on_, {}}, lines_); }

    // Files that belong to a painting that is about to be saved; they live until the set is committed.
    using Files = std::vector<std::unique_ptr<AtomicFile>>;
    // Adds to the set what goes with saving as `to`, where the painting is then what `makes` says: its
    // record, whole, and the journals that are no more. A record or journal there of another painting is kept
    // under another name. Throws Error where a file cannot be written.
    Files add_to(OutputSet& set, const RecoveryFiles& to, const std::string& makes) const;
    // The set is in place: what is recorded from now on is of this painting.
    void saved_as(const RecoveryFiles& files, std::string makes);
    // All that was done was undone: to the record, whose painting stays as it is.
    void put_away();
    // It is kept elsewhere, and its journal is gone with that.
    void forget();
    // The user does not want it: kept under another name, x.discarded.jsonl.
    void discard();
    // What was kept under another name since the last call, in words; empty where nothing was.
    std::string take_note() { return std::exchange(note_, {}); }

private:
    void write_waiting();
    void begin();
    void put_older_away();
    std::string record_so_far(JournalHead& head) const;
    void add_unsaved_of(OutputSet& set, Files& files, const RecoveryFiles& to) const;

    RecoveryFiles files_;
    std::string on_;  // the painting in the file
    bool bare_ = false;
    std::unique_ptr<JournalWriter> writer_;
    bool ours_ = false;          // the unsaved journal: it holds what is on the canvas, and nothing else
    std::string lines_;          // all events since the painting was saved, as the journal has them
    std::deque<Event> waiting_;  // the last of them, which could not be written
    std::string note_;
};

}  // namespace tangi
