// height_unit.h: what heights are in, for files and messages.
#pragma once

#include <string_view>

namespace tangi {

// What one unit of a height is: "mm", as far as the size of the pixels is right, and "pixel" where nothing is
// known of that.
inline std::string_view height_unit_of(double mm_per_pixel, bool scale_known) {
    return scale_known || mm_per_pixel != 1 ? "mm" : "pixel";
}

}  // namespace tangi
