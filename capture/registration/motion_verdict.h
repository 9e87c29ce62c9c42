// motion_verdict.h: what the motions of aligned photographs say: which part of them is the camera's, how
// certain each is, and which photographs show something else.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "capture/registration/alignment.h"
#include "capture/registration/registration.h"

namespace tangi {

// The photographs of an Alignment, in its order: those that are fitted, then those held out.
struct AlignedStack {
    std::vector<const StackPhoto*> photos;
    std::vector<glm::dvec3> lights;  // [unit vectors] under which each is predicted
    std::vector<bool> in_model;      // has a say in the others' predictions
    std::size_t fitted = 0;          // the first of them
    MotionFrame frame;
};

// Whether anything of what the others predict was found in it.
bool was_found(const AlignedPicture& picture);

// Which part of the motions is the camera's, and how certain each is. Moves nothing.
Registration camera_motions(const AlignedStack& stack, const Alignment& alignment);

// Whether a photograph in which nothing was found must show something else: its edges are not where those
// of the others are (in the photograph that shows all highlights of metal and varnish they are there, but
// too few to say exactly where), though it is not lit so evenly that nothing can be expected of it, nor
// so low, unless it has edges of its own where the others agree on theirs.
std::vector<bool> showing_something_else(const AlignedStack& stack, const Alignment& alignment);

}  // namespace tangi
