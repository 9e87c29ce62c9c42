// ball_candidates.h: circles in photographs that may be the outlines of mirror balls.
#pragma once

#include "capture/spheres/mirror_sphere.h"

namespace tangi {

struct BallCandidate {
    BallImage image;
    std::optional<BallImage> before{};  // FoundBall's
    const GivenBall* given = nullptr;
    double score = 0;             // [1] outline_score()
    std::string contradiction{};  // of what is given by what shows there
};

// Around bright spots that wander about, one a photograph; best first, apart from each other.
std::vector<BallCandidate> sought(const GreyPhotos& photos, const EdgeField& field);

// Where the user says that balls are. Throws Error where that is outside the photographs.
std::vector<BallCandidate> sought_where_given(const GreyPhotos& photos, const EdgeField& field,
                                              std::span<const GivenBall> given,
                                              std::vector<std::string>& warnings);

// Circles as large as a ball that was found, where none of its size is known.
std::vector<BallCandidate> twins_of(const FoundBall& ball, const std::vector<BallImage>& known,
                                    const GreyPhotos& photos, const EdgeField& field);

// Circles of the radius [px] that the user's numbers demand, anywhere in the picture. Those around what was
// found with a far clearer outline of its own are left out.
std::vector<BallCandidate> of_expected_size(double radius_px, const std::vector<FoundBall>& found,
                                            const GreyPhotos& photos, const EdgeField& field);

}  // namespace tangi
