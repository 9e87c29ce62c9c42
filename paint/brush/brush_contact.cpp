// brush_contact.cpp: where a brush touches the canvas.
#include <algorithm>
#include <cmath>

#include "paint/brush/brush.h"

#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr float kPressedOut = 0.3f;  // [1] of a blade's gap, at the lightest touch
constexpr float kLightest = 0.15f;   // part of the dome that the lightest touch flattens
constexpr double kSide_mm = 1.6;     // width of the sides, out of which paint is pressed: a few bristles

// Length of a contact with these half extents along the motion.
double length_along(const Dab& dab, double half_width, double half_thickness) {
    const double along = dab.dx * portable::cos(dab.rotation_rad) + dab.dy * portable::sin(dab.rotation_rad);
    return 2 * std::sqrt(half_width * half_width * along * along +
                         half_thickness * half_thickness * (1 - along * along));
}

float flattened(float pressure) { return kLightest + (1 - kLightest) * pressure; }

float gap_of(const BrushSettings& settings, float pressure) {
    return static_cast<float>(settings.gap_mm) * (1 - 0.3f * pressure);
}

// The row that begins so many pixels farther to the right and down.
UndersideRow moved(UndersideRow row, float dx, float dy) {
    row.u += dx * row.du - dy * row.dv;
    row.v += dy * row.du + dx * row.dv;
    return row;
}

}  // namespace

void Brush::contact_centre(const Dab& dab, double& x, double& y) const {
    const double trail = settings_.bend * half_width_px_ * (0.3 + 0.7 * dab.pressure);
    x = dab.x - trail * (dab.dx + dab.tilt_x);
    y = dab.y - trail * (dab.dy + dab.tilt_y);
}

void Brush::reach_px(const Dab& dab, int& half_x, int& half_y) const {
    const double widening = 1 + settings_.splay * dab.pressure;
    const double a = widening * half_width_px_, b = widening * half_thickness_px_;
    const double c = std::abs(portable::cos(dab.rotation_rad)), s = std::abs(portable::sin(dab.rotation_rad));
    half_x = std::min(static_cast<int>(std::ceil(a * c + b * s)) + kMargin, half_);
    half_y = std::min(static_cast<int>(std::ceil(a * s + b * c)) + kMargin, half_);
}

double Brush::contact_length_px(const Dab& dab) const {
    if (coverage_ == 1) return resolved_length_px(dab);
    return length_along(dab, width_px_ / 2, thickness_px_ / 2);
}

double Brush::resolved_length_px(const Dab& dab) const {
    return length_along(dab, half_width_px_, half_thickness_px_);
}

BrushSides Brush::sides(const Dab& dab, int x0, int y0) const {
    BrushSides sides;
    if (dab.dx == 0 && dab.dy == 0) return sides;
    double x, y;
    contact_centre(dab, x, y);
    if (dab.stands) {
        sides.ax = dab.dx;
        sides.ay = dab.dy;
        sides.a0 = static_cast<float>(sides.ax * (x0 - x) + sides.ay * (y0 - y));
        sides.left_px = sides.right_px = static_cast<float>(resolved_length_px(dab) / 2) *
                                         (1 + static_cast<float>(settings_.splay) * dab.pressure);
        return sides;
    }
    sides.ax = -dab.dy;
    sides.ay = dab.dx;
    sides.a0 = static_cast<float>(sides.ax * (x0 - x) + sides.ay * (y0 - y));
    const float c = portable::cos(dab.rotation_rad), s = portable::sin(dab.rotation_rad);
    const float u = c * sides.ax + s * sides.ay, v = c * sides.ay - s * sides.ax;
    const float widening = 1 + static_cast<float>(settings_.splay) * dab.pressure;
    const float dome = flattened(dab.pressure);
    sides.right_px = widening * tip_.reach_px(u, v, dome);
    sides.left_px = widening * tip_.reach_px(-u, -v, dome);
    sides.band_px = std::min(static_cast<float>(kSide_mm / mm_per_pixel_),
                             0.5f * std::min(sides.left_px, sides.right_px));
    return sides;
}

StandingTip Brush::standing(const Dab& dab, int x0, int y0) const {
    StandingTip tip;
    double x, y;
    contact_centre(dab, x, y);
    tip.map = tip_.map();
    tip.x = static_cast<float>(x - x0);
    tip.y = static_cast<float>(y - y0);
    tip.cosine = portable::cos(dab.rotation_rad);
    tip.sine = portable::sin(dab.rotation_rad);
    tip.narrowing = 1 / (1 + static_cast<float>(settings_.splay) * dab.pressure);
    tip.touched = flattened(dab.pressure);
    tip.band_px = static_cast<float>(
        std::min(kSide_mm / mm_per_pixel_, 0.5 * std::min(half_width_px_, half_thickness_px_)));
    tip.towards_x = dab.side * dab.dx;
    tip.towards_y = dab.side * dab.dy;
    return tip;
}

