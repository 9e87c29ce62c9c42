// progress.h: how long functions tell of their progress and learn that they should stop.
#pragma once

#include <functional>
#include <string_view>

#include "surface/base/error.h"

namespace tangi {

// Called with the name of the stage and the part of it that is done, 0..1; returning false asks for a stop.
// It may be called from any thread, but never from two at once.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

// Reports, and throws Cancelled where the callback asks for a stop. An empty Progress is fine.
inline void report(const Progress& progress, std::string_view stage, double fraction) {
    if (progress && !progress(stage, fraction)) throw Cancelled();
}

}  // namespace tangi
