// held_file.h: a file without content that stands for something which one process at a time has (flock). The
// system gives it back however a program ends.
#pragma once

#include <filesystem>

namespace tangi {

class HeldFile {
public:
    enum class Taken {
        yes,
        by_another,
        cannot  // there is no place for the file, or the file system has no locks: it is nobody's
    };

    HeldFile() = default;
    ~HeldFile() { give_back(); }
    HeldFile(HeldFile&& other) noexcept;
    HeldFile& operator=(HeldFile&& other) noexcept;

    // Makes the file; does not wait. What was held before is given back where it succeeds.
    Taken take(const std::filesystem::path& file);
    void give_back();  // and removes it
    bool is_held(const std::filesystem::path& file) const { return descriptor_ >= 0 && file == file_; }

private:
    int descriptor_ = -1;
    std::filesystem::path file_;
};

// What flock() without waiting says of a descriptor, which may be none (-1).
HeldFile::Taken lock_at_once(int descriptor);

}  // namespace tangi
