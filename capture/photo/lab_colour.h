// lab_colour.h: pictures that are stored as CIE L*a*b* (TIFF 6.0, section 23), as linear light.
#pragma once

#include <span>

namespace tangi {

enum class LabKind {
    cielab,   // a* and b* are signed
    icc_lab,  // a* and b* are shifted to be positive (TIFF technical note 4, of Photoshop)
};

// Codes of `bits` bits, 8 or 16, each as a part of the largest code, L*, a*, b* of one pixel after the other
// -> linear Rec. 709, 1 = white. L* of full scale is saturated: how bright that was is not known, and such
// pixels become NaN. From D50 by Bradford's matrix (ICC.1:2010, annex E.3).
void linear_of_lab(LabKind kind, int bits, std::span<float> values);

}  // namespace tangi
