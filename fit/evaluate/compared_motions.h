// compared_motions.h: where photographs that a painting does not know lie on it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "capture/stack/stack.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// Draws what the camera would have stored under the light of a photograph, into a picture of the painting's
// size.
using RelitPicture = std::function<void(const StackPhoto& photo, Image<Rgb>& stored)>;

// Registers the photographs that the painting does not list (find_photo()) to what it looks like under their
// lights, and stores the homography in those that lie elsewhere by more than a quarter of a pixel and five
// standard errors. Returns what is to be told: which were moved, and which cannot be registered and are taken
// as they are. Photographs that are damaged are left to who reads them next. `stack` is the one that they are
// of.
std::vector<std::string> register_unknown(std::span<StackPhoto> photos, const Stack& stack,
                                          const Photography& photography, const Transfer& transfer,
                                          const RelitPicture& relit, const Progress& progress);

}  // namespace tangi
