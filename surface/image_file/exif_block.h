// exif_block.h: EXIF as it lies in photographs, looked through before OpenImageIO 2.4 does, which follows
// directories that lead back to themselves by way of a maker's note until the stack ends.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

// Whether every directory of the block (from the TIFF header on: "II" or "MM") lies in it, and none is
// reached through a maker's note (CIPA DC-008-2019, 4.6).
bool is_sound_exif(std::string_view block);

// What is sound of a block, as a block of its own: of the first directory and of EXIF's, the numbers and
// texts that lie in the block whole; no places, maker's notes or thumbnails. Empty where nothing is.
std::string sound_part_of_exif(std::string_view block);

}  // namespace tangi
