// treatment_strokes.h: the journals of strokes that a treatment's log vouches for, and whether they can be
// painted again.
#pragma once

#include <string>
#include <vector>

#include "paint/retouch/treatment.h"

namespace tangi {

// Journals under strokes/ that are as they were logged, and yet cannot be read, or hold a point of no stroke:
// a line each, naming file and line. Those that are missing are the matter of Treatment::check().
std::vector<std::string> strokes_that_cannot_be_repeated(const Treatment& treatment);

}  // namespace tangi
