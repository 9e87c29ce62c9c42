// painting_output.h: a painting that a command makes, as its user names it: one file, or, where the name ends
// in .tangi, a folder of tiles (painting_tiles.h).
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "surface/file/atomic_file.h"
#include "surface/file/held_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

class OutputSet;

// Whether a painting can be called so, by its ending.
bool names_painting(const std::filesystem::path& path);

class PaintingOutput {
public:
    // Throws Error naming the target where nothing can be written there: before the work, not after it.
    explicit PaintingOutput(std::filesystem::path target);

    const std::filesystem::path& target() const { return target_; }

    // All of it, under a temporary name; an overview (overview.h) as well, unless `parts` have one. Parts of
    // the surface's size are cut with it. Tiles that are there already and hold the same, of the painting
    // that is replaced or of a run that was stopped, are not written again.
    void fill(const Surface& surface, std::vector<PartToWrite> parts, const Progress& progress = {});

    // With what else is put in place when the set is. This must live until then.
    void add_to(OutputSet& set);

private:
    void fill_tiles(const Surface& surface, std::span<const PartToWrite> parts, const Progress& progress);

    std::filesystem::path target_;
    std::optional<AtomicFile> file_;  // none of a folder
    HeldFile claim_;                  // of a folder, from fill() until it is in place
};

}  // namespace tangi