float Brush::ride_mm(float pressure) const {
    return gap_of(settings_, pressure) + static_cast<float>(BrushTip::kMeanShorter * settings_.groove_mm);
}

// A blade is stiff: it rides as a whole on the paint that it brings. Under one without paint there is only
// what pressure does not press out.
float Brush::gap_mm(float pressure) const {
    const float gap = gap_of(settings_, pressure);
    if (!traits_of(settings_.shape).blade || !(gap > 0)) return gap;
    const float carried = std::min(static_cast<float>(settings_.load_reach) * bead_mm_ / gap, 1.0f);
    return gap * (carried + (1 - carried) * kPressedOut * (1 - pressure));
}

TipOutline Brush::outline(const Dab& dab) const {
    const double widening = 1 + settings_.splay * dab.pressure;
    return {(half_width_px_ + 1) * widening, (half_thickness_px_ + 1) * widening,
            portable::cos(dab.rotation_rad), portable::sin(dab.rotation_rad),
            traits_of(settings_.shape).elliptic};
}

UndersideRow Brush::underside_of(const Dab& dab, float gap_mm, float groove_mm) const {
    const float narrowing = 1 / (1 + static_cast<float>(settings_.splay) * dab.pressure);
    UndersideRow row{};
    row.u = static_cast<float>(tip_.half_u());
    row.v = static_cast<float>(tip_.half_v());
    row.du = portable::cos(dab.rotation_rad) * narrowing;
    row.dv = -portable::sin(dab.rotation_rad) * narrowing;
    row.gap_mm = gap_mm;
    row.groove_mm = groove_mm;
    row.rise_mm = 2 * static_cast<float>(settings_.depth_mm);
    row.touched = flattened(dab.pressure);
    row.rim_mm = static_cast<float>(std::min(settings_.yield_slope * mm_per_pixel_, settings_.reach_mm));
    return row;
}

float Brush::lowest_mm(const Dab& dab, int x, int y) const {
    double cx, cy;
    contact_centre(dab, cx, cy);
    const UndersideRow row =
        moved(underside_of(dab, 0, 0), static_cast<float>(x - cx), static_cast<float>(y - cy));
    float underside, cover;
    underside_row(1, tip_.map(), row, &underside, &cover);
    return underside;
}

void Brush::underside_mm(const Dab& dab, const Region& box, float* out, float* cover,
                         std::vector<RowSpan>& spans) const {
    const int x0 = box.x0, y0 = box.y0, width = box.width(), height = box.height();
    double cx, cy;
    contact_centre(dab, cx, cy);
    // The leading edge is higher; tilt lifts the side that the handle leans away from.
    const float per_px = static_cast<float>(settings_.depth_mm) / static_cast<float>(half_width_px_);
    const float lift_x = per_px * (static_cast<float>(settings_.lift) * dab.dx - dab.tilt_x);
    const float lift_y = per_px * (static_cast<float>(settings_.lift) * dab.dy - dab.tilt_y);
    const TipMap map = tip_.map();
    UndersideRow middle = underside_of(dab, gap_mm(dab.pressure), static_cast<float>(settings_.groove_mm));
    middle.dlift_mm = lift_x;
    const TipOutline outline = this->outline(dab);
    spans.resize(static_cast<std::size_t>(height));
    const auto one = [&](int y) {
        const double py = y0 + y - cy;
        RowSpan& span = spans[static_cast<std::size_t>(y)];
        span = outline.across(py, x0 - cx, width);
        const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
        float *to = out + first, *part = cover + first;
        if (span.end <= span.begin) {
            std::fill_n(to, width, kOutside);
            std::fill_n(part, width, 0.0f);
            return;
        }
        const RowSpan whole = widened(span, {0, width});
        const auto dx = static_cast<float>(x0 + whole.begin - cx), dy = static_cast<float>(py);
        UndersideRow row = moved(middle, dx, dy);
        row.lift_mm = dx * lift_x + dy * lift_y;
        underside_row(whole.end - whole.begin, map, row, to + whole.begin, part + whole.begin);
        std::fill(to, to + span.begin, kOutside);
        std::fill(to + span.end, to + width, kOutside);
        std::fill(part, part + span.begin, 0.0f);
        std::fill(part + span.end, part + width, 0.0f);
    };
    for_rows_of_step(width, height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) one(y);
    });
}

}  // namespace tangi
