#include "surface/file/held_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace tangi {

namespace {

// Who gives a file back removes it: a lock on one that is gone, or is another by now, is none.
bool is_file(int descriptor, const std::filesystem::path& file) {
    struct stat held = {}, there = {};
    return ::fstat(descriptor, &held) == 0 && ::stat(file.c_str(), &there) == 0 &&
           held.st_dev == there.st_dev && held.st_ino == there.st_ino;
}

}  // namespace

HeldFile::Taken lock_at_once(int descriptor) {
    if (descriptor < 0) return HeldFile::Taken::cannot;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return HeldFile::Taken::yes;
    return errno == EWOULDBLOCK ? HeldFile::Taken::by_another : HeldFile::Taken::cannot;
}

HeldFile::HeldFile(HeldFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), file_(std::move(other.file_)) {}

HeldFile& HeldFile::operator=(HeldFile&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(file_, other.file_);
    return *this;
}

HeldFile::Taken HeldFile::take(const std::filesystem::path& file) {
    if (file.empty()) return Taken::cannot;
    constexpr int kMostTries = 100;  // of files that are removed in between
    for (int tries = 0; tries < kMostTries; ++tries) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        const Taken taken = lock_at_once(descriptor);
        if (taken == Taken::yes && is_file(descriptor, file)) {
            give_back();
            descriptor_ = descriptor;
            file_ = file;
            return taken;
        }
        if (descriptor >= 0) ::close(descriptor);
        if (taken != Taken::yes) return taken;
    }
    return Taken::cannot;
}

void HeldFile::give_back() {
    if (descriptor_ < 0) return;
    (void)::unlink(file_.c_str());  // while it is locked
    ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace tangi
