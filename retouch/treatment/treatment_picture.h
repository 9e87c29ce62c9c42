// treatment_picture.h: pictures of a treatment for people: states under a light, the damage map with its
// legend, additions in false colour.
#pragma once

#include "retouch/treatment/treatment.h"
#include "surface/maps/light.h"

namespace tangi {

// sRGB-encoded, 0..1, exposed so that light from 45 degrees shows a white as white; at most `side_px` pixels
// wide and high (0: all of them). Raking light does not come near white: it is as dark as the illuminant
// makes it.
Image<Rgb> look_of(const Surface& surface, const Light& light, int side_px = 0,
                   const Progress& progress = {});

// Means of pixels, so that the picture is at most so wide and so high [pixels]; 0: as it is.
Image<Rgb> reduced(const Image<Rgb>& picture, int most_wide, int most_high);

// The diffuse colour alone, sRGB-encoded; of a surface, and given as such.
Image<Rgb> colour_of(const Surface& surface, int side_px = 0);
Image<Rgb> encoded(Image<Rgb> diffuse);

// Masks in the colours of their classes over the painting in grey, sRGB-encoded.
Image<Rgb> damage_map(const Treatment& treatment, const Surface& surface, const MasksToCome& to_come = {});
// The same with a legend below it: count, area and percent of each class.
Image<Rgb> damage_picture(const Treatment& treatment, const Surface& surface,
                          const MasksToCome& to_come = {});

// What was added in false colour over the painting in grey: fills green, varnish yellow, retouches blue where
// they belong, red where they lie on original outside of `belongs`.
Image<Rgb> additions_picture(const Canvas& canvas, const std::vector<TreatmentLayer>& layers,
                             const Mask& belongs);

}  // namespace tangi
