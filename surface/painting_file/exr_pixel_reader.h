// exr_pixel_reader.h: single pixels of a part of a painting file, read when they are asked for: a map that is
// looked at here and there need not be in memory.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "surface/painting_file/painting_parts.h"

namespace tangi {

class PartPixels {
public:
    // Holds a file open: it stays readable where another one takes its place. Throws Error naming the file
    // or folder and the part: missing, damaged.
    PartPixels(const std::filesystem::path& painting, const PartInfo& part);
    ~PartPixels();
    PartPixels(PartPixels&&) noexcept;
    PartPixels& operator=(PartPixels&&) noexcept;

    const PartInfo& info() const;

    // The values of all channels, in the order of info().channels; 0 <= x < width, 0 <= y < height. Reads the
    // rows that are packed together with this one, or its tile, and keeps them until others are needed.
    // Throws Error: damaged.
    std::span<const float> at(int x, int y);

    struct Impl;

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
