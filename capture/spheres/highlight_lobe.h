// highlight_lobe.h: the middle of a highlight from its flanks, which are there even where its top is clipped.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <vector>

namespace tangi {

// Places may be pixels, or, as it is with a sphere's normals in their tangent plane, times the sphere's
// radius: there a rough mirror's lobe is round, which in the picture it is not.
struct LobeSample {
    glm::dvec2 place_px{0, 0};
    double value = 0;  // [1] as stored, at most `clip`
};

struct HighlightLobe {
    glm::dvec2 centre_px{0, 0};
    double sigma_px = 0;   // standard error, each coordinate
    double peak = 0;       // [1] what the flanks say that the top would be, were it not clipped
    double radius_px = 0;  // where it is down to a quarter of the peak
    double residual = 0;   // [1] robust, relative to the values
};

// Fits base + peak / (1 + q(x))^2, q a positive quadratic form (the tail of the GGX distribution, Walter et
// al. 2007, seen in a small part of a sphere), cut off at `clip`, by robust least squares; deviations count
// relative to the value, and not below `floor`. Nothing where the samples are too few or the fit runs away
// from `start_px` by more than `radius_px`.
std::optional<HighlightLobe> fit_lobe(const std::vector<LobeSample>& samples, const glm::dvec2& start_px,
                                      double radius_px, double clip, double floor);

}  // namespace tangi
