// exchange.cpp: what goes each way between bristles and canvas in one step (transfer.h).
#include <algorithm>
#include <cstring>

#include "paint/canvas/paint_layer.h"
#include "paint/exchange/exchange_rows.h"
#include "paint/exchange/transfer.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

constexpr int kWidened = 8;  // [pixels] of which rows have a multiple, where there is room

constexpr float kTiny = 1e-9f;  // [mm] keeps 0 / 0 away

// Where a brush with paint lifts off, the paint in the room under it parts in the middle: half of it stays.
// So what is lower takes more, as long as paint reaches down to it, and thick paint levels the valleys. Where
// there is no room, bristles still rub a film onto the dry, twice as thick at most as they reach without
// paint, and leave nothing on paint that is thicker. [1] Deposit onto what is dry where there is no room, and
// what is added where the room is as wide as paint reaches: both together 1.4 at the most. Where bristles
// reach nothing but the paint that lies there, the film between them parts into two that are alike: the
// canvas gets no more of it than without that paint. So the second of two equal strokes always leaves less.
constexpr float kPressed = 0.66f, kFilling = 4.2f;

// Bristles ride on the paint that they bring. Those that have little of it sink until they are as high above
// the relief's mean as these parts [1] of what they bridge without paint and of what the paint adds, and by
// no more than a part of the height at which they ride. So they lay less, but not nothing; and since what
// stands out holds them up, thin paint keeps to the crests.
constexpr float kDry = 0.85f, kRide = 0.6f, kSink = 0.75f;

// Part of the load that is given, and part of the paint on the canvas that is taken.
TP_VECTOR_CLONES
void exchange_row(int n, const TransferRates& r, const BrushSides& sides, const BristleLanes& lanes,
                  const float* __restrict underside, const float* __restrict relief,
                  const float* __restrict open, const float* __restrict cover, const float* __restrict total,
                  const float* __restrict load, float* __restrict give, float* __restrict take) {
    const float pickup = r.pickup, film = r.film_mm, reach0 = r.reach_mm, reach1 = r.load_reach,
                per_hold = 1 / r.hold_mm, hold = r.hold_mm, tip = r.tip_mm, per_reach0 = 1 / r.reach_mm,
                deposit_tip = r.deposit * r.tip_mm, ride = r.ride_mm, ax = sides.ax, a0 = sides.a0,
                right_px = sides.right_px, left_px = sides.left_px,
                per_band = 1 / std::max(sides.band_px, 1.0f), press = sides.band_px > 0 ? r.press : 0.0f,
                press_left = press * sides.left_bears, press_right = press * sides.right_bears,
                most = 0.5f * r.tip_mm, first_lane_px = lanes.first_px;
    const float* __restrict lane = lanes.factor;
    const int last_lane = lanes.count - 1;
    for (int x = 0; x < n; ++x) {
        const float bridged = reach1 * std::min(load[x], tip), reach = reach0 + bridged;
        const float top = relief[x] + total[x], room = underside[x] - top;
        const float sunk =
            std::min(std::max(kDry * reach0 + kRide * bridged, underside[x] - kSink * ride), underside[x]);
        const float across_px = a0 + ax * static_cast<float>(x);
        const int on = static_cast<int>((across_px - first_lane_px) * BristleLanes::kPerPixel);
        const float here = open[x] * cover[x] * lane[std::min(std::max(on, 0), last_lane)];
        // How far [mm] bristles reach beyond what lies there, and beyond what is dry.
        const float contact = std::min(std::max(reach - (sunk - top), 0.0f), reach);
        const float dry_contact = std::min(std::max(reach - (sunk - relief[x]), 0.0f), reach);
        const float dry = std::max(1 - 0.5f * per_reach0 * total[x], 0.0f);
        const float fill = kPressed * dry * reach * reach + kFilling * bridged * (reach - contact);
        // Where pressure drives it out, the tuft gives more.
        const float beyond_px = std::max(across_px - right_px, -across_px - left_px);
        const float pressed = 1 + (across_px > 0 ? press_right : press_left) *
                                      std::min(std::max(1 + beyond_px * per_band, 0.0f), 1.0f);
        // No more than there is, however uneven the lanes are.
        give[x] = std::min(std::min(deposit_tip * pressed, most) * here * dry_contact * fill /
                               (reach * reach * reach * std::max(load[x], tip)),
                           1.0f);
        // Paint is lifted where the bristle itself dips into it: what hangs from it flows down only.
        const float dip = std::min(std::max(1 - room * per_reach0, 0.0f), 1.0f) * here;
        const float thirst = std::max(1 - per_hold * load[x], 0.0f);
        const float taken =
            std::min(pickup * thirst * dip * std::max(total[x] - film, 0.0f), std::max(hold - load[x], 0.0f));
        take[x] = taken / (total[x] + kTiny);
    }
}

// A row of each of `count` ingredients, on the canvas and on the bristles.
struct SharedRow {
    std::size_t count;
    RowOfEach paint, load;
};

