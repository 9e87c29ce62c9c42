// pair_registration.h: where two positions of a mosaic show the same: by features of paint and of relief, and
// then to a fraction of a pixel by patches of both.
#pragma once

#include <string>
#include <vector>

#include "capture/registration/picture_features.h"
#include "fit/mosaic/mosaic_position.h"
#include "surface/image/homography.h"

namespace tangi {

struct PositionFeatures {
    int reduction = 1;  // of the overview that they were found in
    PictureFeatures paint, relief;
};
PositionFeatures features_of(const MosaicPosition& position);

// The same point in both, in their pixels.
struct TiePoint {
    glm::dvec2 first{0}, second{0};
    double sigma_px = 1;     // standard error of each coordinate of `second`
    double correlation = 0;  // [1] of the patches around it
};

struct PairRegistration {
    std::size_t first = 0, second = 0;  // positions
    int features = 0;                   // that agree on one homography
    Homography to_second{1};            // pixel of the first -> pixel of the second
    std::vector<TiePoint> ties;
    double overlap = 0;  // [1] part of the first that the second shows
    std::string why;     // why they are not joined; empty where they are

    bool joined() const { return why.empty(); }
};

// Registered by features (SIFT) and consensus (RANSAC), which knows any turn and other sizes, and then from
// coarse to fine by the shift of patches that explains their differences best (Lucas & Kanade 1981). Mirrored
// pictures are not joined.
PairRegistration register_pair(const std::vector<MosaicPosition>& positions,
                               const std::vector<PositionFeatures>& features, std::size_t first,
                               std::size_t second);

}  // namespace tangi
