// texture_synthesis.h: carries pictures on into a hole with patches of what is around: strokes and weave,
// which a membrane does not carry on. What comes out is made up: a proposal, not what was there.
#pragma once

#include <cstdint>
#include <vector>

#include "retouch/mask/mask.h"
#include "surface/base/progress.h"

namespace tangi {

struct SynthesisChannel {
    Image<float> values;  // in units in which a difference of 1 counts alike in all channels
    bool guide = false;   // is known in the hole as well, and stays: what is synthesised goes along with it
};

struct SynthesisOptions {
    int patch_px = 7;  // side of a patch; odd
    std::uint64_t seed = 1;
};

// Replaces the channels' values where `hole` is 1/2 and more, in place. Patches come from where `usable` is
// 1/2 and more and the hole is not. Every patch that touches the hole is to be like one of the surroundings:
// coarse to fine, nearest patches are looked for (PatchMatch: Barnes, Shechtman, Finkelstein, Goldman 2009)
// and each pixel becomes the weighted mean of what the patches over it say (Wexler, Shechtman, Irani 2007).
// The same for the same seed. False, and nothing changed, where there is no whole patch to take;
// ContractError where sizes differ or no pixel is known; Cancelled.
bool synthesise_into(std::vector<SynthesisChannel>& channels, const Mask& hole, const Mask& usable,
                     const SynthesisOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
