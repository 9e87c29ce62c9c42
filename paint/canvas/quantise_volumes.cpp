#include "paint/canvas/quantise_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

constexpr int kSize = PaintTile::kSize;
constexpr float kCoarse_mm = 2;  // from here on floats are no finer than the grid

constexpr double kNothing_mm = 1e-3 * double(kVolumeGrid_mm);  // of a paint in a tile

static_assert(kCoarse_mm * 0x1p-23f == kVolumeGrid_mm);

// Adding 2 mm leaves no room for digits finer than the grid.
TP_INLINE float rounded(float mm) {
    return mm < kCoarse_mm ? std::max(0.0f, (mm + kCoarse_mm) - kCoarse_mm) : mm;
}

// `owed` [mm]: for each column, what is still to be added.
TP_VECTOR_CLONES
void settle_row(const float* __restrict before, const float* __restrict there, float* __restrict owed,
                float* __restrict row) {
    for (int x = 0; x < kSize; ++x) {
        // Where there is nothing any more, nothing comes.
        const float settled = there[x] > 0 ? rounded(there[x] + owed[x]) : 0.0f;
        const float now = there[x] != before[x] ? settled : there[x];
        owed[x] += there[x] - now;
        row[x] = now;
    }
}

using Plane = std::array<float, PaintTile::kPixels>;

bool same_row(const float* before, const float* plane, int y) {
    return std::memcmp(before + y * kSize, plane + y * kSize, kSize * sizeof(float)) == 0;
}

void settle(const float* before, float* plane) {
    // A stroke changed a few rows of the tile.
    int first = 0, end = kSize;
    while (first < end && same_row(before, plane, first)) ++first;
    while (first < end && same_row(before, plane, end - 1)) --end;
    Plane there;
    std::array<float, kSize> owed{};
    for (int y = first; y < end; ++y) {
        float *row = plane + y * kSize, *was = there.data() + y * kSize;
        std::copy_n(row, kSize, was);
        settle_row(before + y * kSize, was, owed.data(), row);
    }
    // What columns are still owed, in single steps; and what is less than one where there is paint, but for
    // next to nothing.
    double rest = 0;
    for (const float mm : owed) rest += static_cast<double>(mm);
    float* takes = nullptr;
    for (auto i = static_cast<std::size_t>(first * kSize); i < static_cast<std::size_t>(end * kSize); ++i) {
        if (there[i] == before[i] || !(there[i] > 0)) continue;
        const float step = rest > 0 ? kVolumeGrid_mm : -kVolumeGrid_mm;
        if (std::abs(rest) > kVolumeGrid_mm / 2 && plane[i] + step >= 0 && plane[i] < kCoarse_mm) {
            plane[i] += step;
            rest -= static_cast<double>(step);
        }
        if (!takes || *takes < kVolumeGrid_mm) takes = plane + i;
        if (std::abs(rest) <= kVolumeGrid_mm / 2 && *takes >= kVolumeGrid_mm) break;
    }
    if (takes && std::abs(rest) > kNothing_mm) *takes = std::max(*takes + static_cast<float>(rest), 0.0f);
}

}  // namespace

float on_grid(float mm) { return rounded(mm); }

void settle(PaintTile& tile, const PaintTile* as_it_was) {
    static constexpr Plane kEmpty{};
    for (std::size_t i = 0; i < tile.ingredients.size(); ++i) {
        const auto before = as_it_was ? as_it_was->plane(tile.ingredients[i]) : std::span<const float>();
        settle(before.empty() ? kEmpty.data() : before.data(),
               tile.thickness_mm.data() + i * PaintTile::kPixels);
    }
    tile.drop_empty();
}

}  // namespace tangi
