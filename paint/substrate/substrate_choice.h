// substrate_choice.h: what a new painting is painted on, of everything that it may be: a procedure's piece, a
// picture, a painting's dry layer, or what was kept under a name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "paint/substrate/picture_substrate.h"
#include "paint/substrate/substrate.h"
#include "paint/substrate/substrate_finish.h"
#include "surface/base/progress.h"

namespace tangi {

struct SubstrateChoice {
    // Name of a procedure (substrate.h), picture (.png, .tif, .jpg), painting file (.exr), or a name that one
    // is kept under.
    std::string which;
    std::string height_from = "luminance";  // of a picture: luminance, none, or another picture as height map
    SubstrateOptions piece{};               // of a procedure; its pixel_mm of a picture, too
    PictureSubstrateOptions picture{};
    SubstrateFinish finish{};
    std::string keep_as{};  // name that it is kept under from now on; empty: it is not
};

bool is_picture(const std::filesystem::path& path);  // by its ending

// The file of one that is kept under a name. Throws Error, with all names that there are, where there is
// none.
std::filesystem::path kept_substrate_file(const std::string& name);

// The surface; and keeps it where that was asked for. With a finish it is no photographs' any more, and its
// provenance says so. Throws Error.
Surface make_substrate(const SubstrateChoice& choice, const Progress& progress = {});

}  // namespace tangi
