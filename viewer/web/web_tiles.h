// web_tiles.h: texels as a web page fetches them: small tiles, compressed without loss.
//
// A tile is the zlib stream (RFC 1950, which browsers inflate) of these planes, for each of web_fields() in
// turn: the low bytes of all its texels, row by row, and, where a field has more than 8 bits, the high bytes.
// A value is what the median edge detector (Weinberger, Seroussi & Sapiro 2000, "LOCO-I") left of the
// field's code modulo 2^bits, the sign in the lowest bit: 0, -1, 1, -2, … as 0, 1, 2, 3, ….
//
// Bytes and not pictures: a browser may convert a picture's colours, multiply them by alpha, or blur what is
// read back of them, and a page that was opened from a disk may not read pictures beside it at all.
#pragma once

#include <array>
#include <span>
#include <string>

#include "viewer/render/horizon.h"
#include "viewer/render/texels.h"
#include "viewer/web/web_data.h"

namespace tangi {

// How a tile with losses (lossy_tiles.h) holds a part: as one of three channels of a colour picture, as a
// grey picture, or as it is, since codes beside each other mean different things.
enum class Packing { colour, grey, exact };

// A part of a texel (texels.h), and how many of its bits a page gets: the others are below what can be seen.
struct WebField {
    int word = 0, shift = 0, bits = 0;
    int kept = 0;  // a code c stands for round(c (2^bits - 1) / (2^kept - 1))
    Packing packing = Packing::grey;
};
inline constexpr std::array<WebField, 9> kWebFields = {{{0, 0, 16, 14},  // normal
                                                        {0, 16, 16, 14},
                                                        {1, 0, 11, 11, Packing::colour},  // rho_d
                                                        {1, 11, 11, 11, Packing::colour},
                                                        {1, 22, 10, 10, Packing::colour},
                                                        {2, 0, 16, 12},    // rho_s
                                                        {2, 16, 16, 12},   // alpha
                                                        {3, 0, 8, 6},      // confidence
                                                        {3, 8, 24, 16}}};  // height
// The same where lobes have colours.
inline constexpr std::array<WebField, 12> kColouredWebFields = {
    {{0, 0, 16, 14},
     {0, 16, 16, 14},
     {1, 0, 11, 11, Packing::colour},
     {1, 11, 11, 11, Packing::colour},
     {1, 22, 10, 10, Packing::colour},
     {2, 0, 12, 12},
     {2, 12, 13, 12},
     {2, 25, 7, 7, Packing::exact},  // the lobe's colour
     {3, 0, 6, 6},
     {3, 6, 2, 2, Packing::exact},
     {3, 8, 7, 7, Packing::exact},
     {3, 15, 17, 16}}};
// The same where lobes are anisotropic.
inline constexpr std::array<WebField, 14> kDrawnOutWebFields = {
    {{0, 0, 13, 13},
     {0, 13, 12, 12},
     {0, 25, 7, 7, Packing::exact},  // the lobe's colour
     {1, 0, 10, 10, Packing::colour},
     {1, 10, 10, 10, Packing::colour},
     {1, 20, 9, 9, Packing::colour},
     {1, 29, 3, 3},
     {2, 0, 11, 11},
     {2, 11, 12, 12},
     {2, 23, 7, 7, Packing::exact},
     {2, 30, 2, 2, Packing::exact},
     {3, 0, 8, 8},  // its stretch
     {3, 8, 8, 8},
     {3, 16, 16, 16}}};
inline std::span<const WebField> web_fields(const TexelRange& range) {
    if (range.anisotropic_specular) return kDrawnOutWebFields;
    if (range.coloured_specular) return kColouredWebFields;
    return kWebFields;
}

// Where the texels of a tile begin in its level, and how many there are: 256 a side, fewer at the right and
// lower border.
struct TilePlace {
    int level = 0, x0 = 0, y0 = 0, width = 0, height = 0;
};
TilePlace place_of(const TexelTiles& tiles, const TileName& name);

// This tile, compressed; and only these fields of it.
std::string web_tile(const TexelTiles& tiles, const TileName& name);
std::string web_tile(const TexelTiles& tiles, const TileName& name, std::span<const WebField> fields);

// The same of a map of horizons: all values, slice by slice, each less its left neighbour modulo 256.
std::string web_horizon(const HorizonMap& map);

}  // namespace tangi
