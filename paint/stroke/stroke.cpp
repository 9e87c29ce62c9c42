#include "paint/stroke/stroke.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "paint/stroke/brush_steps.h"
#include "paint/stroke/load_rows.h"
#include "surface/base/error.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

// [1] Where the brush turns, what one bristle leaves in a step and another takes in the next shows as rungs,
// so steps are shorter than the rim's way alone asks for: that many times; and so many for each pixel of the
// way, or each row of pixels, at most, where it turns on the spot.
constexpr double kRim = 1.5, kMostSteps = 2;

// A brush that is put down or lifted stands for so many steps, or more where its rim would go more than a
// pixel in each; in all for this part [1] of the time in which its contact passes, at full pressure.
constexpr int kStands = 4, kMostStands = 8;
constexpr double kStandsFor = 0.7;

// Paint settles every so many steps, in tiles that none of the last so many came over.
constexpr int kSettle = 64;

// Walls that are so many times [1] as steep as paint holds collapse every so many steps, and lower ones when
// the brush is lifted, so often at most: to look for them, and to let them flow, takes time.
constexpr float kHighWall = 3, kWall = 1.5f;
constexpr int kLooksForWalls = 4 * kSettle, kCollapses = 8;

constexpr double kShortContact_px = 6;  // shorter ones take steps of half the spacing

double length(const PathPoint& p) { return portable::hypot(p.x, p.y); }
PathPoint operator-(const PathPoint& a, const PathPoint& b) { return {a.x - b.x, a.y - b.y}; }
PathPoint operator+(const PathPoint& a, const PathPoint& b) { return {a.x + b.x, a.y + b.y}; }
PathPoint operator*(double s, const PathPoint& p) { return {s * p.x, s * p.y}; }

double interpolated(double a, double b, double t) { return a + (b - a) * t; }

// The angle nearest to `reference` that is the same direction as `angle`.
double unwrapped(double angle, double reference) {
    return reference + std::remainder(angle - reference, 2 * std::numbers::pi);
}

}  // namespace

PathPoint catmull_rom(const PathPoint& a, const PathPoint& b, const PathPoint& c, const PathPoint& d,
                      double u) {
    // Barry and Goldman's pyramid (1988), knots spaced by the root of the distance.
    const auto knot = [](const PathPoint& p, const PathPoint& q) {
        return std::sqrt(std::max(length(q - p), 1e-9));
    };
    const double t0 = 0, t1 = t0 + knot(a, b), t2 = t1 + knot(b, c), t3 = t2 + knot(c, d);
    const double t = interpolated(t1, t2, u);
    const auto blend = [t](const PathPoint& p, double tp, const PathPoint& q, double tq) {
        return ((tq - t) / (tq - tp)) * p + ((t - tp) / (tq - tp)) * q;
    };
    const PathPoint a1 = blend(a, t0, b, t1), a2 = blend(b, t1, c, t2), a3 = blend(c, t2, d, t3);
    return blend(blend(a1, t0, a2, t2), t1, blend(a2, t1, a3, t3), t2);
}

Stroke::Stroke(Canvas& canvas, Brush& brush, const StrokeOptions& options, std::uint64_t seed)
    : canvas_(canvas), brush_(brush), options_(options), seed_(seed), other_(brush) {
    validate(options);
    spacing_px_ = options.spacing_px;
}

