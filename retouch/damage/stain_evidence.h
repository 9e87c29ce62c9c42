// stain_evidence.h: how much less light comes back as through a stain, whatever strokes lie below; for
// sources of this module only.
//
// A stain lies over strokes and does not end where they do, whereas paint does. What changes from place to
// place within one and the same paint, told by its gloss, is summed up to a map of its own (after Horn 1974,
// "Determining lightness from an image", which tells light from paint by how suddenly they change); of what
// changes where the paint does, nothing is known.
#pragma once

#include "retouch/damage/area_features.h"

namespace tangi {

// [1] Direction in which a stain moves ln rho_d of red, green and blue, of unit length: what dirt and aged
// binders leave absorbs more the shorter the wave, by a law like exp(-S lambda).
inline constexpr std::array<double, 3> kStainLaw = {0.26, 0.48, 0.84};

// CV_32F [1], ln of the part of the light that is lost, less that around; about 0 where there is no stain.
cv::Mat stain_evidence(const AreaFeatures& features);

}  // namespace tangi
