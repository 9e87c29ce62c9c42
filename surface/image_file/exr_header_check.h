// exr_header_check.h: what the header of an EXR file claims to hold, against what a file of its length can.
//
// OpenEXR asks for memory by the header's data windows (a table of offsets, lengths of rows) before it looks
// for the pixels. A header of a few damaged bytes so asks for gigabytes. And it notices that the end of a
// file is missing only where pixels are read that lay there, which who wants one part of many never does.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tangi {

struct ExrClaim {
    std::vector<std::string> parts;         // their names; "" of a part without
    std::optional<std::string> impossible;  // which size the file is too short for: "4 x 2000000000"
    // The file ends before an attribute of its headers, which OpenEXR would ask for memory for, or before the
    // last block that its tables of offsets name, or they name no place for a block: it was cut off, or never
    // written to its end. Blocks are not looked for beside `impossible`, nor in files that have a part of
    // deep pixels, or of tiles in several sizes.
    bool cut_off = false;
    // A header holds an attribute that is shorter or longer than its kind is. OpenEXR does not compare: what
    // it takes for the next one then is anything, and asks for gigabytes.
    bool malformed = false;
    double pixels = 0;  // of the largest part
    double held = 0;    // [bytes] of the largest block of rows, or row of tiles, which is unpacked as a whole
};

// Nothing where the header cannot be followed to its end: what is wrong with it is for OpenEXR to say. Each
// block of rows, or tile, takes 8 bytes in the table of offsets and 8 of its own (OpenEXR file layout,
// "Offset tables", "Scan lines"); deflated pixels take 1/1032 of what they were (RFC 1951: 258 bytes from 2
// bits). Reads headers, tables and 8 to 24 bytes of the last block, however large the picture is.
std::optional<ExrClaim> exr_claim(const std::filesystem::path& path);

}  // namespace tangi
