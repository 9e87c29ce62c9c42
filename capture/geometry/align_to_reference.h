// align_to_reference.h: photographs laid onto a painting that was fitted before, such as before its
// treatment.
#pragma once

#include <optional>

#include "capture/formats/lens_file.h"
#include "capture/geometry/scale.h"
#include "capture/stack/photo_set.h"
#include "surface/maps/surface.h"

namespace tangi {

struct EarlierPainting {
    Image<float> brightness;               // [1] luminance of rho_d (Surface::diffuse)
    std::optional<double> mm_per_pixel{};  // where its scale is known
};
EarlierPainting earlier_painting(const Surface& surface);

struct FoundPainting {
    Homography to_photo{
        1};               // pixel of the painting -> pixel of the photographs, without the lens's distortion
    double error_px = 0;  // standard error of it, rms over the painting
    double correlation = 0;  // [1] of the edges of the two
};

// Where the painting lies in the photographs, whose lights need not be known: by the mean of some of them
// (register_pictures). `lens` is for photographs of this size. Throws Error where it is not in them.
FoundPainting find_painting(const PhotoSet& photos, const EarlierPainting& painting,
                            const std::optional<Lens>& lens, const Transfer& transfer,
                            const Progress& progress = {});

// The photographs' scale in the middle of a painting of known scale.
Scale scale_from(const EarlierPainting& painting, const FoundPainting& found);

}  // namespace tangi
