// mosaic_position.h: a position of a mosaic: a fitted painting of which any rectangle can be read.
//
// Pixels of a position and of the wall: x right, y down, centres at integers.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fit/pixel/fit_errors.h"
#include "surface/maps/surface.h"

namespace tangi {

// A rectangle of a position; errors are empty where its file has none.
struct MosaicPart {
    Surface surface;
    FitErrors errors;
};

constexpr int kBandPixels = 1 << 22;  // of a position that are read at once: some 300 MB

struct MosaicPosition {
    std::string name;  // as reports and messages call it
    int width = 0, height = 0;
    double mm_per_pixel = 1;
    bool scale_known = false;
    ReflectanceModel reflectance_model;
    double white_level = 1;         // [1] of its photographs (Photography)
    std::vector<std::string> poor;  // what its fit says of itself
    bool has_specular_colour = false, has_lobe_axes = false, has_errors = false;
    std::string hash;  // of its maps: those of one hash are one and the same
    std::function<MosaicPart(const Region&)> read;

    Region region() const { return {0, 0, width, height}; }
};

// Of one that is in memory. `errors` may be null.
MosaicPosition position_of(std::string name, std::shared_ptr<const Surface> surface,
                           std::shared_ptr<const FitErrors> errors, std::string hash);

// What registration looks at, light and exposure taken out: a rectangle of a position, reduced. NaN where
// nothing was measured.
struct PositionLook {
    Region part;                 // of the position that was looked at, whole pixels of the reduction
    int reduction = 1;           // pixel (x, y) is the mean of reduction x reduction pixels of `part`
    Image<float> paint, relief;  // [1] local contrast of rho_d, and of the curvature of the relief

    // Pixel of the position -> pixel of these pictures.
    glm::dvec2 reduced(const glm::dvec2& p) const;
};

// Before local contrast is taken, for features_of(): luminance of rho_d, and curvature about 1. Both are
// means of what was measured, 0 and 1 where nothing was.
struct PositionOverview {
    int reduction = 1;
    Image<float> paint, relief;
};
// Read band by band; no side is longer than some 2400 pixels.
PositionOverview overview_of(const MosaicPosition& position);

// `part` is cut to the position, and to whole pixels of the reduction.
PositionLook look_at(const MosaicPosition& position, const Region& part, int reduction);

}  // namespace tangi
