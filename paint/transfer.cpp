#include "paint/transfer.h"

#include <algorithm>

#include "paint/flow_rows.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kBandRows = 32;
constexpr int kRing = 2;  // [pixels] that give no paint

std::size_t at(int y, std::size_t stride) { return static_cast<std::size_t>(y) * stride; }

constexpr RowSpan kNothing{1 << 28, -(1 << 28)};  // least and greatest of no columns

bool empty(const RowSpan& span) { return span.end <= span.begin; }

// What the spans of a row and of those beside it cover, and one column more on either side.
RowSpan around(const RowSpan& above, const RowSpan& here, const RowSpan& below) {
    return {std::min(std::min(above.begin, below.begin), here.begin) - 1,
            std::max(std::max(above.end, below.end), here.end) + 1};
}

// around() for all rows, beyond the first and the last of which there is nothing.
void widen(std::vector<RowSpan>& spans) {
    RowSpan above = kNothing;
    for (std::size_t y = 0; y < spans.size(); ++y) {
        const RowSpan here = spans[y], below = y + 1 < spans.size() ? spans[y + 1] : kNothing;
        spans[y] = around(above, here, below);
        above = here;
    }
}

// Where paint may flow, beside the bristles of the rows around and within the ring; the rows and columns that
// change; and where flows are looked at, from the row above the box to that below.
void find_spans(const StepBox& box, StepScratch& scratch) {
    std::vector<RowSpan>&flowing = scratch.flowing, &touched = scratch.touched, &seen = scratch.looked_at;
    flowing = box.bristles;
    for (RowSpan& span : flowing)
        if (empty(span)) span = kNothing;
    for (int i = 0; i < kFlowMargin; ++i) widen(flowing);
    for (int y = 0; y < box.height; ++y) {
        RowSpan& span = flowing[static_cast<std::size_t>(y)];
        const bool inside = y >= kRing && y < box.height - kRing && !empty(span);
        span =
            inside ? RowSpan{std::max(span.begin, kRing), std::min(span.end, box.width - kRing)} : kNothing;
    }
    touched = flowing;
    widen(touched);
    for (RowSpan& span : touched)
        if (!empty(span) && span.end - span.begin < kLeastAdvected)  // one vector at least
            span = {std::max(std::min(span.begin, box.width - kLeastAdvected), 0),
                    std::min(std::max(span.end, std::max(span.begin, 0) + kLeastAdvected), box.width)};
    seen.assign(touched.size() + 2, kNothing);
    std::copy(touched.begin(), touched.end(), seen.begin() + 1);
    widen(seen);
}

// Rows of a box that one thread moves, from top to bottom: flows of three rows at a time, which stay in the
// nearest cache. What becomes of a row is put back when the next one is done, which looks at it as it was.
// Bands are independent: what a band needs of the rows beside it is kept before any begins.
class Band {
public:
    Band(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, const StepScratch& spans,
         float* memory)
        : box_(box),
          rates_(rates),
          motion_(motion),
          heading_{motion.dx < 0 ? -1 : 1, motion.dy < 0 ? -1 : 1},
          spans_(spans),
          line_(line_of(box)),
          memory_(memory),
          kept_(box.paint.size()) {
        float* first = memory + line_ * kFlows * kPlanes + kBesideFlows;
        for (std::size_t i = 0; i < kept_.size(); ++i) kept_[i] = first + line_ * kRows * i;
    }

    // Floats of memory.
    static std::size_t line_of(const StepBox& box) {
        return static_cast<std::size_t>(box.width + 2 * kBesideFlows);
    }
    static std::size_t floats(const StepBox& box) {
        return line_of(box) * (kFlows * kPlanes + kRows * box.paint.size());
    }

    // Keeps what other bands may change before it is needed here.
    void prepare(int begin, int end) {
        begin_ = begin;
        end_ = end;
        for (const int y : {begin - 1, begin, end - 1, end}) find_flow(y);
        for (std::size_t i = 0; i < box_.paint.size(); ++i) {
            // A row beside these is looked at one pixel beyond its ends, where nothing flows.
            for (const int which : {kAbove, kBelow}) kept(which)[i][-1] = kept(which)[i][box_.width] = 0;
            std::copy_n(row(std::max(begin - 1, 0))[i], box_.width, kept(kAbove)[i]);
            std::copy_n(row(std::min(end, box_.height - 1))[i], box_.width, kept(kBelow)[i]);
        }
    }

    void run() {
        for (int y = begin_; y < end_; ++y) {
            if (y + 1 < end_ - 1) find_flow(y + 1);
            move_row(y, {flow(y - 1), flow(y), flow(y + 1)});
        }
        move_row(end_, {});
    }

private:
    static constexpr std::size_t kPlanes = 5, kFlows = 5;  // three that go round, the last two of the band
    static constexpr std::size_t kRows = 4;                // of each ingredient: two that go round, and
    static constexpr int kAbove = 2, kBelow = 3;           // those beside the band

