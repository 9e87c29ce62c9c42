#include "viewer/sitting.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "surface/atomic_file.h"
#include "surface/error.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& file) {
    std::error_code unknown;
    return fs::exists(file, unknown);
}

// The events of two journals as the text of one; `maybe_there`: those of the second may end the first
// already.
std::string joined(const std::string& first, const std::string& second, bool maybe_there = false) {
    if (first.empty() || second.empty()) return first + second;
    const auto first_line = second.find('\n');  // the format's name
    const std::string events =
        first_line == std::string::npos ? std::string() : second.substr(first_line + 1);
    return maybe_there && first.ends_with(events) ? first : first + events;
}

std::string text_of(const fs::path& journal) {
    return is_there(journal) ? whole_lines(read_text_file(journal)) : std::string();
}

std::string text_of(const std::deque<Event>& events) {
    std::vector<Journal::Entry> entries;
    for (const Event& event : events) entries.push_back({0, event});
    return entries.empty() ? std::string() : journal_text(entries);
}

// A name beside the painting that is free: x.discarded.jsonl, x.discarded-2.jsonl.
fs::path free_name(const SittingFiles& files, std::string_view why) {
    for (int i = 1;; ++i) {
        fs::path kept = files.painting;
        kept.replace_extension(i == 1 ? fmt::format(".{}.jsonl", why) : fmt::format(".{}-{}.jsonl", why, i));
        if (!is_there(kept)) return kept;
    }
}

void put_aside(const SittingFiles& files, std::string_view why) {
    if (!is_there(files.unsaved)) return;
    const fs::path kept = free_name(files, why);
    std::error_code failed;
    fs::rename(files.unsaved, kept, failed);
    if (failed)
        fail("{}: cannot be renamed to {}: {}", files.unsaved.string(), kept.filename().string(),
             failed.message());
}

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

}  // namespace

SittingFiles sitting_files(const fs::path& painting) {
    const auto beside = [&](const char* ending) {
        fs::path path = painting;
        return path.replace_extension(ending);
    };
    return {painting, beside(".unsaved.jsonl"), beside(".strokes.jsonl")};
}

std::optional<Journal> left_over(const SittingFiles& files) {
    if (!is_there(files.unsaved) || is_older(files.unsaved, files.painting)) return {};
    Journal journal = recovered_journal(files.unsaved);
    if (journal.entries.empty() && journal.lines_lost > 0)
        fail("{}:{}: {}", journal.source, journal.warnings.front().line, journal.warnings.front().text);
    if (journal.entries.empty()) return {};
    return journal;
}

void SittingRecord::append(const Event& event) {
    waiting_.push_back(event);
    write_waiting();
}

void SittingRecord::sync() {
    settle();
    write_waiting();
    if (writer_) writer_->sync();
}

void SittingRecord::write_waiting() {
    if (waiting_.empty()) return;
    settle();  // of the sitting before
    if (!writer_) begin();
    while (!waiting_.empty()) {
        writer_->append(waiting_.front());
        waiting_.pop_front();
    }
}

void SittingRecord::begin() {
    std::error_code unknown;
    if (!ours_ && fs::is_regular_file(files_.unsaved, unknown)) put_older_away();
    writer_ = std::make_unique<JournalWriter>(files_.unsaved);
    ours_ = true;
}

// What lies there is not on the canvas, or in the painting's file already: what was saved by a program that
// died before it could put the journal away must not be recovered together with what follows, and what was
// neither saved nor recovered must not become a part of the record.
void SittingRecord::put_older_away() {
    std::optional<Journal> older;
    try {
        older = recovered_journal(files_.unsaved);
    } catch (const Error&) {  // it is none, or of another version
    }
    if (!older || !is_older(files_.unsaved, files_.painting)) {
        if (!older || !older->entries.empty() || older->lines_lost > 0) put_aside(files_, "unread");
        return;
    }
    if (!older->entries.empty()) {
        const bool whole = older->lines_lost == 0;
        write_text_file(files_.record,
                        joined(text_of(files_.record),
                               whole ? text_of(files_.unsaved) : journal_text(older->entries), true));
        if (!whole) put_aside(files_, "unread");
    }
    fs::remove(files_.unsaved);
}

void SittingRecord::take_over(std::span<const Journal::Entry> events, bool all_of_it) {
    writer_.reset();
    ours_ = all_of_it;
    if (all_of_it) {
        begin();  // ends a stroke that was cut off, as it is on the canvas
        return;
    }
    for (const Journal::Entry& entry : events) waiting_.push_back(entry.event);
    write_waiting();
}

void SittingRecord::let_time_pass() const {
    std::error_code none;
    const auto last = fs::last_write_time(files_.unsaved, none);
    if (!none) std::this_thread::sleep_until(last + std::chrono::milliseconds(20));
}

void SittingRecord::put_away() {
    settle();
    if (empty()) return;
    writer_.reset();
    std::error_code failed;
    if (waiting_.empty() && !is_there(files_.record)) {
        fs::rename(files_.unsaved, files_.record, failed);
        if (!failed) {
            ours_ = false;
            return;
        }
    }
    owed_ = {joined(text_of(files_.record),
                    joined(ours_ ? text_of(files_.unsaved) : std::string(), text_of(waiting_))),
             true};
    ours_ = false;
    waiting_.clear();
    settle();
}

void SittingRecord::settle() {
    if (!owed_) return;
    if (!owed_->text.empty())
        write_text_file(files_.record, owed_->text);
    else if (!owed_->with_unsaved)
        remove_if_possible(files_.record);  // of another painting of that name
    if (owed_->with_unsaved) remove_if_possible(files_.unsaved);
    owed_.reset();
}

void SittingRecord::discard() {
    writer_.reset();
    ours_ = false;
    put_aside(files_, "discarded");
}

void SittingRecord::move_to(const SittingFiles& files) {
    writer_.reset();
    const SittingFiles left = std::exchange(files_, files);
    const bool was_ours = std::exchange(ours_, false);
    const std::string waited = text_of(std::exchange(waiting_, {}));
    // That the painting has another name is so, whatever the files of the record do.
    owed_ = {joined(owed_ ? owed_->text : text_of(left.record),
                    joined(was_ours ? text_of(left.unsaved) : std::string(), waited))};
    put_aside(files_, "discarded");
    settle();
    if (was_ours) remove_if_possible(left.unsaved);
}

void SittingRecord::leave_for(const SittingFiles& files) {
    writer_.reset();
    const SittingFiles left = std::exchange(files_, files);
    ours_ = false;
    owed_ = {text_of(left.record)};
    put_aside(files_, "discarded");
    settle();
}

}  // namespace tangi
