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

// Pixels under the brush.
double one_step(PaintWindow& window, Brush& brush, const Dab& wanted, const Region& box, double mm_per_pixel,
                std::uint64_t seed, DabMemory& memory) {
    std::vector<float>& underside = memory.underside;
    StepBox& step = memory.box;
    brush.turn_to(wanted.rotation_rad);
    brush.weigh(wanted.step);
    const Dab dab = with_loads(brush, wanted, box);
    const int width = box.width(), height = box.height();
    const std::size_t area = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    underside.resize(2 * area);
    brush.underside_mm(dab, box.x0, box.y0, width, height, underside.data(), underside.data() + area,
                       step.bristles);
    step.width = width;
    step.height = height;
    step.underside_mm = underside.data();
    step.cover = underside.data() + area;
    step.underside_stride = static_cast<std::size_t>(width);
    window.attach(step, box.x0, box.y0);
    step.load_stride = static_cast<std::size_t>(brush.grid_size());
    const std::size_t corner = static_cast<std::size_t>(brush.grid_half() - height / 2) * step.load_stride +
                               static_cast<std::size_t>(brush.grid_half() - width / 2);
    for (const IngredientId id : window.ingredients()) brush.load_plane(id);
    step.load.clear();
    for (const IngredientId id : window.ingredients()) step.load.push_back(brush.load_plane(id) + corner);
    step.load_total_mm = brush.load_total() + corner;

    const TransferRates rates = rates_of(brush, dab, mm_per_pixel);
    double x, y;
    brush.contact_centre(dab, x, y);
    const float way = dab.stands ? 0 : dab.length_px;
    const BrushMotion motion{dab.dx * way, dab.dy * way, dab.turn_rad, static_cast<float>(x - box.x0),
                             static_cast<float>(y - box.y0)};
    step.sides = brush.sides(dab, box.x0, box.y0);
    step.lanes = {};
    const auto grain = static_cast<float>(brush.settings().grain);
    if (!dab.stands) {
        step.lanes = lanes_at(dab.way_px, std::max(step.sides.left_px, step.sides.right_px),
                              static_cast<float>(brush.settings().bristle_mm / mm_per_pixel), grain, seed,
                              memory.lanes);
        const float way_mm = dab.way_px * static_cast<float>(mm_per_pixel);
        step.sides.left_bears = side_bears(way_mm, grain, seed, -1);
        step.sides.right_bears = side_bears(way_mm, grain, seed, 1);
    } else if (dab.side != 0)
        step.lanes = ramp_of(dab.side, step.sides.right_px, memory.lanes);
    if (brush.settings().shape == "knife") lift_onto_face(step, kFace_mm, kClimbs);
    exchange_and_push(step, rates, motion, memory.step);
    if (dab.stands && rates.squeeze_per_mm > 0) {
        find_outwards(brush.standing(dab, box.x0, box.y0), step, memory.outwards);
        squeeze_out(step, memory.outwards, rates.squeeze_per_mm, rates.film_mm, memory.step);
    }
    double pixels = 0;
    for (const RowSpan& span : step.bristles) pixels += span.end - span.begin;
    return pixels;
}

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
        for (std::size_t i = begin; i < end; ++i) {
            const Region box = box_of(brush, dabs[i]);
            if (!touches(box, canvas)) continue;
            memory.box.laid_above = above[i - begin];
            pixels += one_step(window, brush, dabs[i], box, canvas.mm_per_pixel(), seed, memory);
        }
        window.store(canvas);
        begin = end;
    }
    return pixels;
}

}  // namespace tangi
