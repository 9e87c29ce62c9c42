// exr_parallel_reader.h: the channels of a part of an OpenEXR file, unpacked on all cores.
//
// OpenEXR's own reader unpacks with zlib and copies in a thread of its own each; for files as we write them
// (blocks of rows, ZIP) this takes a third of the processor's time, and rows can be looked at while they are
// still in its cache.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "surface/base/progress.h"

namespace tangi {

// A channel and where its floats go: pixel (x, y) to base[(y * width + x) * stride].
struct FloatPlane {
    std::string channel;
    float* base = nullptr;
    std::size_t stride = 1;  // [floats]
};

// Reads these channels of a part, whose data window begins at 0, 0. `rows_read` is called for each block of
// rows that is there, from any thread, each row once. False, and nothing is read, where the part is packed
// otherwise (other compressions, channels that are no 32-bit floats): OpenEXR is to read it then. Throws what
// OpenEXR throws, and std::runtime_error where a block is damaged.
bool read_scan_blocks(const std::filesystem::path& path, const std::string& part,
                      std::span<const FloatPlane> planes,
                      const std::function<void(int y0, int y1)>& rows_read, const Progress& progress = {});

}  // namespace tangi