Stroke::Knot Stroke::knot_of(const StrokePoint& p) {
    const bool finite = std::isfinite(p.x_mm) && std::isfinite(p.y_mm) && std::isfinite(p.rotation_deg);
    if (!finite) fail("a stroke's point ({}, {}) mm, {} deg is not finite", p.x_mm, p.y_mm, p.rotation_deg);
    if (!(p.pressure >= 0 && p.pressure <= 1)) fail("pressure = {} is outside [0, 1]", p.pressure);
    if (!(portable::hypot(p.tilt_x, p.tilt_y) <= 1))
        fail("tilt = ({}, {}) is longer than 1", p.tilt_x, p.tilt_y);
    if (!(p.time_s >= last_time_s_))
        fail("time = {} s lies before that of the point before, {} s", p.time_s, last_time_s_);
    last_time_s_ = p.time_s;
    if (!first_time_s_) first_time_s_ = p.time_s;
    greatest_pressure_ = std::max(greatest_pressure_, p.pressure);
    const double mm = canvas_.mm_per_pixel();
    Knot knot;
    knot.at = {p.x_mm / mm + (canvas_.width() - 1) / 2.0, (canvas_.height() - 1) / 2.0 - p.y_mm / mm};
    // A point far away is a mistake, and the way to it would take for ever.
    const double far = 4.0 * (canvas_.width() + canvas_.height()) + 4000;
    if (length(knot.at) > far)
        fail(
            "the point ({}, {}) mm is far from the canvas, which is {} x {} mm around (0, 0); places are in "
            "mm from its middle, y up",
            p.x_mm, p.y_mm, canvas_.width() * mm, canvas_.height() * mm);
    knot.pressure = portable::pow(p.pressure, options_.pressure_gamma);
    knot.tilt_x = p.tilt_x;
    knot.tilt_y = -p.tilt_y;
    knot.rotation_rad = -p.rotation_deg * std::numbers::pi / 180;
    knot.came_s = knot.left_s = age_s();
    return knot;
}

void Stroke::add(const StrokePoint& point) {
    TP_REQUIRE(!finished_, "a finished stroke takes no points");
    Knot knot = knot_of(point);
    if (options_.stabiliser_mm > 0) {
        const double string = options_.stabiliser_mm / canvas_.mm_per_pixel();
        if (!string_end_) string_end_ = knot.at;
        const PathPoint pull = knot.at - *string_end_;
        if (length(pull) > string) string_end_ = *string_end_ + (1 - string / length(pull)) * pull;
        knot.at = *string_end_;
    }
    if (!knots_.empty()) {
        knot.rotation_rad = unwrapped(knot.rotation_rad, knots_.back().rotation_rad);
        if (length(knot.at - knots_.back().at) < 0.01) {  // where it stands, only the pressure may grow
            knots_.back().pressure = std::max(knots_.back().pressure, knot.pressure);
            knots_.back().left_s = knot.left_s;
            return;
        }
    }
    knots_.push_back(knot);
    if (knots_.size() == 3) segment(knots_[0], knots_[0], knots_[1], knots_[2]);
    if (knots_.size() == 4) {
        segment(knots_[0], knots_[1], knots_[2], knots_[3]);
        knots_.erase(knots_.begin());
    }
    paint();
}

void Stroke::finish() {
    if (finished_) return;
    finished_ = true;
    const std::size_t n = knots_.size();
    if (n == 1) {
        Dab dab;
        dab.x = knots_[0].at.x;
        dab.y = knots_[0].at.y;
        dab.pressure = static_cast<float>(knots_[0].pressure);
        dab.rotation_rad = static_cast<float>(knots_[0].rotation_rad);
        dab.tilt_x = static_cast<float>(knots_[0].tilt_x);
        dab.tilt_y = static_cast<float>(knots_[0].tilt_y);
        dab.dx = dab.dy = 0;
        // A dab rests for as long as a stroke takes to pass by.
        dab.length_px = static_cast<float>(options_.spacing_px);
        const int rest = static_cast<int>(std::lround(brush_.contact_length_px(dab) / 4)) + 1;
        dabs_.assign(static_cast<std::size_t>(rest), dab);
        ages_s_.assign(dabs_.size(), knots_[0].came_s);
        for (int i = 0; i < rest; ++i) {
            Dab& now = dabs_[static_cast<std::size_t>(i)];
            now.step = i;
            now.stands = true;
            now.pressed = 1 / static_cast<float>(rest);
        }
    } else if (n >= 2) {
        const Knot &before = n >= 3 ? knots_[n - 3] : knots_[n - 2], &last = knots_[n - 1];
        segment(before, knots_[n - 2], last, last);
        if (!dabs_.empty() || last_) stand(dabs_.empty() ? *last_ : dabs_.back(), 1, age_s());
    }
    paint();
    brush_.rest();
    if (last_) relax(*last_);
    for (int i = 0; i < kCollapses && slump_walls(kWall, steps_); ++i) continue;
    settle_paint(std::numeric_limits<int>::max());
    while (look_ && look_at_s_ < age_s()) call_look();
}

