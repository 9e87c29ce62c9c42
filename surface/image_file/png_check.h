// png_check.h: whether a PNG file is whole.
#pragma once

#include <filesystem>

namespace tangi {

// False where a PNG file ends before its last chunk, IEND, does, or a chunk says that it is longer than what
// follows of the file: it was cut off, or a length is damaged (ISO/IEC 15948, 5.3 and 11.2.5). libpng tells
// of the first when the last rows are wanted, perhaps after an hour, and asks for memory by the second. True
// of all other files, and of those that cannot be read, which is for their reader to say. Reads 8 bytes a
// chunk.
bool is_whole_png(const std::filesystem::path& path);

}  // namespace tangi
