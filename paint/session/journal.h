// journal.h: the record of a painting: one JSON object a line, append-only (docs/reference/journal-format.md:
// the format).
//
// The first line is {"format": "tangipaint strokes", "version": 1}, with the painting that the events go on
// from (JournalHead); then one event a line, in the order in which they happened. A line that a crash cut
// short is left out with a warning; all before it count. A stroke without "seed" has its number among the
// file's strokes for one, from 0.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "paint/session/event_order.h"
#include "paint/session/journal_event.h"
#include "surface/file/append_file.h"

namespace tangi {

// What a journal is of, as its first line says it: hash_of(Canvas). Empty where it does not say.
struct JournalHead {
    std::string on;     // before its first event
    std::string makes;  // after its last, where that was saved
};

struct JournalWarning {
    int line = 0;  // of the file, from 1
    std::string text;
};

struct Journal {
    struct Entry {
        int line = 0;  // of the file, from 1
        Event event;
    };
    std::string source;  // the file's name, for errors
    JournalHead head;
    std::vector<Entry> entries;
    std::vector<JournalWarning> warnings;
    int lines_lost = 0;  // that cannot be read, or belong to what cannot (recovered_journal())
};

// Throws Error naming file and line; a last line without its end is left out with a warning. Events that are
// not where they belong (an end without a stroke, a stroke without end or points, an undo within one) are
// warnings too.
Journal read_journal(const std::filesystem::path& path,
                     const std::map<std::string, BrushSettings>& presets = brush_presets());

// As much of a journal as can be read, whatever a failing disk did to it. A line that cannot be read ends the
// stroke that it is within; what follows counts from the next stroke on, and an undo or redo that would reach
// back beyond the line is left out, since it would meet another stroke than it was meant for. A warning for
// each such line. Throws Error where nothing in it is of a journal, or it is of another version.
Journal recovered_journal(const std::filesystem::path& path,
                          const std::map<std::string, BrushSettings>& presets = brush_presets());

// Strokes that are on the painting or the palette after these events: not those that are undone.
int strokes_left(std::span<const Journal::Entry> entries);

// Throws Error naming file and line where a point is of no stroke, as replay() would.
void require_in_order(const Journal& journal);

// A line of a journal, with its end; a whole file with these lines, and with these events.
std::string journal_line(const Event& event);
std::string journal_text(const JournalHead& head, std::string_view lines);
std::string journal_text(std::span<const Journal::Entry> entries);
// The lines of events of a journal's text: without its first line, and without a last one that was cut short.
std::string lines_of_events(std::string_view text);

// Appends events to a file, whole lines at once; what was written survives the program's death.
class JournalWriter {
public:
    // Makes the file with its first line, or goes on with one that is there (cutting off a torn last line,
    // ending one that only lacks its line end, and a stroke that has no end); that keeps its first line.
    // Throws Error naming the file where it cannot be written, or is something else.
    explicit JournalWriter(const std::filesystem::path& path, const JournalHead& head = {});

    // The event fits after the one before (EventOrder). Throws Error naming the file where it cannot be
    // written: nothing of it is in the file then, and it can be tried again.
    void append(const Event& event);
    // Makes sure that it survives a crash of the machine too, also after an earlier call that could not
    // (AppendFile). Call once a second.
    void sync() { file_.sync(); }

private:
    void go_on_with(const std::string& text);

    AppendFile file_;
    EventOrder order_;
};

}  // namespace tangi
