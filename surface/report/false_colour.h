// false_colour.h: numbers as pictures for people: colour maps, legends, titles, the maps of a painting.
//
// All pictures here are sRGB-encoded, 0..1, ready for write_picture_8bit().
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surface/image/metrics.h"
#include "surface/maps/surface.h"

namespace tangi {

// Colour scales whose steps look alike, built in CIELAB so that lightness carries the order (in grey print,
// and for colour-blind eyes, too).
enum class ColourMap {
    // Dark violet, teal, yellow, L* rising evenly from 12 to 92; hues as viridis (Smith, van der Walt 2015).
    sequential,
    // Blue, near-white, red, L* falling evenly either way (after Moreland 2009, "Diverging color maps").
    diverging,
};

// [sRGB] colour at t = 0..1, clamped; kNoValue where t is not a number.
Rgb colour_at(ColourMap map, double t);
constexpr Rgb kNoValue{0.5f, 0.5f, 0.5f};

struct ValueRange {
    double lo = 0, hi = 1;
};

// From percentile `part` to percentile 1 - part of the values that count, so that a few wild pixels do not
// flatten the rest; never empty: a constant gets a range around it.
ValueRange robust_range(const Image<float>& values, const PixelMask& mask = {}, double part = 0.01);

// lo and below has the scale's first colour, hi and above its last; kNoValue where the mask leaves a pixel
// out.
Image<Rgb> map_picture(const Image<float>& values, double lo, double hi,
                       ColourMap map = ColourMap::sequential, const PixelMask& mask = {});
// A row of it; an empty mask leaves nothing out.
void map_row(std::span<const float> values, double lo, double hi, ColourMap map,
             std::span<const unsigned char> mask, std::span<Rgb> row);

// The usual picture of normals: 0.5 + 0.5 n, so that flat is (0.5, 0.5, 1).
Image<Rgb> normal_picture(const Image<Vec3>& normal, const PixelMask& mask = {});

// Round numbers in [lo, hi], at most `most` (>= 2) of them, with steps of 1, 2 or 5 times a power of ten.
std::vector<double> ticks(const ValueRange& range, int most = 6);
std::string tick_label(double value, const ValueRange& range);

struct LegendColours {
    Rgb ink{0.1f}, paper{1};
};

// A bar of the colour map with tick labels below, the unit behind the last one; 40 x 16 pixels at least.
Image<Rgb> legend(ColourMap map, const ValueRange& range, std::string_view unit, int width, int height,
                  const LegendColours& colours = {});

// Anti-aliased text whose capitals are `size` pixels high, its top left at (x, y); what lies outside is cut.
// OpenCV's fonts know ASCII only: every other character becomes '?'.
void draw_text(Image<Rgb>& picture, std::string_view text, int x, int y, int size, const Rgb& ink);
int text_width(std::string_view text, int size);

// The picture at width x height: averaged where it shrinks, interpolated where it grows.
Image<Rgb> resized(const Image<Rgb>& picture, int width, int height);
// The same, no side longer than `longest`, proportions kept; the picture itself where it is small enough.
Image<Rgb> shrunk(const Image<Rgb>& picture, int longest);
// The same of a picture of width x height that is never there as a whole: draw(y, row) makes a row of it, on
// any thread, some rows twice.
using PictureRow = std::function<void(int y, std::span<Rgb> row)>;
Image<Rgb> shrunk(int width, int height, int longest, const PictureRow& draw);

// A map of a painting for people.
struct MapPicture {
    std::string key;      // "height", "normal", "diffuse", "specular", "roughness", "confidence"
    std::string title;    // "Height"
    std::string symbol;   // "h", "n", "ρd", …
    std::string meaning;  // one sentence
    std::string unit;     // "mm", "pixels", "1"
    std::optional<ValueRange>
        range;  // of the sequential scale; empty where the picture has none (normals, colour)
    Image<Rgb> picture;
};

// The same without a picture: of a painting that is looked at by parts.
struct MapLook {
    std::string key, title, symbol, meaning, unit;
    std::optional<ValueRange> range;
    std::function<Image<Rgb>(const Surface& part)> draw;
};
// All maps of a painting, in the order above, with the ranges that these pixels of it have.
std::vector<MapLook> map_looks(const Surface& pixels);

// All maps, no side longer than `longest`, in the order above. Unmeasured pixels are kNoValue.
std::vector<MapPicture> map_pictures(const Surface& surface, int longest);

}  // namespace tangi
