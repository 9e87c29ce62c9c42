// photo_screening.h: which photographs cannot be read beside the others, and which picture is their mask.
#pragma once

#include "capture/photo/rejected_photo.h"
#include "capture/stack/stack.h"

namespace tangi {

// The files of a photograph: itself, or the exposures of its bracket.
std::vector<std::filesystem::path> files_of(const StackPhoto& photo);

// What keeps a photograph from being read beside `other`, whose name is given: another size, number of
// channels or bits, orientation. Empty where nothing does.
std::string difference(const PhotoHeader& header, const PhotoHeader& other, const std::string& name);

// A warning for each that is left out, from `first` on.
void tell(const std::vector<RejectedPhoto>& rejected, std::size_t first, std::vector<std::string>& warnings);

// Takes photographs that cannot be opened, and those that are not stored as most are, out of the stack, with
// a warning for each, and adds them to `rejected`. Only headers are read.
void leave_out_unusable(Stack& stack, std::vector<RejectedPhoto>& rejected);

// A mask of photographs as stored: how bright the brightest channel is, 0..1, and what of it can be seen
// (see_through() of image_alpha.h). Throws Error naming the file.
Image<float> read_photo_mask(const std::filesystem::path& path);

// The one picture of photographs' size that is black and white; the others of `masks` are told in the
// warnings, and so is that it is used.
std::optional<std::filesystem::path> mask_among(const std::vector<std::filesystem::path>& masks,
                                                const Region& photo, std::vector<std::string>& warnings);

}  // namespace tangi
