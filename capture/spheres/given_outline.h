// given_outline.h: a circle that somebody gave for a sphere, weighed against the edges that the photographs
// show.
#pragma once

#include <vector>

#include "capture/spheres/sphere_crops.h"
#include "capture/spheres/sphere_outline.h"

namespace tangi {

// The circle with the standard errors of its numbers: 2 % of the radius for who draws on a picture that is
// shown smaller, at least 0.6 pixels, which whole pixels read off by up to one either way have (1 / sqrt(3)).
SphereImage with_click_errors(SphereImage given);

// Which circle is the sphere's, by what was given and the outline that was found near it, if one was.
enum class OutlineVerdict {
    found,   // it stands out, and is where the given circle is, within its errors
    beside,  // it stands out, and is clearly not where the circle is
    given    // nothing stands out: the circle, but for what edges tell twice as well as it does
};
struct GivenOutline {
    OutlineVerdict verdict = OutlineVerdict::given;
    SphereImage sphere;
    double moved_px = 0;  // centre or radius, whichever more, from what was given
};
GivenOutline judge_outline(const SphereCrops& crops, const SphereImage& given,
                           const std::optional<SphereOutline>& found, const SphereCamera& camera);

// An outline that was found, with the errors that edges around it leave open: a pattern that crosses it in
// many places has circles, too.
void widen_errors(const SphereCrops& crops, SphereOutline& outline, const SphereCamera& camera);

}  // namespace tangi
