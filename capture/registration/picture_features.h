// picture_features.h: features of a picture, and where those of one are found in another: SIFT (Lowe 2004).
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

struct PictureFeatures {
    double scale = 1;                // [1] <= 1: of the reduced picture that features were sought in
    std::vector<glm::dvec2> points;  // [pixels of the reduced picture]
    Image<float> descriptors;        // a row each; empty where there is none
};

// Of local contrast, so that brightness may be in any unit and strength. Large pictures are reduced.
PictureFeatures features_of(const Image<float>& brightness);

// Points of one and of the other that look alike, and clearly more so than any second one does (Lowe's
// ratio).
struct FeatureMatches {
    std::vector<glm::dvec2> from, to;  // [pixels of the reduced pictures]
};
FeatureMatches matches_of(const PictureFeatures& from, const PictureFeatures& to);

// What of the mean brightness is the floor of local_contrast(), when pictures are registered.
double contrast_floor_of(const Image<float>& brightness);

}  // namespace tangi
