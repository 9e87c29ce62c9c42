// transfer_estimate.h: which transfer curve the photographs were stored with, from the photographs
// themselves.
#pragma once

#include <string>
#include <vector>

#include "capture/stack/survey.h"

namespace tangi {

struct TransferEstimate {
    Transfer transfer;
    std::string
        source;  // "given", "float file", "estimated"; "developed, …": made linear before (develop_stack)
    // Each curve tried, linear light first; empty unless estimated. Robust residual of matt reflection, in
    // the stored encoding [1]; how probable it is, of these [1]; by how much slopes would change with it
    // [deg].
    struct Candidate {
        Transfer transfer;
        double residual = 0, probability = 0, slopes_change_deg = 0;
    };
    std::vector<Candidate> candidates;
    std::string warning;  // empty unless the choice is open, or a curve
    std::string doubt{};  // why the result is poor: the choice is open, and slopes hang on it; else empty
};

// The curve given in stack.transfer; linear for files of floats; else the most probable one of linear, sRGB
// and gamma 2.2 (transfer_evidence.h); another gamma where it fits clearly better than all three, and a
// smooth curve where that fits far better than any gamma. Each photograph may have light of its own strength,
// which may fall off over the picture: so lights that differ, or are near, do not pass for a curve.
TransferEstimate estimate_transfer(const Stack& stack, const Survey& survey);

// Whether the photographs contradict what files state, `estimated` being what they look like. Near lights,
// metal and high relief bend what photometric stereo sees through, and what files state is right ten times
// as often as not.
bool speaks_against(const Transfer& stated, const TransferEstimate& estimated, const Stack& stack,
                    const Survey& survey);

}  // namespace tangi
