// stroke_finish.cpp: what a stroke left comes to rest.
#include <algorithm>
#include <cmath>
#include <utility>

#include "paint/canvas/quantise_volumes.h"
#include "paint/stroke/paint_window.h"
#include "paint/stroke/slump.h"
#include "paint/stroke/step_rates.h"
#include "paint/stroke/stroke.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// [1] Part of the contact's length, from its rear on, in which what runs together when the brush is lifted
// does so ever more.
constexpr double kFades = 0.7;

// What of a contact the whole brush has come over by at least this far.
std::vector<RowSpan> come_over_by(float way_px, const std::vector<RowSpan>& contact, const Dab& dab) {
    const int x = static_cast<int>(std::lround(way_px * dab.dx)),
              y = static_cast<int>(std::lround(way_px * dab.dy)), height = static_cast<int>(contact.size());
    std::vector<RowSpan> over(contact.size());
    for (int row = std::max(y, 0); row < std::min(height + y, height); ++row) {
        const RowSpan &here = contact[static_cast<std::size_t>(row)],
                      &before = contact[static_cast<std::size_t>(row - y)];
        over[static_cast<std::size_t>(row)] = {std::max(here.begin, before.begin + x),
                                               std::min(here.end, before.end + x)};
    }
    return over;
}

// What of a contact is so many pixels from its edge at least.
std::vector<RowSpan> inside_by(int margin, const std::vector<RowSpan>& contact) {
    std::vector<RowSpan> inside(contact.size());
    for (std::size_t y = 0; y < contact.size(); ++y) {
        RowSpan& span = inside[y];
        span = contact[y];
        for (int by = -margin; by <= margin; ++by) {
            const std::size_t row = y + static_cast<std::size_t>(by);  // above the first: more than there are
            const RowSpan other = row < contact.size() ? contact[row] : RowSpan{};
            span.begin = std::max(span.begin, other.begin + margin - std::abs(by));
            span.end = std::min(span.end, other.end - margin + std::abs(by));
        }
    }
    return inside;
}

}  // namespace

void Stroke::come_over(const Dab& dab) {
    const Region there = intersection(box_of(brush_, dab), canvas_.region());
    if (there.empty()) return;
    met_canvas_ = true;
    come_over(there, dab.step);
}

void Stroke::come_over(const Region& there, int step) {
    for (int y = there.y0 / kTileSize; y * kTileSize < there.y1; ++y)
        for (int x = there.x0 / kTileSize; x * kTileSize < there.x1; ++x) {
            const TileIndex at{x, y};
            UnderWay& tile = under_way_.try_emplace(at, UnderWay{canvas_.wet().tile(at)}).first->second;
            tile.part = united(tile.part, intersection(there, canvas_.wet().region_of(at)));
            tile.last_step = step;
        }
}

// Where the brush is lifted off, paint that was just sheared is thinner than paint at rest: the prints of
// single bristles run together, and it comes to rest less steep; the less the longer ago the bristles
// passed, so that it does not show where they were last.
void Stroke::relax(const Dab& last) {
    // Flow spreads with the root of the steps: enough of them for neighbouring bristles, within a frame's
    // time.
    const double bristle_px = brush_.settings().bristle_mm / canvas_.mm_per_pixel();
    const int steps = static_cast<int>(std::clamp(8 * bristle_px * bristle_px, 12.0, 64.0));
    constexpr float part_of_yield = 0.15f;
    const Region box = box_of(brush_, last);
    PaintWindow window(canvas_, box, {}, 2, false, memory_.window);
    const int width = box.width(), height = box.height();
    StepBox step;
    step.width = width;
    step.height = height;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<float>& underside = memory_.underside;
    underside.resize(2 * pixels);
    brush_.underside_mm(last, box, underside.data(), underside.data() + pixels, step.bristles);
    std::fill(underside.begin(), underside.end(), kOutside);  // the bristles are gone
    step.underside_mm = underside.data();
    step.underside_stride = static_cast<std::size_t>(width);
    window.attach(step, box.x0, box.y0);
    TransferRates rates = rates_of(brush_.settings(), canvas_.mm_per_pixel());
    rates.yield_mm *= part_of_yield;
    rates.pit_mm *= part_of_yield;
    rates.bulge_mm *= part_of_yield;
    // Films do not run off the crests of a weave: their rate falls with the cube of the thickness.
    rates.stay_mm = rates.still_mm;
    // Lips beside it were not, and would flow out to a shoulder.
    const std::vector<RowSpan> contact = inside_by(kFlowMargin, step.bristles);
    const auto fades_px = static_cast<float>(kFades * brush_.resolved_length_px(last));
    for (int i = 0; i < steps; ++i) {
        const float part = std::sqrt(static_cast<float>(i) / static_cast<float>(steps));
        step.bristles = come_over_by(part * fades_px, contact, last);
        push(step, rates, {}, memory_.step);
    }
    window.store(canvas_);
}

bool Stroke::slump_walls(float times, int step) {
    std::vector<Region> parts;
    for (const auto& [at, under_way] : under_way_) parts.push_back(under_way.part);
    const TransferRates rates = rates_of(brush_.settings(), canvas_.mm_per_pixel());
    const std::vector<Region> walls = walls_in(canvas_, parts, times * rates.yield_mm);
    for (const Region& wall : walls) {
        come_over(wall, step);
        slump(canvas_, wall, rates, memory_);
    }
    return !walls.empty();
}

void Stroke::settle_paint(int before_step) {
    std::vector<std::pair<TileIndex, UnderWay>> changed;
    for (auto at = under_way_.begin(); at != under_way_.end();) {
        if (at->second.last_step >= before_step) {
            ++at;
            continue;
        }
        if (canvas_.wet().tile(at->first) != at->second.as_it_was)
            changed.emplace_back(at->first, std::move(at->second));
        at = under_way_.erase(at);
    }
    if (changed.empty()) return;
    PaintLayer& wet = canvas_.writable_wet();
    parallel_for(0, static_cast<int>(changed.size()), 4, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto& [at, under_way] = changed[static_cast<std::size_t>(i)];
            settle(wet.writable(at), under_way.as_it_was.get());
            if (wet.tile(at)->ingredients.empty()) wet.set_tile(at, nullptr);
        }
    });
    for (const auto& [at, under_way] : changed) canvas_.mark_settled(at, under_way.part);
}

}  // namespace tangi