// As many pixels of all ingredients as T holds, from x on: what goes either way is read once for all of them.
template <class T>
TP_INLINE void apply_some(int x, const float* give, const float* take, const SharedRow& row, float* total,
                          float* load_total) {
    T given, taken, sum{}, load_sum{};
    std::memcpy(&given, give + x, sizeof given);
    std::memcpy(&taken, take + x, sizeof taken);
    const auto [count, on_canvas, on_bristles] = row;  // a copy, which nothing that is written can change
    for (std::size_t i = 0; i < count; ++i) {
        float *at_paint = on_canvas[i] + x, *at_load = on_bristles[i] + x;
        T paint, load;
        std::memcpy(&paint, at_paint, sizeof paint);
        std::memcpy(&load, at_load, sizeof load);
        const T moved = given * load - taken * paint;
        paint += moved;
        load -= moved;
        std::memcpy(at_paint, &paint, sizeof paint);
        std::memcpy(at_load, &load, sizeof load);
        sum += paint;
        load_sum += load;
    }
    std::memcpy(total + x, &sum, sizeof sum);
    std::memcpy(load_total + x, &load_sum, sizeof load_sum);
}

template <int kLanes>
TP_INLINE void apply_all(int n, const float* give, const float* take, const SharedRow& row, float* total,
                         float* load_total) {
    int x = 0;
    for (; x + kLanes <= n; x += kLanes)
        apply_some<FloatLanes<kLanes>>(x, give, take, row, total, load_total);
    for (; kLanes > kWidened && x + kWidened <= n; x += kWidened)
        apply_some<FloatLanes<kWidened>>(x, give, take, row, total, load_total);
    for (; x < n; ++x) apply_some<float>(x, give, take, row, total, load_total);
}

TP_VECTOR_CLONES
void apply_row(int n, const float* give, const float* take, const SharedRow& row, float* total,
               float* load_total) {
    with_lanes([&](auto lanes) TP_INLINE_LAMBDA { apply_all<lanes>(n, give, take, row, total, load_total); });
}

// The same where there is an upper film: paint[2 i] is mixed, paint[2 i + 1] in the upper film.
struct FilmsRow {
    SharedRow shared;
    const float *give, *take, *underside, *relief, *open, *cover;
    float *total, *load_total;
    bool laid_above;
    float stir, swap, per_reach;  // [1], [1], [1/mm]
};

template <class T>
TP_INLINE void load(T& value, const float* from) {
    std::memcpy(&value, from, sizeof value);
}

// [mm] Of a pixel's films, all ingredients together.
template <class T>
struct FilmSums {
    T mixed{}, upper{};
};

template <class T>
TP_INLINE FilmSums<T> films_at(int x, const SharedRow& row) {
    FilmSums<T> films;
    const auto [count, paint, on_bristles] = row;  // a copy, which nothing that is written can change
    for (std::size_t i = 0; i < count; ++i) {
        T m, u;
        load(m, paint[2 * i] + x);
        load(u, paint[2 * i + 1] + x);
        films.mixed += m;
        films.upper += u;
    }
    // Rounding may leave a little less than nothing.
    const T zero{};
    films.mixed = films.mixed > zero ? films.mixed : zero;
    films.upper = films.upper > zero ? films.upper : zero;
    return films;
}

// [1] What moves between bristles and films, of each ingredient alike.
template <class T>
struct FilmMoves {
    T give;                      // of the load
    T above;                     // of what is given: into the upper film
    T upper_taken, mixed_taken;  // of the films
    T sinking;                   // of the upper film, then
    T upper_stirred, mixed_stirred;
};

template <class T>
TP_INLINE FilmMoves<T> moves_at(int x, const FilmsRow& r) {
    const T zero{}, one = zero + 1.0f;
    T give, take, underside, relief, open, cover, total, held;
    load(give, r.give + x);
    load(take, r.take + x);
    load(underside, r.underside + x);
    load(relief, r.relief + x);
    load(open, r.open + x);
    load(cover, r.cover + x);
    load(total, r.total + x);
    load(held, r.load_total + x);
    const auto [mixed, upper] = films_at<T>(x, r.shared);
    held = held > zero ? held : zero;  // rounding
    // How far bristles dip into the paint.
    const T dip = one - (underside - relief - total) * r.per_reach, dips = dip > zero ? dip : zero;
    const T dipped = (dips < one ? dips : one) * open * cover;
    FilmMoves<T> moves;
    const T above = moves.above = r.laid_above ? one : (upper > zero ? one : zero);
    // They change places with it: what they bring stays, and they carry on what was there.
    const T all = upper + mixed, wanted = take * all, first = wanted < upper ? wanted : upper;
    const T left = (one - give) * held;
    const T swapped = above * r.swap * dipped * (left < mixed ? left : mixed), both = wanted + swapped;
    const T taken = both < all ? both : all;
    give += swapped / (held + kTiny);
    moves.give = give;
    moves.upper_taken = first / (upper + kTiny);
    moves.mixed_taken = above > zero ? (taken - first) / (mixed + kTiny) : take;
    // What is laid pushes as much down as there is too much of it.
    const T laid = give * held, laid_on = above * laid, u1 = upper - first + laid_on;
    const T excess = u1 > kUpper_mm ? u1 - kUpper_mm : zero, sunk = excess < laid_on ? excess : laid_on;
    moves.sinking = sunk / (u1 + kTiny);
    const T u2 = u1 - sunk;
    const T rest = mixed - (taken - first) + (laid - laid_on) + sunk, m2 = rest > zero ? rest : zero;
    const T stirred = r.stir * dipped * (u2 < m2 ? u2 : m2);
    moves.upper_stirred = stirred / (u2 + kTiny);
    moves.mixed_stirred = stirred / (m2 + kTiny);
    return moves;
}

