// ground.h: what a new painting of the web application is painted on, from what the page says of it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>

#include "surface/maps/surface.h"

namespace tangi {

// What a pixel of a painting at work takes at least: its maps, texels of all levels of detail
// (Easel::bytes()), and, of pictures and files, what they are made of while they are opened.
constexpr double kBytesOfPixel = 44 + 16 * 4 / 3.0 + 44;

// Throws Error where a painting of so many pixels would take more than `memory_bytes` (0: it may be of any
// size), before there is anything of it in memory.
void require_memory_for(double width, double height, double memory_bytes);

// A picture as browsers decode it: RGBA, 8 bits each, sRGB, row by row from the top.
struct RgbaPicture {
    int width = 0, height = 0;
    std::span<const std::uint8_t> bytes;
};

// `choice`: {"substrate": "linen", "width_mm": 200, "height_mm": 150, "pixel_mm": 0.2, "seed": 1} for a
// procedure (paint/substrate/substrate.h), or {"picture": true, "pixel_mm": 0.2, "relief_mm": 0.2,
// "height_from": "luminance"} for `picture` ("none": it is flat; "picture": its relief is that of `relief`'s
// red channel). Either may have "tint": [r, g, b], "specular" and "roughness" (SubstrateFinish). Throws Error
// where it makes no sense, and require_memory_for()'s, of "memory_bytes".
Surface make_ground(const nlohmann::json& choice, const RgbaPicture& picture = {},
                    const RgbaPicture& relief = {});

}  // namespace tangi
