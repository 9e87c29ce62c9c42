#include "viewer/sitting.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "surface/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// The events of two journals as the text of one; `maybe_there`: those of the second may end the first
// already.
std::string joined(const fs::path& first, const fs::path& second, bool maybe_there = false) {
    if (!fs::exists(second)) return fs::exists(first) ? read_text_file(first) : "";
    if (!fs::exists(first)) return read_text_file(second);
    std::string all = read_text_file(first);
    if (!all.empty() && all.back() != '\n') all += '\n';
    std::string more = read_text_file(second);
    more.resize(more.rfind('\n') + 1);        // a torn line counts for nothing
    const auto first_line = more.find('\n');  // the format's name
    const std::string events = first_line == std::string::npos ? std::string() : more.substr(first_line + 1);
    return maybe_there && all.ends_with(events) ? all : all + events;
}

void put_aside(const SittingFiles& files) {
    if (!fs::exists(files.unsaved)) return;
    fs::path kept = files.painting;
    kept.replace_extension(".discarded.jsonl");
    for (int i = 2; fs::exists(kept); ++i) {
        kept = files.painting;
        kept.replace_extension(fmt::format(".discarded-{}.jsonl", i));
    }
    fs::rename(files.unsaved, kept);
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
    if (!fs::exists(files.unsaved)) return {};
    if (fs::exists(files.painting) &&
        fs::last_write_time(files.unsaved) < fs::last_write_time(files.painting))
        return {};
    Journal journal = read_journal(files.unsaved);
    if (journal.entries.empty()) return {};
    return journal;
}

void SittingRecord::append(const Event& event) {
    if (!writer_) {
        // What was saved by a program that died before it could put the journal away must not be recovered
        // together with what follows.
        if (fs::is_regular_file(files_.unsaved) && !left_over(files_)) {
            read_journal(files_.unsaved);  // it is one
            move_to_record(true);
        }
        writer_ = std::make_unique<JournalWriter>(files_.unsaved);
    }
    writer_->append(event);
}

void SittingRecord::sync() {
    if (writer_) writer_->sync();
}

void SittingRecord::let_time_pass() const {
    std::error_code none;
    const auto last = fs::last_write_time(files_.unsaved, none);
    if (!none) std::this_thread::sleep_until(last + std::chrono::milliseconds(20));
}

void SittingRecord::put_away() {
    writer_.reset();
    if (fs::exists(files_.unsaved)) move_to_record(false);
}

void SittingRecord::move_to_record(bool maybe_there) {
    if (!fs::exists(files_.record)) {
        fs::rename(files_.unsaved, files_.record);
        return;
    }
    write_text_file(files_.record, joined(files_.record, files_.unsaved, maybe_there));
    fs::remove(files_.unsaved);
}

void SittingRecord::discard() {
    writer_.reset();
    put_aside(files_);
}

void SittingRecord::move_to(const SittingFiles& files) {
    writer_.reset();
    put_aside(files);
    const std::string all = joined(files_.record, files_.unsaved);
    if (!all.empty())
        write_text_file(files.record, all);
    else
        fs::remove(files.record);
    fs::remove(files_.unsaved);
    files_ = files;
}

void SittingRecord::leave_for(const SittingFiles& files) {
    writer_.reset();
    put_aside(files);
    if (fs::exists(files_.record))
        write_text_file(files.record, read_text_file(files_.record));
    else
        fs::remove(files.record);
    files_ = files;
}

}  // namespace tangi
