// duplicate_photos.h: photographs that do not belong in a stack: the same picture under two names, as its
// survey shows, and pictures of something else, as whatever lays photographs on each other finds.
#pragma once

#include <vector>

#include "capture/photo/rejected_photo.h"
#include "capture/stack/survey.h"

namespace tangi {

// A photograph shows something else than the others where these agree, it has edges of its own, and nothing
// of it is alike: the median photograph's correlation with the others, the strength of its own edges by the
// median's, and its correlation with the others [1]. The same for the fit's registration, which predicts
// each photograph under its light, and for calibrate's, which knows no light.
constexpr double kOthersAgree = 0.5, kEdgesOfItsOwn = 0.5, kNothingAlike = 0.15;
constexpr std::size_t kFewestToTellStrays = 4;

// Forgets the photographs that are not kept.
void keep_photos(Stack& stack, Survey& survey, const std::vector<bool>& keep);

// Positions in the stack of photographs that are one picture: equal in every sampled value, which two
// exposures never are. Groups of two or more, ascending. Pictures of a single value (black, white) count as
// different.
std::vector<std::vector<std::size_t>> same_pictures(const Survey& survey);

// Takes photographs that are the same picture as another out of the stack and the survey, with a warning: all
// but the first where they have the same light, all of them where their lights differ, since one of these is
// wrong. Throws Error where all photographs are one picture, and as require_few(), `fewest` being left.
void leave_out_copies(Stack& stack, Survey& survey, std::vector<RejectedPhoto>& rejected,
                      std::size_t fewest = 4);

}  // namespace tangi
