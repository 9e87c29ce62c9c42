// brush.h: a brush in the hand: its bristles, the paint on each of them, and where they are while it is
// moved.
//
// Loads belong to cells that turn with the brush; steps of a stroke see them on a grid of the canvas's pixels
// that moves with it (bristle_loads.h), so turning neither blurs the paint nor loses any.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "paint/brush/bristle_loads.h"
#include "paint/brush/brush_settings.h"
#include "paint/brush/brush_tip.h"
#include "paint/canvas/canvas.h"
#include "paint/exchange/bristle_rows.h"
#include "paint/exchange/squeeze_out.h"
#include "paint/exchange/tip_footprint.h"
#include "paint/exchange/transfer.h"

namespace tangi {

// One place of the brush on its way, in pixels of the canvas (y down).
struct Dab {
    double x = 0, y = 0;     // [pixels] of the handle's axis; pixel centres are whole numbers
    float pressure = 0.5f;   // [1] 0..1
    float rotation_rad = 0;  // of the brush's width against the x axis, towards y (clockwise as seen)
    float tilt_x = 0,
          tilt_y = 0;      // [1] sine of the handle's tilt from the normal, towards x and y; length < 1
    float dx = 1, dy = 0;  // unit vector of the motion; 0, 0 where it stands
    float length_px = 1;   // of the way since the step before
    float turn_rad = 0;    // of the rotation since then
    int step = 0;          // number in the stroke
    float way_px = 0;      // [pixels] since the stroke began
    // It is pressed down and does not move on; dx, dy say how the tip trails behind. [1] How much of what
    // pressure drives out from under it leaves in this step, and whether ahead or behind of it (+-1); 0: all
    // around.
    bool stands = false;
    float pressed = 0, side = 0;
};

// What is on a brush, bit for bit: rows of grid_size() cells.
struct BrushLoad {
    float rotation_rad = 0;                 // of the brush as the cells lie; 0 as bristles() gives them
    std::vector<IngredientId> ingredients;  // ascending
    std::vector<std::vector<float>> mm;     // of each
    std::vector<float> total_mm;
};

class Brush {
public:
    Brush(const BrushSettings& settings, double mm_per_pixel, std::uint64_t seed);

    const BrushSettings& settings() const { return settings_; }
    std::uint64_t seed() const { return seed_; }

    // Puts paint of this recipe on the bristles; `amount` 1 is a full load. With `keep`, what is on them
    // stays and is filled up. Throws Error where the parts of the recipe do not sum to more than 0.
    void load(const std::vector<Portion>& recipe, double amount, bool keep = false);
    void clean();
    // Takes over all that is on another brush, evenly, however much that is, and whether or not it is loaded
    // itself: for a brush that was not cleaned between strokes.
    void take_over(const Brush& other);
    // For a brush that goes to another canvas, where its paints have other numbers: number[i] is the one
    // there of the paint that is i here.
    void renumber(const std::vector<IngredientId>& number);

    // To keep and to put back what is on the bristles between strokes. Cells that lie turned go to the
    // nearest ones. Throws ContractError where it is not of this brush.
    BrushLoad bristles() const;
    void put_back(const BrushLoad& load);

    // Volume [mm^3] on the bristles, for each of `ingredients`; and of a full load, which load() of 1 gives.
    std::vector<double> volumes_mm3(std::size_t ingredients) const;
    double full_mm3() const;
    const std::vector<IngredientId>& ingredients() const { return loads_.ingredients(); }

    // Where the middle of the contact is for this dab: the tip trails behind the handle.
    void contact_centre(const Dab& dab, double& x, double& y) const;
    // Half extents [pixels] of the box that a dab can change, along x and y, with a margin for pushed paint.
    void reach_px(const Dab& dab, int& half_x, int& half_y) const;
    // Length [pixels] of the contact along the motion: that of the brush, and that of the bristles that stand
    // for it here, which is longer where the brush is too small to be resolved.
    double contact_length_px(const Dab& dab) const;
    double resolved_length_px(const Dab& dab) const;
    // [mm] Mean of underside_mm() where the dome is flattened and the tip is level, under paint enough.
    float ride_mm(float pressure) const;
    // [pixels] From the middle to the bristle that is farthest from it, at rest.
    double rim_px() const { return std::max(half_width_px_, half_thickness_px_); }
    // [1] The brush's area over that of the bristles that stand for it: 1, and less where it is too small.
    // They carry its volume, so their load is thinner by it.
    double coverage() const { return coverage_; }

    // Where its sides are, in a box of pixels whose first is (x0, y0). Where it stands there are none: ahead
    // is then to the right.
    BrushSides sides(const Dab& dab, int x0, int y0) const;

    // The tip of a dab that stands, in a box of pixels whose first is (x0, y0).
    StandingTip standing(const Dab& dab, int x0, int y0) const;

    // Turns the loads with the brush, in small steps.
    void turn_to(float rotation_rad);
    // Looks at how much is on the bristles, once in a while; before each step.
    void weigh(int step);
    // [mm] Volume on the brush over the area of the rectangle around its tip, by the last weigh().
    double mean_load_mm() const { return mean_load_mm_; }
    // Where a stroke ends: what comes next depends on what is on the bristles only.
    void rest();

    // Of the bristles, around contact_centre(), a pixel wider than they are.
    TipOutline outline(const Dab& dab) const;

    // [mm] The underside at a pixel if there were no paint, all bristles were as long and the tip level;
    // kOutside where there are none.
    float lowest_mm(const Dab& dab, int x, int y) const;

    // The underside [mm] of the bristles over a box of pixels, row-major; kOutside where there are none; and
    // the part of each pixel that they cover, 0..1, in rows as long. Row y of the box has bristles at columns
    // spans[y].begin <= x < spans[y].end of it at most.
    void underside_mm(const Dab& dab, const Region& box, float* out, float* cover,
                      std::vector<RowSpan>& spans) const;

    // The load of an ingredient; made where there is none. The grid has grid_size() columns and rows, its
    // middle cell belongs to the pixel nearest to the contact's centre.
    float* load_plane(IngredientId ingredient) { return loads_.view(ingredient); }
    float* load_total() { return loads_.view_total(); }
    int grid_size() const { return 2 * half_ + 1; }
    int grid_half() const { return half_; }

private:
    static constexpr int kMargin = 4;  // [pixels] around the contact for paint that is pushed out of it

    // Of a row that begins at contact_centre(), but for the lift.
    UndersideRow underside_of(const Dab& dab, float gap_mm, float groove_mm) const;
    double fresh_load(int u, int v, double middle_mm) const;  // [mm] of a cell
    // load(), where a full load has `middle_mm` in the middle.
    void fill(const std::vector<Portion>& recipe, double amount, double middle_mm, bool keep);
    float gap_mm(float pressure) const;
    void forget();  // what weigh() found
    static std::vector<float> total_of(const std::vector<std::vector<float>>& cells);

    BrushSettings settings_;
    double mm_per_pixel_;
    std::uint64_t seed_;
    double width_px_, thickness_px_;            // of the brush
    double half_width_px_, half_thickness_px_;  // of what stands for it: kLeastHalf_px at least
    double coverage_ = 1;
    float bead_mm_ = kOutside;  // under a blade: the least mean load since it rested, by weigh()
    double mean_load_mm_ = -1;  // < 0: not known
    int disc_ = 0, half_ = 0;   // radius [pixels] of what turns, and half the grid
    BrushTip tip_;
    BristleLoads loads_;
};

}  // namespace tangi
