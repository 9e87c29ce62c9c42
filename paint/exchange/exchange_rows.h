// exchange_rows.h: what bristles and canvas exchange along one row, for exchange() and exchange_and_push()
// (transfer.h).
#pragma once

#include "paint/exchange/transfer.h"

namespace tangi {

// Row y of the box. `memory` has room for two rows of it.
void exchange_in_row(const StepBox& box, const TransferRates& rates, int y, float* memory);

}  // namespace tangi
