// confining_mask.h: masks that brushes stop at, kept so that strokes can be painted again within them.
//
// A journal names a mask by the SHA-256 of its file, NAME.png in strokes/masks/ of the treatment: from the
// journal of a sitting, which lies beside the painting, that is strokes/masks/, from a journal in strokes/ it
// is masks/.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "paint/session/session.h"
#include "retouch/mask/mask.h"

namespace tangi {

struct ConfiningMask {
    std::string name;                  // SHA-256 of `png`, 64 hex digits
    std::string png;                   // as its file has it: coverage is rounded to 1/255
    std::shared_ptr<const Mask> mask;  // as it is read from that
};
// `folder`: of the treatment, where it is written for a moment and read again. Throws Error naming the file.
ConfiningMask confining_mask(const std::filesystem::path& folder, const Mask& mask);

// Where a treatment keeps it, relative to its folder: "strokes/masks/NAME.png".
std::string confining_mask_file(const std::string& name);

// Masks that the journal names, of these sizes, for Session::masks_from(). They throw Error naming the file
// that is missing, or is not the mask that was kept.
Session::Masks masks_beside(std::filesystem::path journal, int width, int height);

}  // namespace tangi
