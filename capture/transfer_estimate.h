// transfer_estimate.h: which transfer curve the photographs were stored with, from the photographs
// themselves.
#pragma once

#include <string>
#include <vector>

#include "capture/survey.h"

namespace tangi {

struct TransferEstimate {
    Transfer transfer;
    std::string source;  // "given", "float file", "estimated"
    // Robust residual of matt reflection for each curve tried, in the stored encoding [1]; empty unless
    // estimated.
    struct Candidate {
        Transfer transfer;
        double residual = 0;
    };
    std::vector<Candidate> candidates;
};

// The curve given in stack.transfer; linear for files of floats; else the one of linear, sRGB and gamma 2.2
// under which the samples agree best with matt reflection, deviations being compared in the stored encoding.
// Lights are taken to be of equal strength: where they are not, the deviations differ less, but in the same
// sense.
TransferEstimate estimate_transfer(const Stack& stack, const Survey& survey);

}  // namespace tangi
