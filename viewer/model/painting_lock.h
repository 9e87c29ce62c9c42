// painting_lock.h: a painting is painted in one window at a time.
#pragma once

#include <filesystem>

#include "surface/file/held_file.h"

namespace tangi {

// Two locks (flock), which the system gives back however the program ends: one on the painting's name, for
// this user on this machine, which holds though another program writes the painting anew; and one on its
// file, whatever it is called and wherever it is seen from, which is to be taken again by who writes the
// painting anew.
class PaintingClaim {
public:
    PaintingClaim() = default;
    ~PaintingClaim() { give_back(); }
    PaintingClaim(PaintingClaim&& other) noexcept;
    PaintingClaim& operator=(PaintingClaim&& other) noexcept;

    // False where another window has the file or the name. What is not there, or lies where there are no
    // locks, is nobody's.
    bool take(const std::filesystem::path& file);

private:
    void give_back();

    int file_ = -1;  // descriptor
    HeldFile name_;
};

}  // namespace tangi
