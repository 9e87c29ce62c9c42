// paint_metadata.h: what exported files say of paints, for who reads them without this program.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "paint/canvas/canvas.h"

namespace tangi {

// A float as the shortest number that is this float: 0.3, not 0.30000001192092896.
double shortest(float value);

// `mm_per_pixel`, `scale_known`, `height_unit` of dry maps, `thickness_unit` of paint, and `bands_nm`, the
// middle of each band of K and S.
nlohmann::json scale_in_words(const Canvas& canvas);

// `paint`, its name, and of what is there of it, as it was mixed: `mm3` in all, `medium`, the part of this
// that is clear medium, `paint_mm3` without that; `specular` and `roughness`; `k` and `s` [1/mm] with the
// medium; `origin`, whether that makes it `approximate`, and `source`.
nlohmann::json in_words(const Pigment& paint, double mm3);

}  // namespace tangi
