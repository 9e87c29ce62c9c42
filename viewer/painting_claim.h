// painting_claim.h: a painting is painted in one window at a time.
#pragma once

#include <filesystem>

namespace tangi {

// A lock (flock) on the painting's file, which the system gives back however the program ends. It is on the
// file and not on its name: who writes the painting anew takes it again.
class PaintingClaim {
public:
    PaintingClaim() = default;
    ~PaintingClaim() { give_back(); }
    PaintingClaim(PaintingClaim&& other) noexcept;
    PaintingClaim& operator=(PaintingClaim&& other) noexcept;

    // False where another window has the file. What is not there, or lies where there are no locks, is
    // nobody's.
    bool take(const std::filesystem::path& file);

private:
    void give_back();

    int descriptor_ = -1;
};

}  // namespace tangi
