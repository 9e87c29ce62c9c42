// line_colours.h: which pure colour each line or dot of a retouch is painted with, so that the mean of them
// is the colour wanted everywhere.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "retouch/inpaint/retouch_modes.h"

namespace tangi {

struct LineColours {
    std::vector<Pile> piles;
    Image<int> pile;  // of each pixel; -1 where nothing is painted
};

struct LinesToColour {
    const Image<int>& owner;   // the mark of each pixel, -1 for none (hatching.h)
    const Mask& mask;          // those outside of it are not looked at
    const Image<Rgb>& target;  // linear Rec. 709 under D65
    std::vector<Rgb> groups;   // colours that stand for the target's
    std::vector<Pile> gaps;    // recipes for what is between marks, one a group; empty: it stays bare
    double blur_px = 0;        // over which the mean is to be right
};

// Each group gets pure colours of its own (optical_mixing.h), from the paints by themselves and with white or
// black, where options.match.allowed lets them come together; `below` is what they are laid on. A mark takes
// that of its group's colours which leaves the least error of XYZ, seen through means over `blur_px`, with
// what its neighbours have: descent by single marks, as in halftoning by direct search (Analoui & Allebach
// 1992). Throws Error where no mark lies in the mask.
LineColours line_colours(const LinesToColour& lines, const Palette& palette, const Spectrum& below,
                         const RetouchOptions& options);

// CIEDE2000 between means over square cells that lie in the mask to a half and more.
class FusedDifference {
public:
    FusedDifference(const Mask& mask, int cell_px);
    void add(int x, int y, const Spectrum& look, const Spectrum& target);
    std::array<double, kIlluminants> means() const;  // weighted by area; cells that are cut short left out

private:
    struct Cell {
        std::array<double, kBands> look{}, target{};
        int pixels = 0;
    };
    int cell_px_;
    std::map<std::pair<int, int>, Cell> cells_;
};

}  // namespace tangi
