#include "paint/stroke/brush_steps.h"

#include <algorithm>
#include <cmath>

#include "paint/exchange/blade_face.h"
#include "paint/stroke/load_rows.h"
#include "paint/stroke/step_rates.h"
#include "surface/base/noise.h"

namespace tangi {

namespace {

constexpr std::uint64_t kShifts = 29;  // of box_of(): any seed

// [mm] Where the contact is beside its loads, by a part of a pixel that is another one in each step, bristles
// at its rim come down now and then with all that they could not leave before; beside what the others leave
// when they run dry, that is a rung, or a tick at the edge. So the contact goes with the loads where these
// are no more than kLittle_mm in the mean, kAside of the way to the side, which blurs the prints of bristles;
// and its own way where they are more than kMuch_mm, from which thick paint is smoother.
constexpr double kLittle_mm = 0.9, kMuch_mm = 1.5, kAside = 0.7;

// Paint climbs the face of a blade where it stands this high [mm] above its edge, as fast as it is heaped up
// there [1, of a step].
constexpr float kFace_mm = 2, kClimbs = 0.2f;

bool touches(const Region& box, const Canvas& canvas) {
    const Region all = canvas.region();
    return box.x0 < all.x1 && box.x1 > all.x0 && box.y0 < all.y1 && box.y1 > all.y0;
}

// The step with its contact as far with the loads as it goes with them.
Dab with_loads(const Brush& brush, Dab dab, const Region& box) {
    double x, y;
    brush.contact_centre(dab, x, y);
    const double off_x = (box.x0 + box.x1 - 1) / 2.0 - x, off_y = (box.y0 + box.y1 - 1) / 2.0 - y;
    const double part = std::clamp((kMuch_mm - brush.mean_load_mm()) / (kMuch_mm - kLittle_mm), 0.0, 1.0);
    const double along = part * (off_x * dab.dx + off_y * dab.dy),
                 aside = part * kAside * (off_y * dab.dx - off_x * dab.dy);
    dab.x += along * dab.dx - aside * dab.dy;
    dab.y += along * dab.dy + aside * dab.dx;
    return dab;
}

// The steps of a brush in one window.
class WindowSteps {
public:
    WindowSteps(PaintWindow& window, Brush& brush, double mm_per_pixel, std::uint64_t seed, DabMemory& memory)
        : window_(window),
          brush_(brush),
          mm_per_pixel_(mm_per_pixel),
          seed_(seed),
          memory_(memory),
          step_(memory.box) {}

    // Gives the pixels under the brush.
    double take(const Dab& wanted, const Region& box) {
        brush_.turn_to(wanted.rotation_rad);
        brush_.weigh(wanted.step);
        const Dab dab = with_loads(brush_, wanted, box);
        find_underside(dab, box);
        window_.attach(step_, box.x0, box.y0);
        attach_loads(box);
        const TransferRates rates = rates_of(brush_, dab, mm_per_pixel_);
        const BrushMotion motion = motion_of(dab, box);
        step_.sides = brush_.sides(dab, box.x0, box.y0);
        find_lanes(dab);
        if (traits_of(brush_.settings().shape).blade) lift_onto_face(step_, kFace_mm, kClimbs);
        exchange_and_push(step_, rates, motion, memory_.step);
        if (dab.stands && rates.squeeze_per_mm > 0) {
            find_outwards(brush_.standing(dab, box.x0, box.y0), step_, memory_.outwards);
            squeeze_out(step_, memory_.outwards, rates.squeeze_per_mm, rates.film_mm, memory_.step);
        }
        double pixels = 0;
        for (const RowSpan& span : step_.bristles) pixels += span.end - span.begin;
        return pixels;
    }

private:
    void find_underside(const Dab& dab, const Region& box) {
        std::vector<float>& underside = memory_.underside;
        const std::size_t area =
            static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
        underside.resize(2 * area);
        brush_.underside_mm(dab, box, underside.data(), underside.data() + area, step_.bristles);
        step_.width = box.width();
        step_.height = box.height();
        step_.underside_mm = underside.data();
        step_.cover = underside.data() + area;
        step_.underside_stride = static_cast<std::size_t>(box.width());
    }

    void attach_loads(const Region& box) {
        step_.load_stride = static_cast<std::size_t>(brush_.grid_size());
        const std::size_t corner =
            static_cast<std::size_t>(brush_.grid_half() - box.height() / 2) * step_.load_stride +
            static_cast<std::size_t>(brush_.grid_half() - box.width() / 2);
        for (const IngredientId id : window_.ingredients()) brush_.load_plane(id);
        step_.load.clear();
        for (const IngredientId id : window_.ingredients())
            step_.load.push_back(brush_.load_plane(id) + corner);
        step_.load_total_mm = brush_.load_total() + corner;
    }

