// uncalibrated.h: where the lights of a stack were, from the photographs of a nearly flat object alone.
//
// On a nearly flat matt object under a distant light l, with slopes p and q, a photograph shows
//   albedo strength l.z (1 - (p l.x + q l.y) / l.z)
// to first order. Divided by each pixel's albedo and each photograph's level (strength l.z), what is left is
// a matrix of rank 2, slopes times l.xy / l.z, which is factored robustly: shadows and highlights are
// outliers. The factors are known up to an invertible 2 x 2 matrix (Hayakawa 1994, "Photometric stereo under
// a light source with arbitrary motion": 3 x 3; that the object is flat as a whole fixes the rest). It is
// resolved by
//   strength       the lights are about equally strong (Hayakawa 1994), and what a flat object shows of them
//   is
//                  matt reflection and a lobe (equal_intensity.h); that gives the matrix up to a rotation and
//                  a mirror image, and with it the relief's strength
//   integrability  slopes are those of a surface: their curl is small (Belhumeur, Kriegman & Yuille 1999,
//   "The
//                  bas-relief ambiguity"); that gives the rotation and the mirror image up to half a turn
//   convention     half a turn makes hills of valleys, with the lights on the other side, and no photograph
//   tells:
//                  paint is taken to stand out from its ground, which makes the relief's tops sharper than
//                  its bottoms. `inverted` asks for the other reading.
// What varies slowly over the picture (lights' falloff, a bulge) is taken out first, as the object is flat as
// a whole.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "surface/base/progress.h"
#include "surface/image/image.h"

namespace tangi {

struct UncalibratedOptions {
    bool inverted = false;  // the other reading of the relief: hills for valleys
};

struct UncalibratedLights {
    std::vector<glm::dvec3> directions;  // [unit vectors] of the photographs
    std::vector<double> sigma_deg;       // [deg] standard errors of the directions, but for the reading
    std::vector<double> strengths;       // [1] found for the lights; the median is 1
    Image<glm::vec2> slopes;             // of the reduced pictures (height grows along x right, y up)
    double strength_scatter = 0;         // [1] rms of ln strength: how far the assumption holds
    double gloss = 0;      // [1] reflection that is not matt, of a flat object under a light along z
    double residual = 0;   // [1] median of |measured / explained - 1|
    double explained = 0;  // [0..1] part of the shading's variance that rank 2 explains
    double curl = 0;     // [0..1] of the slopes found, as a part of that of the worst rotation: 0 = a surface
    double falloff = 0;  // [0..1] how well near lights on these sides explain what varies slowly
    double convexity = 0;               // [1] skewness of the curvature; near 0 the convention says nothing
    std::vector<std::string> warnings;  // what is doubtful
};

// `pictures` are linear light, all of one size, at least 4; values from `clipped` on and those of 0 and less
// are left out. Throws Error where nothing can be told: fewer than 8 photographs, no relief, no light.
UncalibratedLights uncalibrated_lights(const std::vector<Image<float>>& pictures, float clipped,
                                       const UncalibratedOptions& options = {},
                                       const Progress& progress = {});

// The relief as it would look lit from the top left, for the user to see which reading is right; 0..1.
Image<float> relief_picture(const Image<glm::vec2>& slopes);

}  // namespace tangi
