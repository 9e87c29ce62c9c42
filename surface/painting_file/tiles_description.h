// tiles_description.h: painting.json of a folder of tiles (painting_tiles.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "surface/painting_file/painting_reader.h"

namespace tangi {

struct TilesDescription {
    PaintingHeader header;
    std::string made_of;
    std::vector<std::vector<std::string>> hashes;  // [level][number] of the part `dry` of each tile
    std::vector<HeightRange> heights;              // of the tiles of level 0
};

inline constexpr const char* kTilesDescription = "painting.json";

// The words of the file, whose field `sha256` is of all others.
std::string words_of(const TilesDescription& description);

// Throws Error naming the folder and the file: it is missing, no JSON, of a newer version, damaged (its own
// hash tells, too), with what to do.
TilesDescription read_tiles_description(const std::filesystem::path& folder);

}  // namespace tangi
