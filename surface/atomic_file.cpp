#include "surface/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "surface/error.h"
#include "surface/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

void sync_to_disk(const fs::path& path, const fs::path& named) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool synced = file >= 0 && ::fsync(file) == 0;
    const int reason = errno;
    if (file >= 0) ::close(file);
    if (!synced) fail("{}: cannot be written to disk: {}", named.string(), std::strerror(reason));
}

}  // namespace

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
    if (fs::is_directory(target_)) fail("{}: is a folder; give the name of a file", target_.string());
    const fs::path folder = place_.has_parent_path() ? place_.parent_path() : fs::path(".");
    if (!fs::is_directory(folder))
        fail("{}: there is no folder {}; make it, or choose another place", target_.string(),
             folder.string());
    remove_stale_temporaries(place_, place_.stem().string(), target_.extension().string());
    temporary_ = folder / temporary_name(place_.stem().string(), target_.extension().string());
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0 && errno == ENOENT)  // /proc and the like: the folder is there, as was seen
        fail("{}: cannot be written: {} takes no files; choose another folder", target_.string(),
             folder.string());
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
    std::ofstream stream(temporary_, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) fail("{}: cannot be written: {}", target_.string(), std::strerror(errno));
    sync_to_disk(temporary_, target_);  // a full disk may show only then
}

void AtomicFile::commit() {
    sync_to_disk(temporary_, target_);
    std::error_code status;
    fs::rename(temporary_, place_, status);
    if (status) fail("{}: cannot be put in place: {}", target_.string(), status.message());
    committed_ = true;
    // The new name is safe only once its folder is; a file system that cannot sync folders is no reason to
    // fail.
    const fs::path folder = place_.has_parent_path() ? place_.parent_path() : fs::path(".");
    const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle >= 0) {
        ::fsync(handle);
        ::close(handle);
    }
}

void write_text_file(const fs::path& path, std::string_view text) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

std::string read_text_file(const fs::path& path) {
    if (fs::is_directory(path)) fail("{}: is a folder; give the name of a file", path.string());
    std::ifstream stream(path, std::ios::binary);
    if (!stream) fail("{}: cannot be read: {}", path.string(), std::strerror(errno));
    return {std::istreambuf_iterator<char>(stream), {}};
}

void make_folder(const fs::path& path) {
    std::error_code status;
    fs::create_directories(path, status);
    if (status || !fs::is_directory(path))
        fail("{}: cannot be made a folder: {}", path.string(),
             status ? status.message() : "a file has that name");
}

}  // namespace tangi
