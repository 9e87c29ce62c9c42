// full_scale.h: which stored value of the photographs is full scale, where their files do not say.
//
// Integers of 16 bits may hold the 12 or 14 bits of a sensor as they are; floats may hold codes, 0 to 255, or
// encoded ones from 0 to 1.
#pragma once

#include <span>

#include "capture/stack/survey.h"

namespace tangi {

// Where the photographs show it, sets Stack::full_scale, and for floats that are codes Stack::float_codes
// with the bits of integers, adds a warning that says so, and returns true: the survey is then to be taken
// again.
// - Integers of 16 bits: the largest value, if it is 2^k - 1 for fewer bits, or if several photographs have
// it as
//   theirs, many times each, as clipping leaves it, a little below such a number (black level taken off).
// - Floats that may be anything (not Stack::says_linear), if they are whole numbers, if the user says that
// they are
//   encoded, or if the photographs contradict linear light as clearly as they can (speaks_against()).
// Nothing is done twice, nor with camera raw or what is developed.
bool take_full_scale(Stack& stack, const Survey& survey);

}  // namespace tangi
