// fill_patch.h: a region of a loss that is filled: its level, and where its relief comes from.
#pragma once

#include <array>
#include <vector>

#include "retouch/mask/mask.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// One region of a loss with what is around it, as pictures of their own.
struct FillPatch {
    Region box;                            // of the canvas
    Mask unknown;                          // the region and its rim
    Image<float> level_mm;                 // what the fill is to reach
    std::vector<std::array<int, 2>> ring;  // pixels of the canvas around, which tell the level
};

// What a loss is filled on.
struct FillGround {
    const Image<float>& relief_mm;  // of what is dry
    const Mask& wide;               // the loss with its rim
    const Mask& intact;             // where levels may be read; empty: everywhere but in `wide`
    const Image<float>& depth_px;   // inside of `wide`; below 0 outside
    int rim_px, ring_px;            // widths of the rim, and of the ring around it
};

// A region of a loss, its rim and a ring around it, with the level as a membrane through the ring. Throws
// Error where there is nothing intact around.
FillPatch patch_of(const Region& own, const FillGround& ground);

// The relief finer than `sigma_px`.
Image<float> fine_relief(const Image<float>& height_mm, double sigma_px);

struct ReliefSource {
    const Image<float>& detail_mm;  // the fine relief of the whole canvas
    const Mask& usable;             // where relief may come from
    int reach_px;                   // how far from the patch it is looked for
};

// How far relief may be taken from: another place, or none.
struct ReliefShift {
    int x = 0, y = 0;
    bool found = false;
};

// The place nearby whose relief fits the ring around the patch best. Of a wide reach every `stride`-th place
// is tried, at most every `phase_px`-th, then those next to the best.
ReliefShift best_shift(const FillPatch& patch, const ReliefSource& source, double phase_px);

// What of another place differs from its own membrane, which has the same rim as the patch. It grows from
// `from_px` inside the rim to `to_px`: from the edge of the loss, so that the fill is flush there, where no
// thread has to go on.
struct ReliefRamp {
    float from_px = 0, to_px = 1e-3f;
};

void add_relief(FillPatch& patch, const ReliefShift& shift, const Image<float>& source_mm,
                const Image<float>& depth_px, const ReliefRamp& ramp);

// Relief made of patches whose relief, colour and gloss go on from the rim (texture_synthesis.h), on the
// level smoothed as much as the relief is finer than. `wide` is the loss with its rim. Where there is no
// whole patch, the level stays. False where there was nothing to take relief from.
bool add_patches(FillPatch& patch, const Surface& dry, const Image<float>& levelled_mm,
                 const ReliefSource& source, const Mask& wide, const Progress& progress);

}  // namespace tangi
