// viewing_distance.h: what a picture looks like from a distance: at which one lines fuse, and in what colour.
#pragma once

#include <vector>

#include "retouch/mask/mask.h"
#include "surface/base/options.h"
#include "surface/image/image.h"

namespace tangi {

// Sensitivity [1], the reciprocal of the lowest contrast (amplitude over mean) that the eye sees of a sine
// grating: Barten's formula for a standard observer (2004, eq. 14), for `cycles_per_degree` > 0, adapting
// luminance [cd/m^2] and angular size [deg] of the field.
double contrast_sensitivity(double cycles_per_degree, double luminance_cd_m2, double field_deg);

struct ViewingOptions {
    double luminance_cd_m2 = 60;  // of white: 200 lx on a painting, as museums have it

    static constexpr std::string_view name = "viewing";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"luminance_cd_m2", 0.1, 1e4, "cd/m2", "of a white surface beside the painting"},
              self.luminance_cd_m2);
    }
};

// A linear Rec. 709 picture as the eye has it from `distance_m`: each of three opponent channels blurred by
// the eye's (Zhang & Wandell 1997, S-CIELAB: Poirson & Wandell's channels and sums of Gaussians), the
// picture going on at its borders. Its colours can be compared by CIEDE2000.
Image<Rgb> seen_from(const Image<Rgb>& linear, double mm_per_pixel, double distance_m);

// The same for people, who look at it with eyes of their own: what is grey stays grey, and no colour comes
// about that is none of the picture's. Above, channels are blurred alone: where light and dark meet, hues of
// the wide ones lie on the sharp one, which compare well and look false. Here the wide ones say how much
// colour there is for the light that there is, white having none.
Image<Rgb> shown_from(const Image<Rgb>& linear, double mm_per_pixel, double distance_m);

// [1] The largest contrast of `pattern` against `mean` inside the mask, in units of what is just seen from
// `distance_m`: the pattern's contrast, luminance differences over local mean, weighted by the sensitivity at
// each frequency; 99th percentile. Below 1 the pattern has fused.
double visible_contrast(const Image<Rgb>& pattern, const Image<Rgb>& mean, const Mask& mask,
                        double mm_per_pixel, double distance_m, const ViewingOptions& options = {});

constexpr double kFarthest_m = 30;  // that anybody looks at a painting from

struct Fusion {
    double distance_m = 0;  // from which on the pattern is not seen: between 0.1 and kFarthest_m
    bool fuses = false;     // false: it is seen from kFarthest_m still
    double delta_e_near = 0,
           delta_e_fused = 0;  // mean CIEDE2000 from the target: at 0.3 m, and where it fuses
};

// Where a retouch of lines or dots fuses, and how near its colour is to the target there. `retouched` is the
// picture with it, `target` what it should look like; both linear Rec. 709, equal outside of the mask. The
// pattern is what is left of the retouch without its means over `pitch_px`.
Fusion fusion_of(const Image<Rgb>& retouched, const Image<Rgb>& target, const Mask& mask, double pitch_px,
                 double mm_per_pixel, const ViewingOptions& options = {});

}  // namespace tangi
