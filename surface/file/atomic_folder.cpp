#include "surface/file/atomic_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/output_set.h"
#include "surface/file/stale_temporaries.h"
#include "surface/file/version.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Files in a folder, relative to it, and folders in it that hold none, with a slash at their end.
std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_symlink() || !entry.is_directory())
            files.insert(entry.path().lexically_relative(folder).generic_string());
        else if (fs::is_empty(entry.path()))
            files.insert(entry.path().lexically_relative(folder).generic_string() + "/");
    return files;
}

std::set<std::string> listed_in(const fs::path& list) {
    std::set<std::string> files;
    if (!fs::is_regular_file(list)) return files;
    const nlohmann::json content = json_or_discarded(read_text_file(list));
    if (!content.is_object() || !content.contains("files") || !content["files"].is_array()) return files;
    for (const nlohmann::json& file : content["files"])
        if (file.is_string()) files.insert(file.get<std::string>());
    files.insert(list.filename().string());
    return files;
}

}  // namespace

bool exchange_folders(const fs::path& from, const fs::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0) return true;
    if (errno != EINVAL && errno != ENOSYS) return false;
    const fs::path aside = from.string() + ".old";
    if (::rename(to.c_str(), aside.c_str()) != 0) return false;
    if (::rename(from.c_str(), to.c_str()) != 0) {
        const int reason = errno;
        if (::rename(aside.c_str(), to.c_str()) == 0) errno = reason;
        return false;
    }
    return ::rename(aside.c_str(), from.c_str()) == 0;
}

void told_of(const fs::path& temporary, const fs::path& target, const std::function<void()>& write) {
    try {
        write();
    } catch (const Error& error) {
        std::string words = error.what();
        const std::string hidden = temporary.string(), shown = target.string();
        if (words.find(hidden) == std::string::npos) throw;
        for (std::size_t at = 0; (at = words.find(hidden, at)) != std::string::npos; at += shown.size())
            words.replace(at, hidden.size(), shown);
        throw Error(words);
    }
}

void AtomicFolder::require_own() const {
    const std::set<std::string> own = listed_in(target_ / contents_);
    for (const std::string& file : files_in(target_))
        if (!own.contains(file))
            fail("{}: holds {}, which is not of an earlier export; name another folder, or an empty one",
                 target_.string(), file);
}

AtomicFolder::AtomicFolder(fs::path target, std::string contents)
    : target_(std::move(target)), contents_(std::move(contents)) {
    if (!target_.has_filename() && target_.has_relative_path()) target_ = target_.parent_path();  // "a/"
    if (fs::exists(target_)) target_ = fs::canonical(target_);  // what a link or "." means
    if (target_.filename().empty()) fail("{}: is not the name of a folder to write", target_.string());
    const fs::path parent = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    if (fs::exists(target_)) {
        if (!fs::is_directory(target_)) fail("{}: is a file; give the name of a folder", target_.string());
        require_own();
    }
    make_folder(parent);
    const std::string name = target_.filename().string();
    tidy_folder(parent);
    remove_stale_temporaries(target_, name, "");
    temporary_ = parent / temporary_name(name, "");
    std::error_code status;
    fs::remove_all(temporary_, status);
    fs::create_directory(temporary_, status);
    if (status) fail("{}: cannot be written: {}", target_.string(), status.message());
}

AtomicFolder::~AtomicFolder() {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);  // what was replaced, or what was not finished
}

std::vector<std::string> AtomicFolder::commit() {
    const std::set<std::string> files = files_in(temporary_);
    const fs::path contents = temporary_ / contents_;
    nlohmann::json list = nlohmann::json::object();
    if (files.contains(contents_)) list = read_json(read_text_file(contents), contents.string());
    list["files"] = files;
    list["software"] = program_name();
    told_of(temporary_, target_, [&] { write_text_file(contents, json_lines(list)); });
    const bool replaces = fs::exists(target_);
    if (replaces) require_own();  // still
    const bool placed =
        replaces ? exchange_folders(temporary_, target_) : ::rename(temporary_.c_str(), target_.c_str()) == 0;
    if (!placed) fail("{}: cannot be put in place: {}", target_.string(), std::strerror(errno));
    sync_folder(target_.has_parent_path() ? target_.parent_path() : fs::path("."), target_);
    return {files.begin(), files.end()};
}

MadeFolders::~MadeFolders() {
    std::error_code not_empty;
    while (!made_.empty()) {
        fs::remove(made_.back(), not_empty);
        made_.pop_back();
    }
}

void MadeFolders::make(const fs::path& folder) {
    std::vector<fs::path> missing;
    std::error_code unknown;
    for (fs::path path = folder; !path.empty() && !fs::exists(path, unknown) && !unknown;
         path = path.parent_path()) {
        if (path.has_filename()) missing.push_back(path);
        if (!path.has_relative_path()) break;
    }
    made_.insert(made_.end(), missing.rbegin(), missing.rend());
    make_folder(folder);
}

FolderFiles::FolderFiles(fs::path folder) : folder_(std::move(folder)) {
    if (!folder_.has_filename() && folder_.has_relative_path()) folder_ = folder_.parent_path();  // "a/"
    std::error_code status;
    is_new_ = fs::symlink_status(folder_, status).type() == fs::file_type::not_found;
    const fs::path parent = folder_.has_parent_path() ? folder_.parent_path() : fs::path(".");
    told_of(parent, is_new_ && parent != "." ? folder_ : parent,
            [&] { made_.make(is_new_ ? parent : folder_); });
    const fs::path beside = is_new_ ? parent : folder_;
    tidy_folder(beside);
    const std::string name = is_new_ ? folder_.filename().string() : kWithinFolder;
    remove_stale_temporaries(beside / name, name, "");
    temporary_ = beside / temporary_name(name, "");
    fs::remove_all(temporary_, status);
    fs::create_directory(temporary_, status);
    if (status) fail("{}: cannot be made a folder: {}", folder_.string(), status.message());
}

FolderFiles::~FolderFiles() {
    std::error_code ignored;
    if (!left_) fs::remove_all(temporary_, ignored);
}

std::vector<FolderFiles::Move> FolderFiles::moves() {
    const fs::path folder = temporary_.parent_path(), hidden = temporary_.filename(),
                   place = is_new_ ? folder_.filename() : fs::path();
    if (is_new_ && !fs::exists(folder_)) return {{folder, hidden, place, folder_}};
    const std::set<std::string> all = files_in(temporary_);
    std::vector<std::string> files(all.begin(), all.end());
    std::ranges::stable_sort(files, std::greater(),
                             [](const std::string& file) { return std::ranges::count(file, '/'); });
    std::vector<Move> moves;
    for (const std::string& file : files) {
        made_.make((folder_ / file).parent_path());
        tidy_folder((folder_ / file).parent_path());
        if (!file.ends_with('/')) moves.push_back({folder, hidden / file, place / file, folder_ / file});
    }
    return moves;
}

void FolderFiles::placed(bool cleaned) {
    made_.keep();
    left_ = !cleaned;  // who looks at the folder now sees what was written
    std::error_code ignored;
    if (cleaned) fs::remove_all(temporary_, ignored);
}

void FolderFiles::place() {
    OutputSet set;
    set.add(*this);
    set.commit();
}

}  // namespace tangi
