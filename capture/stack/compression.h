// compression.h: what compression took from photographs.
#pragma once

#include <filesystem>
#include <optional>

#include "capture/stack/stack.h"

namespace tangi {

// [1..100] Quality of a JPEG file as the Independent JPEG Group's library counts it, by the sum of its table
// for brightness (ITU-T T.81, B.2.4.1 and table K.1). Nothing for other files.
std::optional<int> jpeg_quality(const std::filesystem::path& path);

// [1] Standard deviation of what the coarsest JPEG of the photographs is off by its rounding, full scale = 1:
// the mean step of its table for brightness over the square root of 12. 0 where none is a JPEG.
double rounding_of_jpeg(const Stack& stack);

// Warns where compression tells more of the photographs' finest detail than the painting does: JPEG below a
// quality of 90. Its errors are the same in neighbours and differ between lights as relief does, so no stated
// error has them.
void warn_of_compression(Stack& stack);

}  // namespace tangi
