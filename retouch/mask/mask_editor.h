// mask_editor.h: a mask while it is being corrected: drawn, erased, undone.
//
// Pixels are in the area or not: what is drawn here is what paint stops at, and paint on a pixel that belongs
// to the original in part would be paint on original. Coordinates are in pixels from the picture's top left
// corner (mask.h). What is done between begin() and end() is one action of undo.
#pragma once

#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "retouch/mask/mask.h"
#include "surface/maps/surface.h"

namespace tangi {

enum class MaskEdit { add, remove };

class MaskDraft {
public:
    MaskDraft() = default;
    explicit MaskDraft(Mask mask) : mask_(std::move(mask)) {}

    const Mask& mask() const { return mask_; }

    void begin();
    void end();
    // Both give the region that may have changed. A brush of this radius, drawn from one place to another.
    Region draw(const Corner& from, const Corner& to, double radius_px, MaskEdit edit);
    Region combine(const Mask& area, MaskEdit edit);

    bool can_undo() const { return done_ > 0; }
    bool can_redo() const { return done_ < actions_.size(); }
    int actions() const { return static_cast<int>(done_); }
    Region undo();
    Region redo();

private:
    static constexpr int kTile = 64;  // [pixels] of a side
    using Values = std::vector<float>;
    using Tiles = std::map<std::pair<int, int>, Values>;
    struct Action {
        Tiles before, after;
    };

    Region tile_region(const std::pair<int, int>& at) const;
    Values values(const std::pair<int, int>& at) const;
    void remember(const Region& region);
    Region put(const Tiles& tiles);

    Mask mask_;
    std::deque<Action> actions_;
    std::size_t done_ = 0;  // actions_[0 .. done_) are in the mask
    bool open_ = false;
};

// What a wand goes by: the colour (CIE Delta E 1976 of rho_d), the height (its unit is the surface's), the
// gloss (|ln alpha| and half |ln rho_s|).
enum class WandBy { colour, height, gloss };

// Pixels connected to (x, y) that differ from it by at most `tolerance`. Throws Error where the pixel is not
// in the picture.
Mask wand(const Surface& surface, int x, int y, WandBy by, double tolerance);

}  // namespace tangi
