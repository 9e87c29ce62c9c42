#include "viewer/model/painting_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <utility>

namespace tangi {

namespace fs = std::filesystem;

namespace {

bool same_file(const struct stat& a, const struct stat& b) {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// Where this user's programs keep what lasts as long as they run; empty where there is no such folder.
fs::path folder_of_claims() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    std::error_code error;
    fs::path folder = runtime && *runtime
                          ? fs::path(runtime) / "tangipaint"
                          : fs::temp_directory_path(error) / fmt::format("tangipaint-{}", ::geteuid());
    if (error) return {};
    (void)::mkdir(folder.c_str(), 0700);
    // Where all may write, somebody else may have been there first.
    struct stat made = {};
    const bool ours =
        ::lstat(folder.c_str(), &made) == 0 && S_ISDIR(made.st_mode) && made.st_uid == ::geteuid();
    return ours ? folder : fs::path();
}

// The file that stands for a painting's name; empty where there can be none.
fs::path file_for_name(const fs::path& painting) {
    const fs::path folder = folder_of_claims();
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(fs::absolute(painting, error), error);
    if (folder.empty() || error) return {};
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
    for (const char c : whole.native()) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    return folder / fmt::format("{:016x}.lock", hash);
}

}  // namespace

PaintingClaim::PaintingClaim(PaintingClaim&& other) noexcept
    : file_(std::exchange(other.file_, -1)), name_(std::move(other.name_)) {}

PaintingClaim& PaintingClaim::operator=(PaintingClaim&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(name_, other.name_);
    return *this;
}

void PaintingClaim::give_back() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
    name_.give_back();
}

bool PaintingClaim::take(const fs::path& file) {
    const fs::path name = file_for_name(file);
    const bool name_is_ours = name_.is_held(name);
    PaintingClaim next;
    if (!name_is_ours && next.name_.take(name) == HeldFile::Taken::by_another) return false;
    // The new ones first: where it is the file that is held already, nobody gets in between.
    next.file_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat here = {}, held = {};
    const bool file_is_ours = next.file_ >= 0 && file_ >= 0 && ::fstat(next.file_, &here) == 0 &&
                              ::fstat(file_, &held) == 0 && same_file(here, held);
    if (!file_is_ours && lock_at_once(next.file_) == HeldFile::Taken::by_another) return false;
    if (!file_is_ours) std::swap(file_, next.file_);
    if (!name_is_ours) std::swap(name_, next.name_);
    return true;
}

}  // namespace tangi
