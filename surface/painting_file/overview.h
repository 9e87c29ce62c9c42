// overview.h: what a large painting looks like in small, kept in its file (part `overview`) so that it can be
// shown at once, while the maps are still being read.
//
// Channels as those of `dry`, 16-bit floats, 1024 pixels a side at most: means over squares of whole pixels,
// with the spread of the slopes in alpha (as levels of detail have it, viewer/render/texels.h). Attribute
// `dry_hash`: of the dry part that it belongs to. It may be left out, and counts for nothing where that is
// another.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "surface/maps/surface.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_reader.h"

namespace tangi {

// Adds an overview of what is seen of a painting (with its paint) to the parts that are to be written beside
// `dry`, in the place of one that is among them; none where the painting is so small that it is read as
// quickly.
void add_overview(std::vector<PartToWrite>& parts, const Surface& seen, const Surface& dry);

// The same of what is made in bands of rows as it is asked for, from top to bottom, so that it never is in
// memory as a whole: `seen` gives a part of the painting, whose pixel (0, 0) is the part's upper left.
void add_overview(std::vector<PartToWrite>& parts, const std::function<Surface(const Region&)>& seen,
                  const Surface& dry);

// The same of a painting that is read; what is seen of it is its dry layer.
void add_overview(std::vector<PartToWrite>& parts, const PaintingReader& painting);

// Whether a painting is so large that it has one.
bool wants_overview(const Surface& dry);
bool is_overview(const PartToWrite& part);
bool is_overview_of(const PartToWrite& part, const std::string& dry_hash);  // as it is now

struct Overview {
    Surface surface;            // reduced: its pixels are larger, its mm_per_pixel says how large
    int width = 0, height = 0;  // [pixels] of the painting
};

// Reads headers and that part only. Empty where the file has none that belongs to its dry part. Throws Error
// as read_painting() does where the file is missing, or no painting.
std::optional<Overview> read_overview(const std::filesystem::path& path);

}  // namespace tangi
