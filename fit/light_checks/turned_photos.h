// turned_photos.h: photographs whose pixels are turned or mirrored against the others'.
#pragma once

#include <string>
#include <vector>

#include "capture/photo/rejected_photo.h"
#include "capture/stack/survey.h"

namespace tangi {

// How the pixels of a photograph lie against those of the others: places from the picture's centre, mirrored
// (x to −x) first, then turned by quarters counter-clockwise.
struct PhotoPose {
    bool mirrored = false;
    int quarters = 0;

    friend bool operator==(const PhotoPose&, const PhotoPose&) = default;
};

// "turned by 180 degrees", "mirrored left to right", …
std::string in_words(const PhotoPose& pose);

struct TurnedPhoto {
    std::size_t photo = 0;
    PhotoPose pose;
    double log_ratio = 0;  // ln of the squares it differs from the prediction by so, over those as stored
    double certainty = 0;  // [standard errors] by which that is below 0
};

// Photographs that lie otherwise than most of the others, ascending. Each is predicted from the others, ln of
// a pixel being linear in the light over the photographs, and laid on that in all poses that keep the
// picture's size: 4, and 8 of a square one. Nothing of fewer than 8 photographs, of pictures that look alike
// in another pose, and where the survey's places are no whole picture (a crop that is off the middle, a
// mask). `survey` is of photographs as they are stored, not registered.
std::vector<TurnedPhoto> turned_photos(const Survey& survey, const std::vector<Light>& lights, int width,
                                       int height);

// Takes them out of the stack and the survey, with a warning that names them. Returns why the result is
// doubtful where they are a third of all or more, since the others may be the ones that are turned; else
// nothing.
std::string leave_out_turned(Stack& stack, Survey& survey, std::vector<RejectedPhoto>& rejected);

}  // namespace tangi
