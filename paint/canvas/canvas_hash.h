// canvas_hash.h: which painting it is, and how far it is painted: what a journal of strokes goes on from.
#pragma once

#include <string>

#include "paint/canvas/canvas.h"

namespace tangi {

// 64-bit FNV-1a, as 16 hex digits, over the dry layer's hash (hash_of(Surface), which who has it gives), the
// scale that is painted with, and all paint: of each layer, by where it lies, which paints and how much of
// each. A painting that was written and read again has the same.
std::string hash_of(const Canvas& canvas, const std::string& dry_hash);

}  // namespace tangi
