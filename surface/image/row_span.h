// row_span.h: a run of pixels in a row.
#pragma once

namespace tangi {

// Columns begin <= x < end of a row.
struct RowSpan {
    int begin = 0, end = 0;
};

}  // namespace tangi
