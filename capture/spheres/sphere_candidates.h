// sphere_candidates.h: circles in photographs that may be the outlines of mirror spheres.
#pragma once

#include "capture/spheres/mirror_sphere.h"

namespace tangi {

struct SphereCandidate {
    SphereImage image;
    std::optional<SphereImage> before{};  // FoundSphere's
    const GivenSphere* given = nullptr;
    double score = 0;             // [1] outline_score()
    std::string contradiction{};  // of what is given by what shows there
};

// Around bright spots that wander about, one a photograph; best first, apart from each other.
std::vector<SphereCandidate> sought(const GreyPhotos& photos, const EdgeField& field);

// Where the user says that spheres are. Throws Error where that is outside the photographs.
std::vector<SphereCandidate> sought_where_given(const GreyPhotos& photos, const EdgeField& field,
                                                std::span<const GivenSphere> given,
                                                std::vector<std::string>& warnings);

// Circles as large as a sphere that was found, where none of its size is known.
std::vector<SphereCandidate> twins_of(const FoundSphere& sphere, const std::vector<SphereImage>& known,
                                      const GreyPhotos& photos, const EdgeField& field);

// Circles of the radius [px] that the user's numbers demand, anywhere in the picture. Those around what was
// found with a far clearer outline of its own are left out.
std::vector<SphereCandidate> of_expected_size(double radius_px, const std::vector<FoundSphere>& found,
                                              const GreyPhotos& photos, const EdgeField& field);

}  // namespace tangi
