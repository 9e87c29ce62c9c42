#include "viewer/painting_claim.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace tangi {

PaintingClaim::PaintingClaim(PaintingClaim&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

PaintingClaim& PaintingClaim::operator=(PaintingClaim&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

void PaintingClaim::give_back() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

bool PaintingClaim::take(const std::filesystem::path& file) {
    // The new one first: where it is the file that is held already, nobody gets in between.
    const int next = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat here = {}, held = {};
    const bool is_ours = next >= 0 && descriptor_ >= 0 && ::fstat(next, &here) == 0 &&
                         ::fstat(descriptor_, &held) == 0 && here.st_dev == held.st_dev &&
                         here.st_ino == held.st_ino;
    if (is_ours) {
        ::close(next);
        return true;
    }
    if (next >= 0 && ::flock(next, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(next);
        return false;
    }
    give_back();
    descriptor_ = next;
    return true;
}

}  // namespace tangi
