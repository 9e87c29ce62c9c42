// stray_photos.h: photographs that do not belong in a stack, as its survey shows: the same picture under two
// names.
#pragma once

#include <vector>

#include "capture/left_out.h"
#include "capture/survey.h"

namespace tangi {

// Forgets the photographs that are not kept.
void keep_photos(Stack& stack, Survey& survey, const std::vector<bool>& keep);

// Positions in the stack of photographs that are one picture: equal in every sampled value, which two
// exposures never are. Groups of two or more, ascending. Pictures of a single value (black, white) count as
// different.
std::vector<std::vector<std::size_t>> same_pictures(const Survey& survey);

// Takes photographs that are the same picture as another out of the stack and the survey, with a warning: all
// but the first where they have the same light, all of them where their lights differ, since one of these is
// wrong. Throws Error where all photographs are one picture, and as require_few().
void leave_out_copies(Stack& stack, Survey& survey, std::vector<LeftOut>& left_out);

}  // namespace tangi