    BrushMotion motion_of(const Dab& dab, const Region& box) const {
        double x, y;
        brush_.contact_centre(dab, x, y);
        const float way = dab.stands ? 0 : dab.length_px;
        return {dab.dx * way, dab.dy * way, dab.turn_rad, static_cast<float>(x - box.x0),
                static_cast<float>(y - box.y0)};
    }

    // Bristles side by side, which give and press differently.
    void find_lanes(const Dab& dab) {
        step_.lanes = {};
        if (!dab.stands) {
            const auto grain = static_cast<float>(brush_.settings().grain);
            step_.lanes = lanes_at(dab.way_px, std::max(step_.sides.left_px, step_.sides.right_px),
                                   static_cast<float>(brush_.settings().bristle_mm / mm_per_pixel_), grain,
                                   seed_, memory_.lanes);
            const float way_mm = dab.way_px * static_cast<float>(mm_per_pixel_);
            step_.sides.left_bears = side_bears(way_mm, grain, seed_, -1);
            step_.sides.right_bears = side_bears(way_mm, grain, seed_, 1);
        } else if (dab.side != 0) {
            step_.lanes = ramp_of(dab.side, step_.sides.right_px, memory_.lanes);
        }
    }

    PaintWindow& window_;
    Brush& brush_;
    const double mm_per_pixel_;
    const std::uint64_t seed_;
    DabMemory& memory_;
    StepBox& step_;
};

}  // namespace

Region box_of(const Brush& brush, const Dab& dab) {
    double cx, cy;
    int half_x, half_y;
    brush.contact_centre(dab, cx, cy);
    brush.reach_px(dab, half_x, half_y);
    // Nearest to the way, loads would go along a slanting stroke in stairs, whose print is a sawtooth; to
    // either side of it, spread evenly over any eight steps and by chance within them, in great leaps (3 or 5
    // eighths), they go straight in the mean.
    const std::uint64_t chance = procedural::hash(kShifts, dab.step / 8);
    const std::uint64_t turn =
        (static_cast<std::uint64_t>(dab.step) * (2 * (chance & 1) + 3) + (chance >> 2)) & 7;
    const double shift =
        (static_cast<double>(turn) + procedural::uniform(procedural::hash(chance, dab.step))) / 8 - 0.5;
    const bool moves = dab.dx != 0 || dab.dy != 0;
    const LoadPixel at = pixel_of_row(cx, cy, dab.dx, dab.dy, moves ? shift : 0, moves && !dab.stands);
    return {at.x - half_x, at.y - half_y, at.x + half_x + 1, at.y + half_y + 1};
}

double paint_dabs(Canvas& canvas, Brush& brush, std::span<const Dab> dabs, std::uint64_t seed,
                  UpperFilm& other, DabMemory& memory) {
    double pixels = 0;
    // Windows as large as some steps take; dividing the steps otherwise would not change the result.
    for (std::size_t begin = 0; begin < dabs.size();) {
        // Beside the canvas a brush is in the air, and keeps its paint.
        if (!touches(box_of(brush, dabs[begin]), canvas)) {
            ++begin;
            continue;
        }
        Region window_region{};
        std::size_t end = begin;
        for (; end < dabs.size() && end < begin + 64; ++end) {
            const Region box = box_of(brush, dabs[end]), all = united(window_region, box);
            if (end > begin && (all.width() > box.width() + 96 || all.height() > box.height() + 96)) break;
            window_region = all;
        }
        std::vector<bool> above;
        for (std::size_t i = begin; i < end; ++i)
            above.push_back(other.met(canvas.wet(), brush, dabs[i], box_of(brush, dabs[i])));
        const int ride = std::max(static_cast<int>(brush.settings().size_mm / canvas.mm_per_pixel() / 4), 2);
        PaintWindow window(canvas, window_region, brush.ingredients(), ride, above.back(), memory.window);
        WindowSteps steps(window, brush, canvas.mm_per_pixel(), seed, memory);
        for (std::size_t i = begin; i < end; ++i) {
            const Region box = box_of(brush, dabs[i]);
            if (!touches(box, canvas)) continue;
            memory.box.laid_above = above[i - begin];
            pixels += steps.take(dabs[i], box);
        }
        window.store(canvas);
        begin = end;
    }
    return pixels;
}

}  // namespace tangi
