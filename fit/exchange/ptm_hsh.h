// ptm_hsh.h: polynomial texture maps and hemispherical harmonics, least squares at each pixel: what RTI
// viewers show, and the yardstick for the Ward fit.
//
// Both predict stored values (in the photographs' encoding, 0..1) as a linear combination of functions of the
// light's direction alone: lights count as distant and equally strong.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "capture/stack/stack.h"
#include "surface/base/progress.h"
#include "surface/render/relight.h"

namespace tangi {

// ptm: u^2, v^2, u v, u, v, 1 of the direction's x = u and y = v (Malzbender, Gelb, Wolters 2001, eq. 1).
// hsh: hemispherical harmonics of the first 2, 3 or 4 bands (Gautron, Krivanek, Pattanaik, Bouatouch 2004, "A
// novel hemispherical basis for accurate and efficient rendering"), real, band by band from -l to l as .rti
// files order them, and with their signs.
enum class RtiBasis { ptm, hsh4, hsh9, hsh16 };

constexpr int kMostRtiTerms = 16;
int terms_of(RtiBasis basis);
std::string_view name_of(RtiBasis basis);  // "ptm", "hsh4", "hsh9", "hsh16"

// The functions at a unit vector; those beyond terms_of() are 0. Directions below the surface count as level.
std::array<double, kMostRtiTerms> rti_terms(RtiBasis basis, const Vec3& direction);

// Of a picture: coefficients for each channel, or for the brightness alone, whose colour is then one for all
// lights.
struct RtiImage {
    RtiBasis basis = RtiBasis::ptm;
    bool lrgb = false;
    int width = 0, height = 0;
    std::vector<float> coefficients;  // [pixel][channel (1 where lrgb)][term]
    Image<Rgb> colour;                // where lrgb: largest channel 1; else empty

    int channels() const { return lrgb ? 1 : 3; }
    std::size_t stride() const { return static_cast<std::size_t>(channels() * terms_of(basis)); }
};

// Least squares over all photographs of the stack (not those held out), each channel on its own; values as
// stored. Clipped values count as they are, those that a registered photograph does not have are left out; a
// pixel with fewer of them than terms is 0. Read in bands: memory is that of the coefficients, whatever the
// number of photographs. Developed stacks, and photographs that are `stored_linear`, are encoded as sRGB:
// viewers show values as they are. Throws Error where there are fewer
// photographs than terms, or their lights leave a term open (all at one elevation); Cancelled.
RtiImage fit_rti(const Stack& stack, RtiBasis basis, bool lrgb = false, const Progress& progress = {},
                 bool stored_linear = false);

// Of a painting, relit from `directions` distant lights of strength 1 evenly over the hemisphere down to
// lowest_deg, encoded by `transfer`; one relit picture is in memory at a time.
struct RtiSampling {
    int directions = 80;     // [1] more than twice the terms
    double lowest_deg = 10;  // [deg] elevation
    RelightOptions relight{.cast_shadows = true};
};
RtiImage rti_of(const Surface& surface, RtiBasis basis, bool lrgb, const Transfer& transfer,
                const RtiSampling& sampling = {}, const Progress& progress = {});

// The directions of it, on a spiral whose points have equal areas.
std::vector<Vec3> hemisphere_directions(int count, double lowest_deg);

// The picture under a light, in the encoding that was fitted; not clamped.
Image<Rgb> evaluate(const RtiImage& image, const Vec3& direction);

}  // namespace tangi
