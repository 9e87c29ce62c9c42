// mixture_colours.h: the colours that piles of paint give over the grounds of a loss; for sources of this
// module only.
#pragma once

#include <utility>
#include <vector>

#include "retouch/inpaint/retouch_modes.h"

namespace tangi {

// A colour at hand: paints by volume (sum 1) and what a film of them looks like.
struct Colour {
    std::vector<std::pair<int, float>> volumes;
    std::vector<std::pair<int, float>> piles;  // and their parts
    Spectrum look{};
    Lab lab;
};

// At most `groups` colours that stand for these, linear Rec. 709; the first where all are much alike.
std::vector<Rgb> groups_of(const std::vector<Rgb>& colours, int groups);

// The pile for a film of options.thickness_mm over this ground.
Pile pile_for(const Rgb& colour, const Spectrum& below, const Palette& palette,
              const RetouchOptions& options);

// Colours of the piles and, by choice, of mixtures of any two whose paints may come together
// (MatchOptions::allowed).
std::vector<Colour> colours_of(const std::vector<Pile>& piles, bool blends, const Palette& palette,
                               const Spectrum& below, const RetouchOptions& options);

// For every pixel inside, the number of the colour at hand that looks nearest; -1 elsewhere.
Image<int> nearest_colours(const Mask& mask, const Image<Rgb>& target, const std::vector<Colour>& colours);

// The grounds that show through in the parts of a loss.
struct Grounds {
    std::vector<Spectrum> spectra;       // each of its own
    std::vector<unsigned char> of_part;  // its number
};

// What lies below a part of a loss, and on how many pixels.
struct PartGround {
    Spectrum below{};
    double pixels = 0;
};

// Parts share a ground where films of the probes look the same over both: CIEDE2000 1 on average. With no
// probe, where the grounds themselves do. At most 8; what is more goes to the nearest.
Grounds grounds_of(const std::vector<PartGround>& parts, const std::vector<Pile>& probes,
                   const Palette& palette, double thickness_mm);

}  // namespace tangi
