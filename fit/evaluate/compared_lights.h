// compared_lights.h: what a painting is compared with, where the list of lights is another one than it was
// fitted with.
#pragma once

#include <span>
#include <string>

#include "capture/stack/stack.h"
#include "surface/maps/surface.h"

namespace tangi {

// That most photographs which the painting lists by their names have the lights of others of them now: a list
// that is shifted or turned round, there or here. Empty where that is not so, as for photographs of another
// day under lights of their own.
std::string says_lights_are_exchanged(std::span<const StackPhoto> photos, const Photography& photography,
                                      const std::string& folder);

}  // namespace tangi
