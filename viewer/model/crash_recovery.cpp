#include "viewer/model/crash_recovery.h"

#include <fmt/format.h>

#include <algorithm>

#include "paint/session/journal_file_text.h"
#include "surface/base/error.h"
#include "surface/file/file_name.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Where it cannot be removed, its strokes are offered when the painting is opened again: nothing is lost.
void remove_if_possible(const fs::path& file) {
    std::error_code failed;
    fs::remove(file, failed);
}

bool is_older(const fs::path& a, const fs::path& b) {
    std::error_code unknown;
    const auto time_a = fs::last_write_time(a, unknown);
    if (unknown) return false;
    const auto time_b = fs::last_write_time(b, unknown);
    return !unknown && time_a < time_b;
}

bool holds_no_work(const Journal& journal) {
    return std::ranges::all_of(journal.entries, [](const auto& entry) { return is_setting(entry.event); });
}

void add_file(OutputSet& set, RecoveryRecord::Files& files, const fs::path& path,
              const std::function<void(AtomicFile&)>& fill) {
    auto file = std::make_unique<AtomicFile>(path);
    fill(*file);
    set.add(*file);
    files.push_back(std::move(file));
}

// What is at `from` stays, under a name that is free.
void add_kept(OutputSet& set, RecoveryRecord::Files& files, const RecoveryFiles& beside, const fs::path& from,
              std::string_view why) {
    add_file(set, files, free_name_beside(beside.painting, why, "jsonl"),
             [&](AtomicFile& file) { file.copy_from(from); });
}

}  // namespace

RecoveryFiles recovery_files(const fs::path& painting) {
    return {painting, beside_painting(painting, "unsaved.jsonl"), beside_painting(painting, "strokes.jsonl")};
}

std::optional<Journal> left_over(const RecoveryFiles& files) {
    if (!file_exists(files.unsaved)) return {};
    Journal journal = recovered_journal(files.unsaved);
    if (journal.entries.empty() && journal.lines_lost > 0)
        fail("{}:{}: {}", journal.source, journal.warnings.front().line, journal.warnings.front().text);
    if (holds_no_work(journal)) return {};
    if (journal.head.on.empty() && is_older(files.unsaved, files.painting)) return {};
    return journal;
}

bool is_of(const Journal& journal, const std::string& painting) {
    return journal.head.on.empty() || journal.head.on == painting;
}

void RecoveryRecord::painting_is(std::string hash, bool bare) {
    bare_ = bare;
    if (std::exchange(on_, std::move(hash)) == on_ || !ours_) return;
    // What is recorded is of the painting as it is now: as of a palette on which something was mixed before
    // another step changed the painting.
    writer_.reset();
    write_text_file(files_.unsaved, text());
    waiting_.clear();
}

void RecoveryRecord::append(const Event& event) {
    lines_ += journal_line(event);
    waiting_.push_back(event);
    write_waiting();
}

void RecoveryRecord::sync() {
    write_waiting();
    if (writer_) writer_->sync();
}

void RecoveryRecord::write_waiting() {
    if (waiting_.empty()) return;
    if (!writer_) begin();
    while (!waiting_.empty()) {
        writer_->append(waiting_.front());
        waiting_.pop_front();
    }
}

void RecoveryRecord::begin() {
    std::error_code unknown;
    if (!ours_ && fs::is_regular_file(files_.unsaved, unknown)) put_older_away();
    writer_ = std::make_unique<JournalWriter>(files_.unsaved, JournalHead{on_, {}});
    ours_ = true;
}

