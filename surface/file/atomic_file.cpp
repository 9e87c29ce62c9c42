#include "surface/file/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <span>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/file_name.h"
#include "surface/file/output_set.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

class Descriptor {
public:
    Descriptor(const fs::path& path, int flags) : number_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }

    // How many bytes were read, 0 at the end; below 0 with errno.
    ssize_t read(std::span<char> to) const {
        ssize_t count = 0;
        do count = ::read(number_, to.data(), to.size());
        while (count < 0 && errno == EINTR);
        return count;
    }

    // False, with errno.
    bool write(std::string_view bytes) const {
        while (!bytes.empty()) {
            const ssize_t count = ::write(number_, bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return false;
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
        return true;
    }

private:
    int number_;
};

[[noreturn]] void cannot_be_written(const fs::path& target) {
    fail("{}: cannot be written: {}", target.string(), std::strerror(errno));
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

void sync_to_disk(const fs::path& path, const fs::path& named) {
    const Descriptor file(path, O_RDONLY);
    if (file.number() < 0 || ::fsync(file.number()) != 0)
        fail("{}: cannot be written to disk: {}", named.string(), std::strerror(errno));
}

void sync_folder(const fs::path& folder, const fs::path& named) {
    const Descriptor handle(folder, O_RDONLY | O_DIRECTORY);
    if (handle.number() < 0 || ::fsync(handle.number()) == 0) return;
    if (errno == EIO || errno == ENOSPC || errno == EDQUOT)
        fail("{}: is in place, but the disk does not say that it holds it: {}", named.string(),
             std::strerror(errno));
}

fs::path where_links_lead(fs::path path) {
    std::error_code unreadable;  // then it is for those who open it to say why
    for (int links = 0; fs::is_symlink(path, unreadable); ++links) {
        if (links == 40) fail("{}: is a link that leads round in a circle", path.string());
        const fs::path next = fs::read_symlink(path, unreadable);
        if (unreadable) break;
        path = path.parent_path() / next;
    }
    return path;
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)), place_(where_links_lead(target_)) {
    if (target_.filename().empty()) fail("{}: is not a file name", target_.string());
    std::error_code unknown;  // a folder that cannot be looked into: making the file says why
    if (fs::is_directory(target_, unknown))
        fail("{}: is a folder; give the name of a file", target_.string());
    const fs::path folder = folder_of(place_);
    if (const std::string told = told_of_length(place_); !told.empty())
        fail("{}: {}", shortened(target_.string()), told);
    if (!fs::is_directory(folder, unknown) && unknown != std::errc::permission_denied)
        fail("{}: there is no folder {}; make it, or choose another place", target_.string(),
             folder.string());
    tidy_folder(folder);
    remove_stale_temporaries(place_, place_.stem().string(), target_.extension().string());
    temporary_ = folder / temporary_name(place_.stem().string(), target_.extension().string());
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0 && errno == ENOENT)  // /proc and the like: the folder is there, as was seen
        fail("{}: cannot be written: {} takes no files; choose another folder", target_.string(),
             folder.string());
    if (file < 0 && errno != EACCES && errno != EPERM && errno != EROFS) cannot_be_written(target_);
    if (file < 0)
        fail("{}: cannot be written: {}; choose a folder where you may write", target_.string(),
             std::strerror(errno));
    ::close(file);
}

AtomicFile::~AtomicFile() {
    std::error_code ignored;
    if (!committed_) fs::remove(temporary_, ignored);
}

void AtomicFile::write(std::string_view bytes) {
    const Descriptor file(temporary_, O_WRONLY | O_TRUNC);
    if (file.number() < 0 || !file.write(bytes)) cannot_be_written(target_);
    sync_to_disk(temporary_, target_);  // a full disk may show only then
}

void AtomicFile::copy_from(const fs::path& from) {
    constexpr std::size_t kAtOnce = 1 << 20;  // [bytes]
    const Descriptor source(from, O_RDONLY);
    if (source.number() < 0) fail("{}: cannot be read: {}", from.string(), std::strerror(errno));
    const Descriptor file(temporary_, O_WRONLY | O_TRUNC);
    if (file.number() < 0) cannot_be_written(target_);
    for (std::string bytes(kAtOnce, '\0');;) {
        const ssize_t count = source.read(bytes);
        if (count < 0) fail("{}: cannot be read: {}", from.string(), std::strerror(errno));
        if (count == 0) break;
        if (!file.write({bytes.data(), static_cast<std::size_t>(count)})) cannot_be_written(target_);
    }
    sync_to_disk(temporary_, target_);
}

void AtomicFile::commit() {
    sync_to_disk(temporary_, target_);
    std::error_code status;
    fs::rename(temporary_, place_, status);
    if (status) fail("{}: cannot be put in place: {}", target_.string(), status.message());
    committed_ = true;
    sync_folder(folder_of(place_), target_);  // the new name is safe only once its folder is
}

void write_text_file(const fs::path& path, std::string_view text) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

std::string read_text_file(const fs::path& path) {
    if (fs::is_directory(path)) fail("{}: is a folder; give the name of a file", path.string());
    const Descriptor file(path, O_RDONLY);
    std::array<char, 65536> bytes;
    std::string text;
    while (true) {
        const ssize_t count = file.number() < 0 ? -1 : file.read(bytes);
        if (count < 0) fail("{}: cannot be read: {}", path.string(), std::strerror(errno));
        if (count == 0) return text;
        text.append(bytes.data(), static_cast<std::size_t>(count));
    }
}

void make_folder(const fs::path& path) {
    std::error_code status;
    fs::create_directories(path, status);
    if (status || !fs::is_directory(path))
        fail("{}: cannot be made a folder: {}", path.string(),
             status ? status.message() : "a file has that name");
}

}  // namespace tangi
