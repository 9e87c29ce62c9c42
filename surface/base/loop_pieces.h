// loop_pieces.h: what is done between the pieces of parallel loops' work (parallel.h).
#pragma once

namespace tangi {

// From now on called by each thread of parallel_for() after every `grain` items and a few more; nothing where
// null.
void set_between_pieces(void (*between)());

// Does that now, for a body that goes over many places of large images for one item.
void end_piece();

}  // namespace tangi
