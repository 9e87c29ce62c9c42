#include "paint/exchange/transfer.h"

#include <algorithm>

#include "paint/exchange/exchange_rows.h"
#include "paint/exchange/flow_rows.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kRowsAtOnce = 32;  // by one thread
constexpr int kBandRows = 32;    // about as many
constexpr int kRing = 2;         // [pixels] that give no paint
constexpr int kFlowsFrom = 3;    // [rows] beside a band, on whose paint what flows into it depends

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

// What is the same for all bands of a box.
struct Step {
    const StepBox& box;
    const TransferRates& rates;
    const BrushMotion& motion;
    bool exchanges;
    const StepScratch& spans;
    float* top;
};

// Rows of a box that one thread moves, from top to bottom: bristles and canvas exchange, and a few rows
// further up what is left flows, so that paint is fetched once from where memory is slow. What becomes of a
// row is put back when the next one is done, which looks at it as it was. Bands are independent: the rows at
// their edges come first, and what a band needs of those beside it is kept before any goes on.
class Band {
public:
    Band(const Step& step, int begin, int end, float* memory)
        : step_(step),
          box_(step.box),
          begin_(begin),
          end_(end),
          heading_{step.motion.dx < 0 ? -1 : 1, step.motion.dy < 0 ? -1 : 1},
          line_(line_of(box_)),
          memory_(memory),
          kept_(box_.paint.size()) {
        float* first = memory + line_ * (kFlows * kPlanes + kExchanged) + kBesideFlows;
        for (std::size_t i = 0; i < kept_.size(); ++i) kept_[i] = first + line_ * kRows * i;
    }

    // Floats of memory.
    static std::size_t line_of(const StepBox& box) {
        return static_cast<std::size_t>(box.width + 2 * kBesideFlows);
    }
    static std::size_t floats(const StepBox& box) {
        return line_of(box) * (kFlows * kPlanes + kExchanged + kRows * box.paint.size());
    }

    // Rows on which other bands depend too.
    void exchange_edges() {
        middle_ = std::min(begin_ + kFlowsFrom, end_);
        middle_end_ = std::max(end_ - kFlowsFrom, middle_);
        for (int y = begin_; y < middle_; ++y) exchange_row(y);
        for (int y = middle_end_; y < end_; ++y) exchange_row(y);
    }

    // Keeps what other bands may change before it is needed here.
    void prepare() {
        for (const int y : {begin_ - 1, begin_, end_ - 1, end_}) find_flow(y);
        for (std::size_t i = 0; i < box_.paint.size(); ++i) {
            // A row beside these is looked at one pixel beyond its ends, where nothing flows.
            for (const int which : {kAbove, kBelow}) kept(which)[i][-1] = kept(which)[i][box_.width] = 0;
            std::copy_n(row(std::max(begin_ - 1, 0))[i], box_.width, kept(kAbove)[i]);
            std::copy_n(row(std::min(end_, box_.height - 1))[i], box_.width, kept(kBelow)[i]);
        }
    }

    void run() {
        for (int y = begin_; y < end_; ++y) {
            if (y + 1 < end_ - 1) {
                exchange_until(y + 1 + kFlowsFrom);
                find_flow(y + 1);
            }
            move_row(y, {flow(y - 1), flow(y), flow(y + 1)});
        }
        move_row(end_, {});
    }

private:
    static constexpr std::size_t kExchanged = 2;           // lines for exchange_in_row()
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

    // And the height of what lies there.
    void exchange_row(int y) const {
        if (step_.exchanges) exchange_in_row(box_, step_.rates, y, memory_ + line_ * kFlows * kPlanes);
        const std::size_t canvas = at(y, box_.canvas_stride);
        add_row(box_.width, box_.relief_mm + canvas, box_.total_mm + canvas,
                step_.top + at(y, static_cast<std::size_t>(box_.width)));
    }
    void exchange_until(int end) {
        for (; middle_ < std::min(end, middle_end_); ++middle_) exchange_row(middle_);
    }

