#include "paint/session/journal.h"

#include <algorithm>

#include "paint/session/journal_file_text.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

using Presets = std::map<std::string, BrushSettings>;

// What happened that its author cannot have meant, since strokes begin with "stroke" and end with "end".
std::vector<JournalWarning> misplaced(const Journal& journal) {
    std::vector<JournalWarning> warnings;
    const auto warn = [&](int line, const std::string& words) { warnings.push_back({line, words}); };
    EventOrder order;
    int stroke = 0;  // line of the one under way
    for (const auto& [line, event] : journal.entries) {
        const EventOrder::Fit fit = order.fit(event);
        const bool begins = std::holds_alternative<StrokeEvent>(event),
                   ends = std::holds_alternative<EndEvent>(event);
        if (fit == EventOrder::Fit::nowhere && ends) warn(line, "an 'end' without a stroke: it ends nothing");
        if (order.in_stroke() && !order.has_points() && (ends || fit == EventOrder::Fit::after_end))
            warn(stroke, "the stroke has no points: it paints nothing");
        if (fit == EventOrder::Fit::after_end && begins)
            warn(stroke,
                 fmt::format("the stroke has no 'end' before that of line {} begins; it ends there", line));
        else if (fit == EventOrder::Fit::after_end)
            warn(line, fmt::format("'{}' comes before the 'end' of the stroke of line {}, which it ends",
                                   name_of(event), stroke));
        if (begins) stroke = line;
        order.take(event);
    }
    if (order.in_stroke())
        warn(stroke, fmt::format("the stroke has no {}; it ends with the journal",
                                 order.has_points() ? "'end'" : "points and no 'end'"));
    return warnings;
}

// What can be taken of the events after a line that is lost. Undo and redo are counted: of what came before
// the line nothing is undone by what comes after it, since nobody knows what the lost event did.
class AfterLostLine {
public:
    void lose() {
        lost_ = true;
        order_ = {};
        undoable_ = redoable_ = 0;
    }
    bool in_stroke() const { return order_.in_stroke(); }

    bool takes(const Event& event) {
        if (lost_) {
            if (order_.fit(event) == EventOrder::Fit::nowhere) return false;
            const bool undo = std::holds_alternative<UndoEvent>(event),
                       redo = std::holds_alternative<RedoEvent>(event),
                       point = std::holds_alternative<PointEvent>(event),
                       end = std::holds_alternative<EndEvent>(event) || is_setting(event);
            if (undo ? undoable_ == 0 : redo && redoable_ == 0) return false;
            if (undo || redo) {
                undoable_ += undo ? -1 : 1;
                redoable_ += undo ? 1 : -1;
            } else if (!point && !end) {
                ++undoable_;
                redoable_ = 0;
            }
        }
        order_.take(event);
        return true;
    }

private:
    EventOrder order_;
    bool lost_ = false;
    int undoable_ = 0, redoable_ = 0;
};

class Reading {
public:
    Reading(const std::filesystem::path& path, const Presets& presets, bool recovers)
        : path_(path), presets_(presets), recovers_(recovers) {
        journal_.source = path.string();
    }

    Journal read() {
        const std::string text = read_text_file(path_);
        for (std::size_t begin = 0; begin < text.size();) {
            const std::size_t end = end_of_line(text, begin);
            const std::string content = text.substr(begin, end - begin);
            begin = end + (text.compare(end, 2, "\r\n") == 0 ? 2 : 1);
            ++line_;
            if (content.find_first_not_of(" \t") == std::string::npos) continue;
            take(content, end < text.size());
            is_first_ = false;
        }
        if (!has_first_line_ && !(recovers_ && text.empty())) {
            if (recovers_) fail("{}: nothing in it is of a journal of strokes", path_.string());
            fail("{}: is empty; its first line must be {}", path_.string(), kJournalFirstLine);
        }
        for (JournalWarning& warning : misplaced(journal_)) journal_.warnings.push_back(std::move(warning));
        std::ranges::stable_sort(journal_.warnings, {}, &JournalWarning::line);
        return std::move(journal_);
    }

private:
    std::string where() const { return fmt::format("{}:{}", path_.string(), line_); }

