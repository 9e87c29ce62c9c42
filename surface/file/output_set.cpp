#include "surface/file/output_set.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

fs::path whole(const fs::path& folder) {
    std::error_code unknown;
    const fs::path path = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, unknown);
    return unknown ? fs::absolute(folder) : path;
}

// Folders that moves write names to.
std::set<fs::path> folders_of(const fs::path& folder, const std::vector<OutputMove>& moves) {
    std::set<fs::path> folders;
    for (const OutputMove& move : moves) folders.insert((folder / move.to).parent_path());
    return folders;
}

void finish(const fs::path& folder, const OutputRecord& record) {
    try {
        for (const OutputMove& move : record.moves) {
            make_folder((folder / move.to).parent_path());
            move.forward(folder);
        }
    } catch (const Error& error) {
        fail(
            "{}; a program was stopped while it put this file in place with others, and the rest of it is "
            "to come first",
            error.what());
    }
    for (const fs::path& changed : folders_of(folder, record.moves)) sync_folder(changed, changed);
    for (const OutputMove& move : record.moves) move.clean(folder);
}

void settle_record(const fs::path& path) {
    fs::path first;
    {
        RecordFile file(path);
        if (!file.is_there()) return;
        const std::optional<OutputRecord> record = record_in(read_text_file(path));
        const fs::path folder = path.parent_path();
        if (!record || !record->stays_within(folder)) return;  // not one of ours
        if (record->first && fs::exists(folder / *record->first / path.filename())) {
            first = folder / *record->first / path.filename();
        } else if (record->first) {
            file.remove();  // the set was not on the disk yet when its program was stopped
        } else {
            finish(folder, *record);
            for (const fs::path& other : record->elsewhere) {
                const fs::path beside = folder / other / path.filename();
                RecordFile second(beside);
                if (!second.is_there()) continue;
                if (const auto its = record_in(read_text_file(beside));
                    its && its->first && its->stays_within(beside.parent_path()))
                    finish(beside.parent_path(), *its);
                second.remove();
            }
            file.remove();
        }
    }
    if (!first.empty()) settle_record(first);
}

}  // namespace

void OutputSet::add(AtomicFile& file) {
    sync_to_disk(file.temporary_, file.target_);
    const fs::path folder = whole(file.place_.parent_path());
    parts_.push_back(
        {folder, {OutputMove::Kind::put, file.temporary_.filename(), file.place_.filename()}, file.target_});
    when_done_.emplace_back([&file](bool) { file.committed_ = true; });
}

void OutputSet::add(FolderFiles& files) {
    for (auto& [folder, from, to, named] : files.moves())
        parts_.push_back({whole(folder), {OutputMove::Kind::put, from, to}, named});
    when_done_.emplace_back([&files](bool cleaned) { files.placed(cleaned); });
}

void OutputSet::add_folder(const fs::path& temporary, const fs::path& target,
                           std::function<void(bool)> when_done) {
    parts_.push_back({whole(target.parent_path()),
                      {OutputMove::Kind::put, temporary.filename(), target.filename()},
                      target});
    when_done_.push_back(std::move(when_done));
}

void OutputSet::withdraw(const fs::path& folder, const fs::path& file) {
    std::error_code unknown;
    if (!fs::exists(fs::symlink_status(folder / file, unknown))) return;
    std::string stem = file.generic_string() + "-withdrawn";
    std::ranges::replace(stem, '/', '-');
    parts_.push_back(
        {whole(folder), {OutputMove::Kind::withdraw, temporary_name(stem, ""), file}, folder / file});
}

void OutputSet::done(bool cleaned) {
    for (const auto& tell : when_done_) tell(cleaned);
    parts_.clear();
    when_done_.clear();
}

void OutputSet::commit() {
    std::vector<std::unique_ptr<RecordFile>> records;
    // A folder that is replaced is two names that change.
    const bool replaces_folder = std::ranges::any_of(parts_, [](const Part& part) {
        return fs::is_directory(part.folder / part.move.from) && fs::is_directory(part.folder / part.move.to);
    });
    if (parts_.size() > 1 || replaces_folder) {
        std::map<fs::path, OutputRecord> by_folder;
        for (const Part& part : parts_) by_folder[part.folder].moves.push_back(part.move);
        for (const auto& [folder, record] : by_folder) tidy_folder(folder);
        const fs::path first = parts_.front().folder;
        const std::string name = new_record_name();
        for (auto& [folder, record] : by_folder)
            if (folder != first) {
                record.first = first.lexically_relative(folder);
                by_folder[first].elsewhere.push_back(folder.lexically_relative(first));
            }
        for (const auto& [folder, record] : by_folder)
            if (folder != first)
                records.push_back(std::make_unique<RecordFile>(folder / name, record, parts_.front().named));
        records.push_back(std::make_unique<RecordFile>(first / name, by_folder[first], parts_.front().named));
    }
    put_in_place(records);
    for (const Part& part : parts_) part.move.clean(part.folder);
    for (const auto& record : records) record->remove();  // the first one last
    const std::vector<Part> parts = parts_;
    done(true);
    if (records.empty())
        for (const Part& part : parts) sync_folder(part.folder, part.named);
}

void OutputSet::put_in_place(std::vector<std::unique_ptr<RecordFile>>& records) {
    std::size_t moved = 0;
    try {
        if (!records.empty())
            for (const Part& part : parts_) part.move.prepare(part.folder);
        for (const auto& record : records) record->place();
        for (const Part& part : parts_) {
            told_of(part.folder / part.move.to, part.named, [&] { part.move.forward(part.folder); });
            ++moved;
        }
        std::set<fs::path> changed;
        for (const Part& part : parts_) changed.insert((part.folder / part.move.to).parent_path());
        if (!records.empty())
            for (const fs::path& folder : changed) sync_folder(folder, parts_.front().named);
    } catch (const Error&) {
        take_back(moved, records);
        throw;
    }
}

void OutputSet::take_back(std::size_t moved, std::vector<std::unique_ptr<RecordFile>>& records) {
    try {
        for (std::size_t i = moved; i-- > 0;) parts_[i].move.back(parts_[i].folder);
    } catch (const Error& error) {
        // The records stay, and with them what they name: it is all there for who finishes it.
        done(false);
        fail("{}; the next command that works here tries it again", error.what());
    }
    // From the first one on: without it, the others say nothing.
    for (std::size_t i = records.size(); i-- > 0;) records[i]->remove();
    std::error_code ignored;
    for (const Part& part : parts_) fs::remove(part.folder / part.move.aside(), ignored);
}

void settle_outputs(const fs::path& folder) {
    std::vector<fs::path> records;
    std::error_code unreadable;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
        if (is_record_name(entry->path().filename().string())) records.push_back(entry->path());
    std::ranges::sort(records);
    for (const fs::path& record : records) settle_record(record);
}

void settle_outputs_at(const fs::path& path) {
    std::error_code missing;
    const fs::path place = fs::weakly_canonical(path, missing);
    if (missing) return;
    settle_outputs(place.parent_path());
    if (fs::is_directory(place, missing)) settle_outputs(place);
}

void tidy_folder(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> tidied;
    {
        const std::lock_guard lock(mutex);
        if (!tidied.insert(folder).second) return;
    }
    settle_outputs(folder);
    sweep_temporaries(folder);
}

}  // namespace tangi
