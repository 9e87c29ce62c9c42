// mask.h: areas of a painting as coverage: what is damaged, filled, retouched, or may be painted on.
//
// A mask is an image of the painting's size; each number is the part of the pixel, 0..1, that belongs to the
// area. Outlines are in pixels from the top left corner of the picture, y down, so that pixel (x, y) covers
// [x, x + 1] x [y, y + 1]: the coordinates of SVG and of W3C selectors.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

using Mask = Image<float>;

inline bool inside(float coverage) { return coverage >= 0.5f; }

struct Corner {
    double x = 0, y = 0;  // [pixels] from the top left corner
};
// Closed; the last corner is not the first again.
using Polygon = std::vector<Corner>;

struct MaskArea {
    double mm2 = 0;
    double percent = 0;  // of the picture
    int regions = 0;     // that do not touch each other, of coverage above 1/2; corners touch
};
MaskArea area_of(const Mask& mask, double mm_per_pixel);

// One connected region of coverage above 1/2.
struct MaskRegion {
    Region box;
    int pixels = 0;
};
// Numbers of the regions, 1.. in the order in which rows meet them, 0 outside; and what they are.
struct MaskRegions {
    Image<int> number;
    std::vector<MaskRegion> regions;  // regions[number - 1]
};
MaskRegions regions_of(const Mask& mask);
// All that hangs together with this pixel, of any coverage, across corners, too: 1 there. Empty where the
// mask is 0 there, or the place is outside.
Mask connected_at(const Mask& mask, int x, int y);

// 8-bit grey PNG, white inside. Coverage is rounded to 1/255.
void write_mask(const std::filesystem::path& path, const Mask& mask);
// The same in memory.
Mask as_kept(const Mask& mask);
// Any picture that OpenImageIO reads, its mean over the channels, as stored: 1 (white) inside. Of one with an
// alpha channel, what is transparent is outside: coverage is whiteness times alpha; where there are
// transparent parts and all that can be seen is of one tone, alpha alone. Throws Error naming the file where
// it has another size than the painting's.
Mask read_mask(const std::filesystem::path& path, int width, int height);

// Coverage of the inside of closed polygons: exact along rows, over 16 lines a pixel. A polygon that crosses
// itself holds all that it goes round (nonzero winding); a polygon within another is a hole (even-odd, of
// polygons). Throws Error for corners that are not finite, fewer than three of them, polygons that enclose
// nothing, and areas of which nothing lies in the picture.
Mask mask_of_polygons(const std::vector<Polygon>& polygons, int width, int height);

// The line where coverage, linear between pixel centres, is 1/2 (marching squares: Lorensen & Cline 1987 in
// two dimensions), simplified by `tolerance_px` (Douglas & Peucker 1973); polygons of less than
// `smallest_px2` are left out. Outlines of holes run the other way round.
std::vector<Polygon> outlines_of(const Mask& mask, double tolerance_px = 0.5, double smallest_px2 = 1);

// [pixels] Distance from the pixel's centre to the outline at 1/2: above 0 inside, below 0 outside. Where
// there is nothing inside (or outside), minus (plus) the picture's width + height.
Image<float> distance_inside_px(const Mask& mask);

// Every pixel within `radius_px` of the area; with a negative radius, what is left when the outside grows.
Mask dilated(const Mask& mask, double radius_px);

// An edge that rises over `width_px`, from 0 at the old outline to 1 inside: the area never grows.
Mask feathered(const Mask& mask, double width_px);

// max(a, b), min(a, b), min(a, 1 - b). Throw ContractError where sizes differ.
Mask united(const Mask& a, const Mask& b);
Mask intersected(const Mask& a, const Mask& b);
Mask without(const Mask& a, const Mask& b);

}  // namespace tangi