    void take(const std::string& content, bool whole) {
        if (!recovers_) {
            take_strictly(content, whole);
            return;
        }
        try {
            take_strictly(content, whole);
        } catch (const Error& error) {
            if (is_first_ && !whole && is_torn_first_line(content)) {
                has_first_line_ = true;  // a crash came before anything was recorded
                return;
            }
            // That of a newer version is not damaged: it is to be left alone.
            if (is_first_ && content.find("\"tangipaint strokes\"") != std::string::npos &&
                parsed_line(content, where()))
                throw;
            lose(error.what());
        }
    }

    void take_strictly(const std::string& content, bool whole) {
        if (is_first_) {
            journal_.head = head_from(content, where());
            has_first_line_ = true;
            return;
        }
        std::string why;
        const auto object = parsed_line(content, where(), &why);
        if (!object && whole) fail("{}: is not JSON: {}; one event is one line", where(), why);
        if (!object) {
            journal_.warnings.push_back({line_, "the last line is cut short, as by a crash; it is left out"});
            return;
        }
        if (object->is_object() && object->contains("format") && !object->contains("event"))
            fail("{}: another journal begins here; replay each by itself, one after the other", where());
        Event event = event_from_json(*object, where(), presets_);
        if (auto* stroke = std::get_if<StrokeEvent>(&event)) {
            // Strokes of one seed have the same streaks.
            if (!object->contains("seed")) stroke->seed = strokes_;
            ++strokes_;
        }
        has_first_line_ = true;
        if (after_.takes(event)) {
            journal_.entries.push_back({line_, std::move(event)});
            return;
        }
        if (!std::holds_alternative<EndEvent>(event)) ++journal_.lines_lost;
        if (std::holds_alternative<UndoEvent>(event) || std::holds_alternative<RedoEvent>(event))
            journal_.warnings.push_back(
                {line_, fmt::format("the '{}' is left out: it would reach back beyond a line that is lost",
                                    name_of(event))});
    }

    void lose(std::string why) {
        if (const std::string place = where() + ": "; why.starts_with(place)) why.erase(0, place.size());
        journal_.warnings.push_back({line_, fmt::format("cannot be read, and is left out: {}", why)});
        ++journal_.lines_lost;
        if (after_.in_stroke()) journal_.entries.push_back({line_, EndEvent{}});
        after_.lose();
    }

    const std::filesystem::path& path_;
    const Presets& presets_;
    const bool recovers_;
    Journal journal_;
    AfterLostLine after_;
    int line_ = 0;
    std::uint64_t strokes_ = 0;
    bool is_first_ = true;         // the line, of those that are not blank
    bool has_first_line_ = false;  // or an event, where that is what was lost
};

}  // namespace

Journal read_journal(const std::filesystem::path& path, const Presets& presets) {
    return Reading(path, presets, false).read();
}

int strokes_left(std::span<const Journal::Entry> entries) {
    std::vector<bool> done, undone;  // whether it is a stroke
    for (const auto& [line, event] : entries) {
        const bool undo = std::holds_alternative<UndoEvent>(event);
        if (undo || std::holds_alternative<RedoEvent>(event)) {
            std::vector<bool>&from = undo ? done : undone, &to = undo ? undone : done;
            if (from.empty()) continue;
            to.push_back(from.back());
            from.pop_back();
        } else if (!std::holds_alternative<PointEvent>(event) && !std::holds_alternative<EndEvent>(event) &&
                   !is_setting(event)) {
            done.push_back(std::holds_alternative<StrokeEvent>(event));
            undone.clear();
        }
    }
    return static_cast<int>(std::ranges::count(done, true));
}

void require_in_order(const Journal& journal) {
    EventOrder order;
    for (const auto& [line, event] : journal.entries) {
        if (std::holds_alternative<PointEvent>(event) && order.fit(event) == EventOrder::Fit::nowhere)
            fail("{}:{}: {}", journal.source, line, why_nowhere(order));
        order.take(event);
    }
}

Journal recovered_journal(const std::filesystem::path& path, const Presets& presets) {
    return Reading(path, presets, true).read();
}

}  // namespace tangi