// What lies there is not on the canvas: it must neither be recovered together with what follows, nor become a
// part of the record.
void RecoveryRecord::put_older_away() {
    std::optional<Journal> older;
    try {
        older = recovered_journal(files_.unsaved);
    } catch (const Error&) {  // it is none, or of another version
    }
    if (older && older->lines_lost == 0 && holds_no_work(*older)) {
        fs::remove(files_.unsaved);
        return;
    }
    const bool of_another = older && !is_of(*older, on_);
    const std::string kept =
        put_aside(files_.unsaved, files_.painting, of_another ? "other" : "unread", "jsonl");
    note_ = fmt::format(
        "{}: {}; it is kept as {}", files_.unsaved.filename().string(),
        of_another ? "holds strokes of another painting than lies here now" : "was not recovered", kept);
}

void RecoveryRecord::take_over(std::span<const Journal::Entry> events, bool all_of_it) {
    writer_.reset();
    ours_ = all_of_it;
    lines_.clear();
    for (const Journal::Entry& entry : events) lines_ += journal_line(entry.event);
    if (all_of_it) {
        begin();  // ends a stroke that was cut off, as it is on the canvas
        return;
    }
    for (const Journal::Entry& entry : events) waiting_.push_back(entry.event);
    write_waiting();
}

// The events of the painting's record, and what it begins with. None where it is of another painting, cannot
// be read, or is not there.
std::string RecoveryRecord::record_so_far(JournalHead& head) const {
    head = {on_, {}};
    if (!file_exists(files_.record)) return {};
    std::string text = read_text_file(files_.record);
    if (text.find('\n') == std::string::npos)  // as on old Macs
        std::ranges::replace(text, '\r', '\n');
    try {
        const JournalHead found = head_from(text.substr(0, end_of_line(text, 0)), files_.record.string());
        // One of an earlier version does not say what it makes; but what was never painted on has none.
        if (found.makes.empty() ? bare_ : found.makes != on_) return {};
        head = found;
    } catch (const Error&) {
        return {};
    }
    return lines_of_events(text);
}

// The journal at another name: the painting that had it is overwritten, but its strokes may be wanted.
void RecoveryRecord::add_unsaved_of(OutputSet& set, Files& files, const RecoveryFiles& to) const {
    std::error_code unknown;
    if (!fs::is_regular_file(to.unsaved, unknown)) return;
    if (to.painting != files_.painting) add_kept(set, files, to, to.unsaved, "discarded");
    if (to.painting != files_.painting || ours_)
        set.withdraw(to.unsaved.parent_path(), to.unsaved.filename());
}

RecoveryRecord::Files RecoveryRecord::add_to(OutputSet& set, const RecoveryFiles& to,
                                             const std::string& makes) const {
    Files files;
    const bool in_place = to.painting == files_.painting;
    if (in_place && lines_.empty()) return files;
    JournalHead head;
    const std::string so_far = record_so_far(head);
    if (in_place && file_exists(files_.record) && so_far.empty() && head.makes.empty() && head.on == on_)
        add_kept(set, files, to, files_.record, "other-strokes");
    head.makes = makes;
    if (so_far.empty() && lines_.empty())
        set.withdraw(to.record.parent_path(), to.record.filename());  // of a painting that is overwritten
    else
        add_file(set, files, to.record,
                 [&](AtomicFile& file) { file.write(journal_text(head, so_far + lines_)); });
    add_unsaved_of(set, files, to);
    return files;
}

void RecoveryRecord::saved_as(const RecoveryFiles& files, std::string makes) {
    const RecoveryFiles left = std::exchange(files_, files);
    if (ours_ && left.unsaved != files.unsaved) remove_if_possible(left.unsaved);
    forget();
    on_ = std::move(makes);
    bare_ = false;
}

void RecoveryRecord::put_away() {
    OutputSet set;
    const Files files = add_to(set, files_, on_);
    set.commit();
    forget();
}

void RecoveryRecord::forget() {
    writer_.reset();
    ours_ = false;
    lines_.clear();
    waiting_.clear();
}

void RecoveryRecord::discard() {
    forget();
    (void)put_aside(files_.unsaved, files_.painting, "discarded", "jsonl");
}

}  // namespace tangi