    RowOfEach row(int y) const {
        return {box_.paint.data(), static_cast<std::ptrdiff_t>(at(y, box_.canvas_stride))};
    }
    // Copies of rows. There is room beside them.
    RowOfEach kept(int which) const { return {kept_.data(), static_cast<std::ptrdiff_t>(line_) * which}; }
    Outflow flow(int y) const {
        const int which = y == end_ ? 4 : y == end_ - 1 ? 3 : (y - begin_ + 1) % 3;
        float* first = memory_ + line_ * kPlanes * static_cast<std::size_t>(which) + kBesideFlows;
        return {first, first + line_, first + 2 * line_, first + 3 * line_, first + 4 * line_};
    }

    void find_flow(int y) const {
        // Where nothing flows but neighbours look, flows are 0.
        const RowSpan looked_at = spans_.looked_at[static_cast<std::size_t>(y + 1)];
        if (empty(looked_at)) return;
        const bool inside = y >= 0 && y < box_.height;
        RowSpan span = inside ? spans_.flowing[static_cast<std::size_t>(y)] : RowSpan{0, 0};
        if (empty(span)) span = {looked_at.begin, looked_at.begin};
        const Outflow out = flow(y);
        if (!empty(span)) {
            const RowSpan whole = widened(span, {kRing, box_.width - kRing});
            const auto first = static_cast<std::size_t>(whole.begin);
            const std::size_t canvas = at(y, box_.canvas_stride) + first,
                              top_stride = static_cast<std::size_t>(box_.width);
            const RowMotion motion{
                heading_.sx, heading_.sy, motion_.dx - motion_.turn_rad * (static_cast<float>(y) - motion_.y),
                motion_.dy + motion_.turn_rad * (static_cast<float>(whole.begin) - motion_.x),
                motion_.turn_rad};
            outflow_row(whole.end - whole.begin, rates_, motion, box_.sides.row_from(whole.begin, y),
                        box_.underside_mm + at(y, box_.underside_stride) + first, box_.underside_stride,
                        spans_.top.data() + at(y, top_stride) + first, top_stride, box_.total_mm + canvas,
                        box_.open + canvas, box_.canvas_stride, from(out, first));
        }
        clear_beside(span, looked_at, out);
    }

    static Outflow from(const Outflow& flow, std::size_t x) {
        return {flow.left + x, flow.right + x, flow.up + x, flow.down + x, flow.ahead + x};
    }

    // And puts back what became of the row above.
    void move_row(int y, const FlowsAround& flows) {
        const RowSpan span = y < end_ ? spans_.touched[static_cast<std::size_t>(y)] : RowSpan{0, 0},
                      done = y > begin_ ? spans_.touched[static_cast<std::size_t>(y - 1)] : RowSpan{0, 0};
        if (empty(span) && empty(done)) return;
        const AdvectedRow rows{kept_.size(),
                               row(y),
                               y <= std::max(begin_, 1) ? kept(kAbove) : row(y - 1),
                               y + 1 >= std::min(end_, box_.height - 1) ? kept(kBelow) : row(y + 1),
                               kept(y & 1),
                               kept(~y & 1)};
        advect_row(span, done, heading_, rows, flows,
                   box_.total_mm + at(std::min(y, box_.height - 1), box_.canvas_stride));
    }

    const StepBox& box_;
    const TransferRates& rates_;
    const BrushMotion& motion_;
    Heading heading_;
    const StepScratch& spans_;
    std::size_t line_;
    float* memory_;
    int begin_ = 0, end_ = 0;
    std::vector<float*> kept_;  // of each ingredient
};

}  // namespace

void push(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, StepScratch& scratch) {
    if (box.width <= 2 * kRing || box.height <= 2 * kRing) return;
    find_spans(box, scratch);
    scratch.top.resize(static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height));
    for_rows_of_step(box.width, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            add_row(box.width, box.relief_mm + at(y, box.canvas_stride),
                    box.total_mm + at(y, box.canvas_stride),
                    scratch.top.data() + at(y, static_cast<std::size_t>(box.width)));
    });
    // Rows of narrow boxes are looked at one pixel beyond their ends, which may be another band's.
    const bool one = box.width * box.height < kParallelPixels || box.width <= kLeastAdvected;
    const int bands = one ? 1 : std::max(box.height / kBandRows, 1);
    const std::size_t floats = Band::floats(box);
    scratch.planes.resize(std::max(scratch.planes.size(), floats * static_cast<std::size_t>(bands)));
    std::vector<Band> all;
    all.reserve(static_cast<std::size_t>(bands));
    for (int i = 0; i < bands; ++i)
        all.emplace_back(box, rates, motion, scratch,
                         scratch.planes.data() + floats * static_cast<std::size_t>(i));
    const auto for_bands = [&](const auto& body) {
        if (bands == 1) return body(0);
        parallel_for(0, bands, 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) body(i);
        });
    };
    for_bands([&](int i) {
        all[static_cast<std::size_t>(i)].prepare(box.height * i / bands, box.height * (i + 1) / bands);
    });
    for_bands([&](int i) { all[static_cast<std::size_t>(i)].run(); });
}

}  // namespace tangi
