// other_paint.h: where what a stroke lays stays above.
#pragma once

#include <map>
#include <set>

#include "paint/brush.h"
#include "paint/paint_layer.h"

namespace tangi {

// Whether a stroke has met other wet paint than its brush brought: from then on, what it lays stays above as
// an upper film. Of one stroke, and by what lay there before it: how steps are grouped does not matter.
class OtherPaint {
public:
    explicit OtherPaint(const Brush& brush);
    // To be asked for each step in its turn, before it is painted; `box`: the pixels that it may change.
    bool met(const PaintLayer& wet, const Region& box);

private:
    bool is_in(const PaintLayer& wet, TileIndex at) const;

    std::map<IngredientId, double> brought_;  // parts by volume; empty where the brush has no paint
    std::set<TileIndex> seen_;
    bool met_ = false;
};

}  // namespace tangi
