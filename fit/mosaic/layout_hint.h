// layout_hint.h: which positions of a mosaic may overlap, as the user says it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/image/homography.h"

namespace tangi {

// The place of each position, counted in steps of the camera; only which are beside each other matters.
struct LayoutHint {
    std::vector<glm::dvec2> places;  // of each position: column, row

    // Within a step and a half in both directions.
    bool may_overlap(std::size_t a, std::size_t b) const;
};

// {"positions": [{"name", "column", "row"}, …]}, as `generate --positions` writes it, or lines of a CSV file:
// name, column, row, with a title or without. Each of `names` must be in it; others may be. Throws Error
// naming the file, the line or position, and what is wrong.
LayoutHint read_layout_hint(const std::filesystem::path& path, const std::vector<std::string>& names);

// By the last two numbers of each name, row and column, as of r0_c2, wall-3-1.exr or 03_11; nothing where a
// name has fewer, or two have the same. Names may have numbers for another reason (IMG_2024_1): tell what was
// taken from them.
std::optional<LayoutHint> layout_hint_of(const std::vector<std::string>& names);

}  // namespace tangi
