// tile_parts.h: parts beside `dry` in the tiles of a painting (painting_tiles.h), with their checksums.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "surface/image/image.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

// Planes of a part, of its channels in their order, row by row.
using PartPlanes = std::vector<Image<float>>;

PartPlanes filled(const PartToWrite& part);
// The part of these planes, with its checksum as attribute `hash`; nothing where all of it is 0.
std::optional<PartToWrite> sealed(PartInfo info, PartPlanes planes);

// All of a part of a file, whose checksum is looked at where it has one. Throws Error naming the file:
// damaged.
PartPlanes checked_planes(const std::filesystem::path& file, const PartInfo& part);

// What the tiles of level 0 say of parts that have the painting's size: tiles of which a part is 0 do not
// have it, and those of some have fewer channels.
std::vector<PartInfo> parts_of_tiles(const std::filesystem::path& folder, const TileGrid& grid);
// Sorted as they are in `order`; what is not in it comes behind.
std::vector<PartInfo> in_order_of(const std::vector<PartInfo>& order, std::vector<PartInfo> parts);

}  // namespace tangi
