// photometric_stereo.h: robust Lambertian photometric stereo (Woodham 1980), the starting point of the Ward
// fit.
#pragma once

#include "capture/stack/pixel_samples.h"
#include "surface/base/options.h"

namespace tangi {

struct PhotometricStereoOptions {
    int iterations = 8;  // of reweighting
    double outlier_scale =
        0.08;  // [1] residual, relative to the pixel's brightness, at which a sample weighs half
    // [1] Of the brightness of a pixel's bright samples: what is darker is taken for shadow at first. Where
    // relief is high and lights are low, more than a fifth of the samples are; of four photographs, which
    // hardly tell a shadow from a dark side, it leaves too little to say how they were stored.
    double shadow = 0;
    double highlights = 0.2;  // [1] part of the samples, the brightest, that start as highlights

    static constexpr std::string_view name = "photometric_stereo";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"iterations", 1, 100, "1", "reweighting steps"}, self.iterations);
        visit(FieldInfo{"outlier_scale", 1e-3, 10, "1", "relative residual at which a sample weighs half"},
              self.outlier_scale);
        visit(FieldInfo{"shadow", 0, 1, "1", "of a pixel's bright samples, below which it starts as shadow"},
              self.shadow);
        visit(FieldInfo{"highlights", 0, 0.5, "1", "part of a pixel's samples that start as highlights"},
              self.highlights);
    }
};

struct LambertEstimate {
    glm::dvec3 normal{0, 0, 1};  // [unit vector], z > 0
    glm::dvec3 diffuse{0};       // [1] rho_d per channel; the same in all three for grey photographs
    bool valid = false;          // false: dark under every light, or fewer than three usable samples
};

// Fits grey = g . l by least squares, reweighted by Geman & McClure's function so that highlights and shadows
// count little. Starts from the samples between the quartiles of value / cosine, where neither is common.
LambertEstimate photometric_stereo(const PixelSamples& samples, const PhotometricStereoOptions& options = {});

}  // namespace tangi
