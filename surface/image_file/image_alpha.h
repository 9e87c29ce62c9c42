// image_alpha.h: pictures whose alpha says what belongs to them, as masks and layers of other
// programs.
#pragma once

#include <filesystem>

#include "surface/image/image.h"

namespace tangi {

struct PictureWithAlpha {
    Image<Rgb> colour;   // not multiplied by alpha
    Image<float> alpha;  // 0..1; 0 where an EXR file has no pixel; empty where it has no alpha and all pixels
};

// As read_picture() does (image_io.h), with the alpha of the file.
PictureWithAlpha read_picture_with_alpha(const std::filesystem::path& path);

// Of a mask (0..1, 1 inside) as the tones of a picture tell it: what is transparent is outside. Where there
// are holes and all that can be seen has one tone, whichever it is, alpha alone says what is inside: as a
// layer does that was painted on by itself. Without alpha (empty) nothing is changed.
void see_through(Image<float>& mask, const Image<float>& alpha);

}  // namespace tangi
