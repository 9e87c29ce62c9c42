// sphere_highlight.h: the reflection of the light in a mirror sphere, in every photograph.
#pragma once

#include <string>
#include <vector>

#include "capture/spheres/sphere_crops.h"

namespace tangi {

enum class HighlightState {
    found,
    absent,      // nothing on the sphere is about as bright as the highlights of the other photographs
    off_sphere,  // the bright spot lies beside the sphere, or across its outline
    ambiguous,   // two spots that are equally bright and large
    smeared,     // so large, or clipped over so large an area, that its middle means nothing
    off_picture  // at the picture's border
};

struct Highlight {
    HighlightState state = HighlightState::absent;
    glm::dvec2 place_px{0, 0};  // in the common frame
    double sigma_px = 0;        // standard error, each coordinate
    double area_px = 0;
    float peak = 0;  // [1] as stored
    bool clipped = false;
    int weaker = 0;  // other spots on the sphere that may be lights or reflectors, and are less bright
};

// Why a highlight is not used, for the user, in a few words.
std::string reason_of(const Highlight& highlight);

// One highlight for each photograph: the spot with the brightest pixel on the sphere, of what does not stay
// while the light moves; of clipped spots the one with the brightest lobe, or, where no lobe can be fitted,
// with the brightest glow around it: what lens and sensor scatter, and the mirror's own haze, grow
// with the light. Its place is the centroid above half its brightness, where it is clipped that of the
// clipped area with its soft border.
std::vector<Highlight> find_highlights(const SphereCrops& crops, const SphereImage& sphere,
                                       const SphereCamera& camera);

}  // namespace tangi
