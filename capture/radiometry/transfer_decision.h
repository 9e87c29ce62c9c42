// transfer_decision.h: the transfer curve of a stack, from what its files say and what its photographs look
// like.
#pragma once

#include "capture/radiometry/transfer_estimate.h"

namespace tangi {

// estimate_transfer(), but for photographs that all state one curve: then that one, with a warning where it
// binds and the photographs look otherwise. Metadata that do not bind, and that the photographs contradict,
// that contradict each other, or that cannot be used, are told in the warning and not used. Reads the headers
// of the photographs.
TransferEstimate decide_transfer(const Stack& stack, const Survey& survey);

}  // namespace tangi
