// palette.h: named paints to paint with, and the JSON files that hold them (docs/reference/palette-format.md:
// the format).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "paint/optics/pigment.h"

namespace tangi {

struct Palette {
    std::string name, source;
    std::vector<Pigment> paints;  // names differ

    // Index of the paint with this name, in any case; -1 where there is none.
    int find(std::string_view paint) const;
    // The paint; throws Error naming the palette, the paint and those that there are.
    const Pigment& at(std::string_view paint) const;
};

// 19 acrylic artist paints (R. Berns, RIT, 2016).
const Palette& artist_acrylics();

// Reads and writes palette files. Errors name the file and the place in it ("/paints/3/tint/5").
Palette read_palette(const std::filesystem::path& path);
void write_palette(const std::filesystem::path& path, const Palette& palette);  // whole or not at all

// The same with the file's text; `where` stands for its name in errors.
Palette parse_palette(std::string_view text, const std::string& where);
std::string palette_text(const Palette& palette);

}  // namespace tangi
