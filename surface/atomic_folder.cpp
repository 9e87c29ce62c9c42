#include "surface/atomic_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Files in a folder, relative to it.
std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_symlink() || !entry.is_directory())
            files.insert(entry.path().lexically_relative(folder).generic_string());
    return files;
}

std::set<std::string> listed_in(const fs::path& list) {
    std::set<std::string> files;
    if (!fs::is_regular_file(list)) return files;
    const nlohmann::json content = nlohmann::json::parse(read_text_file(list), nullptr, false);
    if (!content.is_object() || !content.contains("files") || !content["files"].is_array()) return files;
    for (const nlohmann::json& file : content["files"])
        if (file.is_string()) files.insert(file.get<std::string>());
    files.insert(list.filename().string());
    return files;
}

void require_own(const fs::path& folder, const std::string& contents) {
    const std::set<std::string> own = listed_in(folder / contents);
    for (const std::string& file : files_in(folder))
        if (!own.contains(file))
            fail("{}: holds {}, which is not of an earlier export; name another folder, or an empty one",
                 folder.string(), file);
}

// Puts `from` where `to` is, and `to` where `from` was, at once where the file system can.
bool exchange(const fs::path& from, const fs::path& to) {
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

}  // namespace

AtomicFolder::AtomicFolder(fs::path target, std::string contents)
    : target_(std::move(target)), contents_(std::move(contents)) {
    if (!target_.has_filename() && target_.has_relative_path()) target_ = target_.parent_path();  // "a/"
    if (fs::exists(target_)) target_ = fs::canonical(target_);  // what a link or "." means
    if (target_.filename().empty()) fail("{}: is not the name of a folder to write", target_.string());
    const fs::path parent = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    if (fs::exists(target_)) {
        if (!fs::is_directory(target_)) fail("{}: is a file; give the name of a folder", target_.string());
        require_own(target_, contents_);
    }
    make_folder(parent);
    const std::string name = target_.filename().string();
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
    const nlohmann::json list = {{"files", files}};
    try {
        write_text_file(temporary_ / contents_, list.dump(2) + "\n");
    } catch (const Error& error) {
        fail("{}: cannot be written: {}", target_.string(), error.what());
    }
    const bool replaces = fs::exists(target_);
    if (replaces) require_own(target_, contents_);  // still
    const bool placed =
        replaces ? exchange(temporary_, target_) : ::rename(temporary_.c_str(), target_.c_str()) == 0;
    if (!placed) fail("{}: cannot be put in place: {}", target_.string(), std::strerror(errno));
    return {files.begin(), files.end()};
}

}  // namespace tangi
