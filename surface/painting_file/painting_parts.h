// painting_parts.h: the parts of a painting file beside `dry`: maps of its size that other modules keep
// there.
//
// Channels are 32-bit float, or 16-bit where a part says so; attributes are text. Which parts there are, and
// what they mean, their modules say (docs/reference/quantities.md).
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "surface/base/progress.h"
#include "surface/file/atomic_file.h"
#include "surface/maps/surface.h"

namespace tangi {

struct PartInfo {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::string> channels;              // in the order of their names
    std::map<std::string, std::string> attributes;  // text only
    bool half = false;                              // channels of 16-bit floats
};

// A part to write: its channels must be in the order of their names.
struct PartToWrite {
    PartInfo info;
    // Fills the rows [y0, y1) of all channels: planes[channel][(y - y0) * width + x], which are 0 before.
    std::function<void(int y0, int y1, std::span<float* const> planes)> fill;
};

// A painting with further parts, whole or not at all; as write_painting() otherwise.
void write_painting(AtomicFile& file, const Surface& surface, std::span<const PartToWrite> parts,
                    const Progress& progress = {});
// The same, but not put in place.
void fill_painting(const AtomicFile& file, const Surface& surface, std::span<const PartToWrite> parts,
                   const Progress& progress = {});

// The parts beside `dry`, in the order of the file. Throws Error as read_painting() does, but reads headers
// only.
std::vector<PartInfo> painting_parts(const std::filesystem::path& path);

// Reads all channels of a part in bands of rows from top to bottom and hands them to `take`, in the order of
// info.channels, row by row as above. Throws Error naming the file and the part: missing, damaged.
void read_painting_part(const std::filesystem::path& path, const PartInfo& info,
                        const std::function<void(int y0, int y1, std::span<const float* const> planes)>& take,
                        const Progress& progress = {});

// The same of the rows [first, end) only.
void read_painting_rows(const std::filesystem::path& path, const PartInfo& info, int first, int end,
                        const std::function<void(int y0, int y1, std::span<const float* const> planes)>& take,
                        const Progress& progress = {});

}  // namespace tangi