    void find_flow(int y) const {
        // Where nothing flows but neighbours look, flows are 0.
        const RowSpan looked_at = step_.spans.looked_at[static_cast<std::size_t>(y + 1)];
        if (empty(looked_at)) return;
        const bool inside = y >= 0 && y < box_.height;
        RowSpan span = inside ? step_.spans.flowing[static_cast<std::size_t>(y)] : RowSpan{0, 0};
        if (empty(span)) span = {looked_at.begin, looked_at.begin};
        const Outflow out = flow(y);
        if (!empty(span)) {
            const RowSpan whole = widened(span, {kRing, box_.width - kRing});
            const auto first = static_cast<std::size_t>(whole.begin);
            const std::size_t canvas = at(y, box_.canvas_stride) + first,
                              top_stride = static_cast<std::size_t>(box_.width);
            const RowMotion motion{
                heading_.sx, heading_.sy,
                step_.motion.dx - step_.motion.turn_rad * (static_cast<float>(y) - step_.motion.y),
                step_.motion.dy + step_.motion.turn_rad * (static_cast<float>(whole.begin) - step_.motion.x),
                step_.motion.turn_rad};
            outflow_row(whole.end - whole.begin, step_.rates, motion, box_.sides.row_from(whole.begin, y),
                        box_.underside_mm + at(y, box_.underside_stride) + first, box_.underside_stride,
                        step_.top + at(y, top_stride) + first, top_stride, box_.total_mm + canvas,
                        box_.open + canvas, box_.canvas_stride, from(out, first));
        }
        clear_beside(span, looked_at, out);
    }

    static Outflow from(const Outflow& flow, std::size_t x) {
        return {flow.left + x, flow.right + x, flow.up + x, flow.down + x, flow.ahead + x};
    }

    // And puts back what became of the row above.
    void move_row(int y, const FlowsAround& flows) {
        const RowSpan span = y < end_ ? step_.spans.touched[static_cast<std::size_t>(y)] : RowSpan{0, 0},
                      done =
                          y > begin_ ? step_.spans.touched[static_cast<std::size_t>(y - 1)] : RowSpan{0, 0};
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

    const Step& step_;
    const StepBox& box_;
    int begin_, end_, middle_ = 0, middle_end_ = 0;  // those from middle_ to middle_end_ have yet to exchange
    Heading heading_;
    std::size_t line_;
    float* memory_;
    std::vector<float*> kept_;  // of each ingredient
};

void move(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, bool exchanges,
          StepScratch& scratch) {
    find_spans(box, scratch);
    scratch.top.resize(static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height));
    // Rows of narrow boxes are looked at one pixel beyond their ends, which may be another band's.
    const bool one = box.width * box.height < kParallelPixels || box.width <= kLeastAdvected;
    // As many for each thread; what comes out is the same however many there are.
    const int threads = thread_count(), each = box.height / (kBandRows * threads);
    const int bands = one ? 1 : each > 0 ? each * threads : std::max(box.height / kBandRows, 1);
    const std::size_t floats = Band::floats(box);
    scratch.planes.resize(std::max(scratch.planes.size(), floats * static_cast<std::size_t>(bands)));
    const Step step{box, rates, motion, exchanges, scratch, scratch.top.data()};
    std::vector<Band> all;
    all.reserve(static_cast<std::size_t>(bands));
    for (int i = 0; i < bands; ++i)
        all.emplace_back(step, box.height * i / bands, box.height * (i + 1) / bands,
                         scratch.planes.data() + floats * static_cast<std::size_t>(i));
    const auto for_bands = [&](void (Band::*part)()) {
        if (bands == 1) return (all.front().*part)();
        parallel_for(0, bands, 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) (all[static_cast<std::size_t>(i)].*part)();
        });
    };
    for_bands(&Band::exchange_edges);
    for_bands(&Band::prepare);
    for_bands(&Band::run);
}

}  // namespace

void for_rows_in_parallel(int height, const std::function<void(int, int)>& body) {
    parallel_for(0, height, kRowsAtOnce, body);
}

void push(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, StepScratch& scratch) {
    if (box.width > 2 * kRing && box.height > 2 * kRing) move(box, rates, motion, false, scratch);
}

void exchange_and_push(const StepBox& box, const TransferRates& rates, const BrushMotion& motion,
                       StepScratch& scratch) {
    if (box.width > 2 * kRing && box.height > 2 * kRing)
        move(box, rates, motion, true, scratch);
    else
        exchange(box, rates, scratch);
}

}  // namespace tangi
