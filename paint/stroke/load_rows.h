// load_rows.h: how loads, which lie on whole pixels, go along a stroke of any direction.
//
// Steps go from row to row of pixels across the motion: columns, rows or diagonals, whichever are nearest to
// being square to it. So loads neither fall behind the bristles that they are on nor catch up, which would
// leave rungs; only to the side are they off, by up to half of the way from one pixel of a row to the next.
#pragma once

namespace tangi {

// Rows of the pixels p on which ax px + ay py has one value, a whole number.
struct LoadRows {
    int ax, ay;     // each -1, 0 or 1; towards where the motion goes
    double per_px;  // rows that one pixel of the way crosses

    double at(double x, double y) const { return ax * x + ay * y; }
};

// Of a motion in the direction of this unit vector; columns where it is 0, 0.
LoadRows rows_across(double dx, double dy);

// The pixel of a row, at the point where a motion through (x, y) crosses it, or beside that point by `shift`,
// -0.5..0.5, parts of the way from one pixel of the row to the next. Of the nearest row, or, of a step that
// `passes` one, of that: up to where the next one begins.
struct LoadPixel {
    int x, y;
};
LoadPixel pixel_of_row(double x, double y, double dx, double dy, double shift, bool passes);

// [pixels] The way of the next step of a brush at row `at`: of about `wanted_px`, and so that it passes each
// row in whole steps.
double way_to_row_px(const LoadRows& rows, double at, double wanted_px);

}  // namespace tangi
