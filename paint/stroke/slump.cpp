#include "paint/stroke/slump.h"

#include <algorithm>
#include <cmath>

#include "paint/stroke/paint_window.h"

namespace tangi {

namespace {

constexpr float kFlowed = 1.4f;  // [1] of the step that paint holds: enough has flowed

// Steps that paint flows before one looks whether that is enough, how often one looks at most, and [pixels]
// how far from a wall paint may flow.
constexpr int kSteps = 8, kViewModes = 8, kAround = 16;

// The highest step between neighbours of a row, and to those of the next one.
float highest_step(int n, const float* row, const float* next) {
    float highest = 0;
    for (int x = 0; x < n; ++x)
        highest = std::max(highest, std::max(std::abs(row[x] - row[x + 1]), std::abs(row[x] - next[x])));
    return highest;
}

Region widened(const Region& part, int by, const Region& within) {
    return intersection({part.x0 - by, part.y0 - by, part.x1 + by, part.y1 + by}, within);
}

bool overlap(const Region& a, const Region& b) { return !intersection(a, b).empty(); }

// The smallest region with all pixels of `part` that stand higher above a neighbour than step_mm, by their
// paint and by all that lies there.
Region wall_in(const Canvas& canvas, const Region& part, float step_mm) {
    const Region seen = widened(part, 1, canvas.region());
    const auto stride = static_cast<std::size_t>(seen.width());
    std::vector<float> paint(stride * static_cast<std::size_t>(seen.height()), 0.0f);
    canvas.wet().add_thickness_mm(seen, paint.data(), stride);
    float highest = 0;
    for (int y = 0; y + 1 < seen.height(); ++y) {
        const float* row = paint.data() + static_cast<std::size_t>(y) * stride;
        highest = std::max(highest, highest_step(seen.width() - 1, row, row + stride));
    }
    if (!(highest > step_mm)) return {};
    std::vector<float> top = paint;
    canvas.relief_mm(seen, top.data(), stride);
    Region wall{};
    const auto look = [&](int x, int y, std::size_t a, std::size_t b) {
        const float of_paint = paint[a] - paint[b], of_all = top[a] - top[b];
        if (std::min(of_paint, of_all) > step_mm || std::max(of_paint, of_all) < -step_mm)
            wall = united(wall, {seen.x0 + x, seen.y0 + y, seen.x0 + x + 1, seen.y0 + y + 1});
    };
    for (int y = 0; y < seen.height(); ++y)
        for (int x = 0; x < seen.width(); ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
            if (x + 1 < seen.width()) look(x, y, at, at + 1);
            if (y + 1 < seen.height()) look(x, y, at, at + stride);
        }
    return wall;
}

}  // namespace

std::vector<Region> walls_in(const Canvas& canvas, std::span<const Region> parts, float step_mm) {
    std::vector<Region> walls;
    for (const Region& part : parts) {
        Region wall = wall_in(canvas, part, step_mm);
        if (wall.empty()) continue;
        wall = widened(wall, kAround, canvas.region());
        // One that grows may come to overlap others.
        for (auto other = walls.begin(); other != walls.end();) {
            if (!overlap(*other, wall)) {
                ++other;
                continue;
            }
            wall = united(wall, *other);
            walls.erase(other);
            other = walls.begin();
        }
        walls.push_back(wall);
    }
    return walls;
}

void slump(Canvas& canvas, const Region& region, const TransferRates& rates, DabMemory& memory) {
    TransferRates flows;
    flows.yield_mm = rates.yield_mm;
    flows.flow = rates.flow;
    flows.stay_mm = rates.still_mm;  // films do not run off the crests of a weave
    PaintWindow window(canvas, region, {}, 2, false, memory.window);
    StepBox step;
    step.width = region.width();
    step.height = region.height();
    step.bristles.assign(static_cast<std::size_t>(step.height), RowSpan{0, step.width});
    memory.underside.assign(static_cast<std::size_t>(step.width) * static_cast<std::size_t>(step.height),
                            kOutside);
    step.underside_mm = memory.underside.data();
    step.underside_stride = static_cast<std::size_t>(step.width);
    window.attach(step, region.x0, region.y0);
    for (int look = 0; look < kViewModes; ++look) {
        for (int i = 0; i < kSteps; ++i) push(step, flows, {}, memory.step);
        window.store(canvas);
        if (wall_in(canvas, region, kFlowed * rates.yield_mm).empty()) break;
    }
}

}  // namespace tangi
