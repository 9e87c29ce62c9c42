#include "surface/file/append_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "surface/base/error.h"

namespace tangi {

namespace {

[[noreturn]] void cannot_be_written(const std::filesystem::path& path, int reason) {
    fail("{}: cannot be written: {}", path.string(), std::strerror(reason));
}

}  // namespace

AppendFile::AppendFile(std::filesystem::path path, Open how) : path_(std::move(path)) {
    file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | (how == Open::make ? O_CREAT : 0), 0666);
    struct stat status = {};
    if (file_ < 0 || ::fstat(file_, &status) != 0) {
        const int reason = errno;
        if (file_ >= 0) ::close(file_);
        cannot_be_written(path_, reason);
    }
    length_ = static_cast<std::uint64_t>(status.st_size);
}

AppendFile::~AppendFile() { ::close(file_); }

bool AppendFile::cut_rest() {
    int done = 0;
    do done = ::ftruncate(file_, static_cast<off_t>(length_));
    while (done != 0 && errno == EINTR);
    has_rest_ = done != 0;
    return !has_rest_;
}

void AppendFile::require_own_length() const {
    struct stat status = {};
    if (::fstat(file_, &status) != 0) cannot_be_written(path_, errno);
    if (status.st_nlink == 0) fail("{}: was removed by another program meanwhile", path_.string());
    if (static_cast<std::uint64_t>(status.st_size) != length_)
        fail("{}: was changed by another program meanwhile", path_.string());
}

void AppendFile::write_at(std::uint64_t offset, std::string_view bytes) const {
    for (auto at = static_cast<off_t>(offset); !bytes.empty();) {
        const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), at);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) cannot_be_written(path_, written == 0 ? ENOSPC : errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
        at += written;
    }
}

void AppendFile::append(std::string_view record) {
    if (has_rest_ && !cut_rest()) cannot_be_written(path_, errno);
    require_own_length();
    has_rest_ = true;
    try {
        write_at(length_, record);
    } catch (const Error&) {
        cut_rest();
        throw;
    }
    length_ += record.size();
    unsynced_ += record;
    has_rest_ = false;
}

void AppendFile::append_synced(std::string_view record) {
    const std::uint64_t before = length_;
    append(record);
    try {
        sync();
    } catch (const Error&) {
        unsynced_.resize(unsynced_.size() - record.size());
        length_ = before;
        cut_rest();
        throw;
    }
}

void AppendFile::sync() {
    if (is_in_doubt_) {
        require_own_length();
        write_at(length_ - unsynced_.size(), unsynced_);
    }
    if (::fdatasync(file_) != 0) {
        const int reason = errno;
        is_in_doubt_ = true;
        cannot_be_written(path_, reason);
    }
    is_in_doubt_ = false;
    unsynced_.clear();
}

void AppendFile::cut(std::uint64_t length) {
    TP_REQUIRE(length <= length_, "what was not written cannot be kept");
    const std::uint64_t less = std::min<std::uint64_t>(length_ - length, unsynced_.size());
    unsynced_.resize(unsynced_.size() - static_cast<std::size_t>(less));
    length_ = length;
    if (!cut_rest()) cannot_be_written(path_, errno);
}

}  // namespace tangi
