// photo_source.h: photographs as `compare` reads them, and as the window compares them with a
// painting.
#pragma once

#include <memory>

#include "capture/radiometry/develop_stack.h"
#include "cli/arguments.h"
#include "surface/maps/surface.h"
#include "viewer/model/photo_source.h"

namespace tangi {

// A stack that compare() can read, and how it was developed.
struct PhotosToCompare {
    Stack stack;
    DevelopReport development;
};

// The part of the photographs that the painting was fitted from, as --crop has it; empty: the whole pictures,
// or it is not written down.
std::string crop_fitted(const Surface& surface);

// Develops photographs as those were that the painting was fitted from; `arguments`: what they were opened
// with. Throws as develop_stack().
PhotosToCompare photos_to_compare(Stack stack, const PhotosArguments& arguments, const Surface& surface,
                                  const Progress& progress);

// The book of a folder. What the arguments leave open is as the painting's provenance remembers it: crop and
// mask, and lights and capture file where the folder alone does not tell. `painting`: its file, for the
// residual of the relighting residual. Throws Error, Cancelled.
std::unique_ptr<PhotoBook> open_photo_book(const PhotosArguments& arguments,
                                           std::shared_ptr<const Surface> surface,
                                           const std::filesystem::path& painting, const Progress& progress);

}  // namespace tangi