void Stroke::watch(double first_s, Look look) {
    TP_REQUIRE(knots_.empty(), "a stroke is watched from its first point on");
    look_at_s_ = first_s;
    look_ = std::move(look);
}

void Stroke::call_look() {
    const double next_s = look_(look_at_s_);
    TP_REQUIRE(next_s > look_at_s_, "one looks again later");
    look_at_s_ = next_s;
}

void Stroke::segment(const Knot& a, const Knot& b, const Knot& c, const Knot& d) {
    // Ends have no neighbour: the mirrored one makes the curve leave them straight.
    const PathPoint before = &a == &b ? b.at - (c.at - b.at) : a.at,
                    after = &c == &d ? c.at + (c.at - b.at) : d.at;
    const int pieces = std::max(8, static_cast<int>(length(c.at - b.at) * 2));
    PathPoint from = b.at;
    for (int i = 1; i <= pieces; ++i) {
        const double u = static_cast<double>(i) / pieces;
        const PathPoint to = catmull_rom(before, b.at, c.at, after, u), way = to - from;
        const double along = length(way);
        if (along < 1e-12) continue;
        double done = 0;
        while (left_px_ <= along - done) {
            done += left_px_;
            step_to(b, c, (i - 1 + done / along) / pieces, from + (done / along) * way, (1 / along) * way);
            left_px_ = spacing_px_;
        }
        left_px_ -= along - done;
        from = to;
    }
}

void Stroke::step_to(const Knot& b, const Knot& c, double u, const PathPoint& at,
                     const PathPoint& direction) {
    Dab dab;
    dab.length_px = static_cast<float>(spacing_px_);
    dab.x = at.x;
    dab.y = at.y;
    dab.pressure = static_cast<float>(interpolated(b.pressure, c.pressure, u));
    dab.tilt_x = static_cast<float>(interpolated(b.tilt_x, c.tilt_x, u));
    dab.tilt_y = static_cast<float>(interpolated(b.tilt_y, c.tilt_y, u));
    dab.dx = static_cast<float>(direction.x);
    dab.dy = static_cast<float>(direction.y);
    double rotation = interpolated(b.rotation_rad, c.rotation_rad, u);
    if (brush_.settings().follow) {
        // The hand turns the width across the stroke, not at once.
        const double heading = portable::atan2(direction.y, direction.x) + std::numbers::pi / 2;
        if (!heading_rad_) heading_rad_ = static_cast<float>(heading);
        // Backwards it is the same as forwards: the hand does not turn it round where a stroke reverses.
        const double wanted = *heading_rad_ + std::remainder(heading - *heading_rad_, std::numbers::pi);
        const double lag_px = std::max(4.0, brush_.settings().size_mm / canvas_.mm_per_pixel() / 4);
        *heading_rad_ += static_cast<float>((wanted - *heading_rad_) * spacing_px_ / lag_px);
        rotation += *heading_rad_;
    }
    dab.rotation_rad = static_cast<float>(rotation);
    // What is given and taken back within one step must be little of the whole: a short contact takes six or
    // more. Paint goes a pixel in a step at most: a blade goes slower than what it pushes ahead. Loads lie on
    // whole pixels, and steps of other parts of one would leave rungs.
    const bool in_halves =
        traits_of(brush_.settings().shape).blade || brush_.resolved_length_px(dab) < kShortContact_px;
    const double wanted = options_.spacing_px * (in_halves ? 0.5 : 1);
    // Where the brush turns, its rim goes further than its middle: no bristle shall go more than the spacing.
    double turning = 0;
    if (rotation_rad_) {
        dab.turn_rad = dab.rotation_rad - *rotation_rad_;
        turning = std::abs(dab.turn_rad) / spacing_px_ * brush_.rim_px();
    }
    const double spacing = std::max(wanted / (1 + kRim * turning), options_.spacing_px / kMostSteps);
    double x, y;
    brush_.contact_centre(dab, x, y);
    const LoadRows rows = rows_across(dab.dx, dab.dy);
    spacing_px_ = way_to_row_px(rows, rows.at(x, y), spacing);
    rotation_rad_ = dab.rotation_rad;
    const double age = interpolated(b.left_s, c.came_s, u);
    if (steps_ == 0 && dabs_.empty()) stand(dab, -1, age);
    way_px_ += dab.length_px;
    dab.way_px = static_cast<float>(way_px_);
    dab.step = steps_ + static_cast<int>(dabs_.size());
    dabs_.push_back(dab);
    ages_s_.push_back(age);
}

