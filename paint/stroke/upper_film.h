// upper_film.h: where what a stroke lays stays above.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "paint/brush/brush.h"
#include "paint/canvas/paint_layer.h"

namespace tangi {

// Whether a stroke has met other wet paint than its brush brought: from then on, what it lays stays above as
// an upper film. Of one stroke, and by what lay there before it: how steps are grouped does not matter, nor
// where tiles begin.
class UpperFilm {
public:
    explicit UpperFilm(const Brush& brush);
    // To be asked for each step in its turn, before it is painted; `box`: the pixels that it may change.
    // Other paint is met where bristles come over it.
    bool met(const PaintLayer& wet, const Brush& brush, const Dab& dab, const Region& box);

private:
    // [mm] Thickness of all paint at each pixel that other paint is in, 0 at others; null: nowhere.
    using Depths = std::array<float, static_cast<std::size_t>(PaintTile::kPixels)>;

    std::unique_ptr<const Depths> where(const PaintTile& tile) const;
    bool is_under(const Brush& brush, const Dab& dab, const Region& part) const;

    std::vector<double> brought_;  // parts by volume of each paint; empty where the brush has none
    std::map<TileIndex, std::unique_ptr<const Depths>> seen_;  // as tiles were before the stroke
    bool met_ = false;
};

}  // namespace tangi