// As many pixels of all ingredients as T holds, from x on. Where there is no upper film, bits are those of
// apply_some(): how steps are grouped to windows does not show.
template <class T>
TP_INLINE void apply_films_some(int x, const FilmsRow& r) {
    const FilmMoves<T> moves = moves_at<T>(x, r);
    const auto [count, paint, on_bristles] = r.shared;  // a copy, which nothing that is written can change
    T sum{}, load_sum{};
    for (std::size_t i = 0; i < count; ++i) {
        float *at_mixed = paint[2 * i] + x, *at_upper = paint[2 * i + 1] + x, *at_brush = on_bristles[i] + x;
        T m, u, on_brush;
        load(m, at_mixed);
        load(u, at_upper);
        load(on_brush, at_brush);
        const T given = moves.give * on_brush, onto = moves.above * given;
        const T to_upper = onto - moves.upper_taken * u, to_mixed = (given - onto) - moves.mixed_taken * m;
        on_brush -= to_mixed + to_upper;
        u += to_upper;
        m += to_mixed;
        const T sinks = moves.sinking * u;
        u -= sinks;
        m += sinks;
        const T up = moves.mixed_stirred * m - moves.upper_stirred * u;
        u += up;
        m -= up;
        std::memcpy(at_mixed, &m, sizeof m);
        std::memcpy(at_upper, &u, sizeof u);
        std::memcpy(at_brush, &on_brush, sizeof on_brush);
        sum += m;
        sum += u;
        load_sum += on_brush;
    }
    std::memcpy(r.total + x, &sum, sizeof sum);
    std::memcpy(r.load_total + x, &load_sum, sizeof load_sum);
}

template <int kLanes>
TP_INLINE void apply_films_all(int n, const FilmsRow& r) {
    int x = 0;
    for (; x + kLanes <= n; x += kLanes) apply_films_some<FloatLanes<kLanes>>(x, r);
    for (; kLanes > kWidened && x + kWidened <= n; x += kWidened)
        apply_films_some<FloatLanes<kWidened>>(x, r);
    for (; x < n; ++x) apply_films_some<float>(x, r);
}

TP_VECTOR_CLONES
void apply_films_row(int n, const FilmsRow& r) {
    with_lanes([&](auto lanes) TP_INLINE_LAMBDA { apply_films_all<lanes>(n, r); });
}

std::size_t at(int y, std::size_t stride) { return static_cast<std::size_t>(y) * stride; }

}  // namespace

RowSpan widened(const RowSpan& span, const RowSpan& room) {
    const int wanted = (span.end - span.begin + kWidened - 1) / kWidened * kWidened;
    const int end = std::min(span.begin + wanted, room.end);
    return {std::max(end - wanted, room.begin), end};
}

void exchange_in_row(const StepBox& box, const TransferRates& rates, int y, float* memory) {
    if (box.bristles[static_cast<std::size_t>(y)].end <= box.bristles[static_cast<std::size_t>(y)].begin)
        return;
    const RowSpan span = widened(box.bristles[static_cast<std::size_t>(y)], {0, box.width});
    const int count = span.end - span.begin;
    float *give = memory, *take = memory + box.width;
    const auto first = static_cast<std::size_t>(span.begin);
    const std::size_t canvas = at(y, box.canvas_stride) + first, load = at(y, box.load_stride) + first,
                      below = at(y, box.underside_stride) + first;
    const float *underside = box.underside_mm + below, *relief = box.relief_mm + canvas,
                *open = box.open + canvas, *cover = box.cover + below;
    float *total = box.total_mm + canvas, *load_total = box.load_total_mm + load;
    exchange_row(count, rates, box.sides.row_from(span.begin, y), box.lanes, underside, relief, open, cover,
                 total, load_total, give, take);
    const SharedRow row{box.load.size(),
                        {box.paint.data(), static_cast<std::ptrdiff_t>(canvas)},
                        {box.load.data(), static_cast<std::ptrdiff_t>(load)}};
    if (box.paint.size() > box.load.size())
        apply_films_row(count, {row, give, take, underside, relief, open, cover, total, load_total,
                                box.laid_above, rates.stir, rates.swap, 1 / rates.reach_mm});
    else
        apply_row(count, give, take, row, total, load_total);
}

void exchange(const StepBox& box, const TransferRates& rates, StepScratch& scratch) {
    scratch.planes.resize(std::max(scratch.planes.size(), 2 * static_cast<std::size_t>(box.width)));
    for (int y = 0; y < box.height; ++y) exchange_in_row(box, rates, y, scratch.planes.data());
}

}  // namespace tangi