// Where it is put down, less of the brush passes over a place the nearer it is to its rear, and less the
// nearer to its front where it is lifted. It stands there for a while, the longer the heavier the hand, and
// lays the more paint the more is missing, so that this does not run out in a ramp; what it presses out is a
// rim.
void Stroke::stand(Dab dab, float side, double age_s) {
    dab.stands = true;
    dab.side = side;
    dab.turn_rad = 0;
    const double widens_px = brush_.settings().splay * dab.pressure * brush_.rim_px();
    const int stands = std::clamp(static_cast<int>(std::ceil(widens_px)), kStands, kMostStands);
    const auto count = static_cast<float>(stands);
    dab.pressed = 2 / (count + 1);  // of the pressures' sum
    const float pressure = dab.pressure;
    dab.length_px = static_cast<float>(kStandsFor * dab.pressure * brush_.contact_length_px(dab)) / count;
    // The tip stays where it is, whatever it trails behind by.
    double held_x, held_y;
    brush_.contact_centre(dab, held_x, held_y);
    for (int i = 0; i < stands; ++i) {
        dab.pressure = pressure * static_cast<float>(side < 0 ? i + 1 : stands - i) / count;
        double x, y;
        brush_.contact_centre(dab, x, y);
        dab.x += held_x - x;
        dab.y += held_y - y;
        dab.step = steps_ + static_cast<int>(dabs_.size());
        dabs_.push_back(dab);
        ages_s_.push_back(age_s);
    }
}

void Stroke::paint() {
    if (dabs_.empty()) return;
    for (std::size_t begin = 0; begin < dabs_.size();) {
        // What is asked for at the very end of the stroke is seen when the next one begins.
        while (look_ && look_at_s_ <= ages_s_[begin] && look_at_s_ < age_s()) call_look();
        std::size_t end = dabs_.size();
        if (look_ && look_at_s_ < age_s())
            end = static_cast<std::size_t>(std::ranges::lower_bound(ages_s_, look_at_s_) - ages_s_.begin());
        // Whatever way a stroke is divided, paint settles after the same steps.
        const int first = steps_ + static_cast<int>(begin), rest_at = (first / kSettle + 1) * kSettle;
        end = std::min(end, begin + static_cast<std::size_t>(rest_at - first));
        const std::span<const Dab> dabs = std::span(dabs_).subspan(begin, end - begin);
        for (const Dab& dab : dabs) come_over(dab);
        bristle_pixels_ += paint_dabs(canvas_, brush_, dabs, seed_, other_, memory_);
        begin = end;
        if (steps_ + static_cast<int>(end) == rest_at) {
            if (rest_at % kLooksForWalls == 0) slump_walls(kHighWall, rest_at);
            settle_paint(rest_at - kSettle);
        }
    }
    steps_ += static_cast<int>(dabs_.size());
    last_ = dabs_.back();
    dabs_.clear();
    ages_s_.clear();
}

}  // namespace tangi
