// exr_claim.h: what the header of an EXR file claims to hold, against what a file of its length can.
//
// OpenEXR asks for memory by the header's data windows (a table of offsets, lengths of rows) before it looks
// for the pixels. A header of a few damaged bytes so asks for gigabytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tangi {

struct ExrClaim {
    std::vector<std::string> parts;         // their names; "" of a part without
    std::optional<std::string> impossible;  // which size the file is too short for: "4 x 2000000000"
};

// Nothing where the header cannot be followed to its end: what is wrong with it is for OpenEXR to say. Each
// block of rows, or tile, takes 8 bytes in the table of offsets and 8 of its own (OpenEXR file layout,
// "Offset tables", "Scan lines"); deflated pixels take 1/1032 of what they were (RFC 1951: 258 bytes from 2
// bits).
std::optional<ExrClaim> exr_claim(const std::filesystem::path& path);

}  // namespace tangi
