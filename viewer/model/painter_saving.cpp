// painter_saving.cpp: of the painter: strokes recorded and recovered, the painting saved.
#include "paint/canvas/canvas_hash.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "retouch/treatment/confining_mask.h"
#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"
#include "viewer/model/painter.h"

namespace tangi {

// Painting goes on where it cannot be recorded; but who paints must know that only saving keeps it, and when
// that is over.
void Painter::keep_record(const std::function<void()>& action) {
    try {
        action();
        if (std::exchange(told_of_journal_, false)) say("strokes are recorded again, with those before");
    } catch (const std::exception& error) {
        if (!std::exchange(told_of_journal_, true))
            say(fmt::format(
                "{}; until they can be, strokes are not recorded: make room, or save before you end",
                message_of(error)));
    }
}

void Painter::record(const Event& event) {
    keep_record([&] { record_.append(event); });
    if (std::string note = record_.take_note(); !note.empty()) say(std::move(note));
}

// A journal is painted again with the paints that it was painted with.
void Painter::record_paints() {
    if (!std::exchange(paints_recorded_, true)) record(paints_event(session_.palette()));
}

// A journal begins without a mask.
void Painter::record_mask() {
    if (recorded_mask_ == stops_.name) return;
    recorded_mask_ = stops_.name;
    if (!stops_.name.empty() && masks_.emplace(stops_.name, stops_.png).second)
        unwritten_masks_.insert(stops_.name);
    keep_record([this] { write_masks(); });
    record(ConfineEvent{stops_.name});
}

void Painter::write_masks() {
    while (!unwritten_masks_.empty()) {
        const std::string& name = *unwritten_masks_.begin();
        const std::filesystem::path file = record_.files().unsaved.parent_path() / confining_mask_file(name);
        make_folder(file.parent_path());
        write_text_file(file, masks_.at(name));
        unwritten_masks_.erase(unwritten_masks_.begin());
    }
}

// What is done from now on is of another journal than what was done before.
void Painter::begin_journal() {
    paints_recorded_ = false;
    recorded_mask_.clear();
    masks_.clear();
    unwritten_masks_.clear();
}

bool Painter::is_replaced() const {
    const std::filesystem::path& painting = record_.files().painting;
    const auto now = stamp_of(main_file_of(painting));
    if (!now || now == stamp_) return false;
    if (!stamp_ || !may_be_same(*stamp_, *now)) return true;
    try {
        return hash_of(read_painting(painting)) != hash_of(*dry_);
    } catch (const Error&) {
        return true;
    }
}

// What lies at its place is somebody's work, too.
void Painter::refuse_replaced() const {
    if (is_replaced())
        fail(
            "{}: was replaced or changed by another program since it was opened here; nothing was "
            "overwritten: save under another name",
            record_.files().painting.filename().string());
}

// A mask that a recovered journal names is there, or the event had not been repeated.
void Painter::took_mask(const std::string& name) {
    recorded_mask_ = name;
    if (name.empty()) return;
    const std::filesystem::path file = record_.files().unsaved.parent_path() / confining_mask_file(name);
    masks_.emplace(name, read_text_file(file));
}

void Painter::recover(Journal journal) {
    post([this, journal = std::move(journal)] {
        const PaintsEvent own = paints_event(session_.palette());
        std::vector<Journal::Entry> painted;
        std::string why;
        const auto not_repeated = [&](int line, const char* what) {
            if (why.empty()) why = fmt::format("line {}: {}", line, what);
        };
        for (const Journal::Entry& entry : journal.entries) {
            const EventOrder::Fit fit = order_.fit(entry.event);
            if (fit == EventOrder::Fit::nowhere) {  // as earlier versions recorded
                not_repeated(entry.line, "no stroke is under way there");
                continue;
            }
            if (fit == EventOrder::Fit::after_end) painted.push_back({entry.line, EndEvent{}});
            try {
                apply(entry.event, false);
                painted.push_back(entry);
            } catch (const Error& error) {  // as of an undo that reached back beyond the last save
                not_repeated(entry.line, error.what());
            }
        }
        if (order_.in_stroke()) {
            painted.push_back({0, EndEvent{}});
            apply(EndEvent{}, false);
        }
        // What follows stops where brushes stop now, and is of the paints that are in the box now.
        session_.canvas().confine(stops_.mask);
        session_.apply(own);
        for (const Journal::Entry& entry : painted) {
            if (const auto* mask = std::get_if<ConfineEvent>(&entry.event)) took_mask(mask->mask);
            if (std::holds_alternative<PaintsEvent>(entry.event))
                paints_recorded_ = journal_line(entry.event) == journal_line(own);
        }
        const bool all_of_it = why.empty() && journal.lines_lost == 0 && is_of(journal, saved_hash_);
        keep_record([&] { record_.take_over(painted, all_of_it); });
        {
            const std::lock_guard lock(mutex_);
            news_.brush_goes_on = session_.brush_goes_on();
        }
        const int strokes = strokes_left(painted);
        std::string told = fmt::format("recovered {} stroke{}", strokes, strokes == 1 ? "" : "s");
        if (journal.lines_lost > 0)
            told += fmt::format("; {} damaged line{} could not be", journal.lines_lost,
                                journal.lines_lost == 1 ? "" : "s");
        if (!why.empty()) told += "; not repeated: " + why;
        say(told);
    });
}

void Painter::discard() {
    post([this] {
        record_.discard();
        own_.unsaved = false;
    });
}

void Painter::note_what_is_saved() {
    saved_hash_ = hash_of(session_.canvas(), dry_hash_);
    record_.painting_is(saved_hash_, session_.canvas().ingredients().empty());
}

// The painting and its record are put in place together: a record is never of another state than its
// painting, whenever the program dies, and where one of them cannot be written, neither is.
void Painter::write_files(const std::filesystem::path& to) {
    const std::filesystem::path& from = record_.files().painting;
    settle_outputs_at(to);
    PaintingOutput output(to);
    std::vector<PartToWrite> further;
    // What other modules keep in the file stays: it belongs to the dry layer, which does not change.
    if (!file_is_new_ && std::filesystem::exists(from)) {
        if (is_replaced())
            say(fmt::format(
                "{}: another painting lies there now: what a fit kept beside the maps is not saved",
                from.filename().string()));
        else
            guarded([&] { further = parts_beside_paint(from); });
    }
    if (painted_ && !session_.canvas().ingredients().empty()) add_overview(further, *painted_, *dry_);
    fill_canvas(output, session_.canvas(), {}, with_tools(std::move(further), session_));
    std::string makes = hash_of(session_.canvas(), dry_hash_);
    OutputSet set;
    output.add_to(set);
    const RecoveryFiles files = recovery_files(to);
    const RecoveryRecord::Files kept = record_.add_to(set, files, makes);
    set.commit();
    // From here on it is saved, and has this name.
    saved_hash_ = makes;
    record_.saved_as(files, std::move(makes));
    begin_journal();
    say(fmt::format("saved {}", to.filename().string()));
    if (std::exchange(told_of_journal_, false)) say("strokes are recorded again, with those before");
}

// As a step of a treatment, with its own journal.
void Painter::keep_step() {
    Canvas kept = session_.canvas();
    kept.confine({});
    const auto [said, done] = keep_(kept, {record_.empty() ? std::string() : record_.text(),
                                           record_.files().unsaved, masks_, with_tools({}, session_)});
    say(said);
    if (!done) return;
    adopt(std::move(kept));
    record_.forget();
    begin_journal();
    note_what_is_saved();
}

void Painter::write(const std::filesystem::path& to, bool over) {
    const std::filesystem::path from = record_.files().painting;
    if (hurry_)
        fail("{} was not saved; its strokes can be recovered when it is opened again",
             from.filename().string());
    if (to == from) refuse_elsewhere();
    if (PaintingClaim there; to != from && !there.take(to))
        fail("{} is open in another window: choose another name", to.filename().string());
    const bool keeps = keep_ && to == from;
    if (to == from && (keeps || !over) && is_replaced()) {
        {
            const std::lock_guard lock(mutex_);
            news_.needs_name = true;
        }
        refuse_replaced();
    }
    end_stroke();
    if (keeps)
        keep_step();
    else
        write_files(to);
    file_is_new_ = false;
    stamp_ = stamp_of(main_file_of(to));
    own_.elsewhere = !claim_.take(to);
    mark_saved();
    ++own_.saves;
    const std::lock_guard lock(mutex_);
    file_ = to;
}

void Painter::save() { save_as({}); }

void Painter::save_as(const std::filesystem::path& to) {
    ++saves_waiting_;
    post([this, to] {
        own_.saving = true;
        {
            const std::lock_guard lock(mutex_);
            news_.state.saving = true;
        }
        wake_();
        guarded([&] {
            const std::filesystem::path& own = record_.files().painting;
            std::error_code none;
            write(to.empty() || std::filesystem::equivalent(to, own, none) ? own : to, !to.empty());
        });
        own_.saving = false;
        --saves_waiting_;
    });
}

}  // namespace tangi
