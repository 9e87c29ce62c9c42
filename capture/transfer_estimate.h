// transfer_estimate.h: which transfer curve the photographs were stored with, from the photographs
// themselves.
#pragma once

#include <string>
#include <vector>

#include "capture/survey.h"

namespace tangi {

struct TransferEstimate {
    Transfer transfer;
    std::string
        source;  // "given", "float file", "estimated"; "developed, …": made linear before (develop_stack)
    // Robust residual of matt reflection for each curve tried, in the stored encoding [1]; empty unless
    // estimated.
    struct Candidate {
        Transfer transfer;
        double residual = 0;
    };
    std::vector<Candidate> candidates;  // linear, sRGB, gamma 2.2, the best gamma; a curve where chosen
    std::string warning;                // empty unless the choice is a close one, or a curve
};

// The curve given in stack.transfer; linear for files of floats; else the one of linear, sRGB and gamma 2.2
// under which the samples agree best with matt reflection, deviations being compared in the stored encoding;
// another gamma where it fits clearly better than all three, and a smooth curve where that fits far better
// than any gamma. Each photograph may have light of its own strength, which may fall off over the picture: so
// lamps that differ, or are near, do not pass for a curve.
TransferEstimate estimate_transfer(const Stack& stack, const Survey& survey);

// Whether the photographs contradict what files state, `estimated` being what they look like. Near lamps,
// metal and high relief bend what photometric stereo sees through: of generated stacks in sRGB, a third
// looks more like linear light or a gamma of 1.3 to 1.6. And few photographs hardly tell curves apart, as
// their own unknowns (albedo and slopes, three a pixel) take up most of what a wrong one leaves.
bool speaks_against(const Transfer& stated, const TransferEstimate& estimated, const Stack& stack,
                    const Survey& survey);

}  // namespace tangi
