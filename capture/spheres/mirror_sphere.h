// mirror_sphere.h: mirror spheres in a stack of photographs: where they are, and where they show the light.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/registration/edge_field.h"
#include "capture/spheres/sphere_highlight.h"
#include "capture/spheres/sphere_outline.h"
#include "surface/base/error.h"

namespace tangi {

// Where the user says that a sphere is: a circle, or a box around it. Pixels, y down.
struct GivenSphere {
    glm::dvec2 centre_px{0, 0};
    double radius_px = 0;  // of a box, half its shorter side
    bool is_box = false;   // the sphere lies in the box, and may be smaller
    std::string text;      // as the user wrote it, for messages
};

struct FoundSphere {
    SphereImage image;
    SphereImage circle{};                 // from which its outline was sought
    std::optional<SphereImage> before{};  // the circle that the user gave, with its standard errors
    std::string name;                     // "sphere 1 at (629, 64)", for messages
    bool given = false;
    double outline_coverage = 0;  // [1] part of the outline that was measured; 0: taken as given
    double outline_residual_px = 0;
    std::optional<Known> elongation{};    // SphereOutline's
    std::vector<Highlight> highlights{};  // one a photograph; empty for diffuse spheres
    SphereCrops crops;

    int highlights_found() const;
    int highlights_in(HighlightState state) const;
};

// No sphere was found where none was said to be.
class NoSphereError : public Error {
public:
    using Error::Error;
};

// Where spheres are sought.
struct SphereStack {
    const PhotoSet& set;
    const GreyPhotos& photos;     // of the set
    const CameraMotions& drifts;  // of these
    const SphereCamera& camera;
    std::span<const GivenSphere> given;  // where the user says that they are; empty: anywhere
};

struct SphereSearch {
    std::vector<FoundSphere> spheres;  // from top to bottom
    std::vector<std::string> warnings, poor;
};

// Finds mirror spheres: a small bright spot that wanders about as the light moves, one a photograph, within a
// circle of edges that stay, as lights before the painting make it wander and as the shading of all else says
// that they stood. What shows highlights but not so is left out with a warning; so is a second sphere that
// shows few, unless it has the first one's size and shows the same lights. Spheres given by the user are
// sought only where they are given; one that is not there is left out with a warning, and Error says so where
// no sphere is left. Without given spheres, no sphere at all is an Error too.
SphereSearch find_mirror_spheres(const SphereStack& scene, const std::optional<double>& expected_px = {},
                                 const Progress& progress = {});

// Outline and highlights once more, for a camera that is known by now.
void measure_again(FoundSphere& sphere, const SphereCamera& camera);

// Seeks the outline from sphere.circle; where a circle was given, it is weighed with what is found
// (given_outline.h). False where none was given and none is found: the sphere is left as it is. What the user
// is to know of a given circle is added to `warnings`.
bool find_outline(FoundSphere& sphere, const SphereCamera& camera, const std::string& given_text,
                  std::vector<std::string>& warnings);

// The circle near a given sphere or box that has edges along it, in the pixels of the whole photographs;
// nothing where none has. Where a circle of quite another size around the same place has far clearer edges,
// that one, and `contradiction` says so to the user.
std::optional<Circle> circle_near(const EdgeField& field, const GreyPhotos& photos, const GivenSphere& given,
                                  std::string& contradiction);

// What a given circle or box says of the sphere before its outline is looked at, with standard errors;
// nothing where a circle that shows says otherwise, or says more than a box does.
std::optional<SphereImage> before_of(const GivenSphere& given, bool circle_seen,
                                     const std::string& contradiction);

// Throws Error where a given sphere does not lie in the photographs.
void require_in_picture(const GivenSphere& given, int width, int height);

}  // namespace tangi
