// surface_channels.h: the maps of a surface as the channels of a painting file's part `dry`: their names,
// their hash, and what cannot be relit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "surface/maps/surface.h"

namespace tangi {

inline constexpr std::array kLobeChannels = {"lobe.R", "lobe.G", "lobe.B"};
inline constexpr std::array kAxesChannels = {"roughness.V", "tangent"};

// One channel and where its floats lie in a Surface.
struct DryChannel {
    const char* name;
    float* base;
    std::size_t stride;  // [floats] from pixel to pixel
};

// Paintings whose lobes are all white have no colours of them, neither in memory nor in the file; and those
// whose lobes are all isotropic no axes.
std::vector<DryChannel> channels_of(Surface& surface);

// Maps that another program wrote, or changed, may hold what cannot be relit. Our own come through bit for
// bit. What is wrong in the rows [y0, y1), the first of each row, goes into wrong[y].
void make_usable(Surface& surface, int y0, int y1, std::vector<std::string>& wrong);

// The first of what make_usable() would call wrong, of all rows; empty where a surface can be written and
// read again.
std::string first_wrong(const Surface& surface);

// Hashes of the rows [y0, y1), into hashes[y].
void hash_rows(std::span<const DryChannel> channels, int width, int y0, int y1,
               std::span<std::uint64_t> hashes);

// Those of all rows of a surface, on all threads.
void hash_all_rows(const Surface& surface, std::span<std::uint64_t> hashes);

// Of the whole. Rows are hashed side by side and their hashes joined in order, so threads don't change it.
std::string joined_hash(std::span<const std::uint64_t> rows);

}  // namespace tangi
