// picture_with_alpha.h: pictures whose alpha says what belongs to them, as masks and layers of other
// programs.
#pragma once

#include <filesystem>

#include "surface/image.h"

namespace tangi {

struct PictureWithAlpha {
    Image<Rgb> colour;   // not multiplied by alpha
    Image<float> alpha;  // 0..1; empty where the file has none
};

// As read_picture() does (picture_file.h), with the alpha of the file.
PictureWithAlpha read_picture_with_alpha(const std::filesystem::path& path);

}  // namespace tangi
