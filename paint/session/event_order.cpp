#include "paint/session/event_order.h"

#include <fmt/format.h>

namespace tangi {

EventOrder::Fit EventOrder::fit(const Event& event) const {
    const bool goes_on = std::holds_alternative<PointEvent>(event) || std::holds_alternative<EndEvent>(event);
    if (goes_on) return in_stroke_ ? Fit::fits : Fit::nowhere;
    return in_stroke_ ? Fit::after_end : Fit::fits;
}

void EventOrder::end_by(const Event& event) {
    if (!in_stroke_) return;
    in_stroke_ = false;
    ended_by_ = std::holds_alternative<EndEvent>(event) ? std::string_view() : name_of(event);
}

void EventOrder::take(const Event& event) {
    if (std::holds_alternative<PointEvent>(event)) {
        has_points_ |= in_stroke_;
        return;
    }
    end_by(event);
    if (std::holds_alternative<EndEvent>(event)) {
        ended_by_ = {};  // after what has ended its stroke already, too
    } else if (std::holds_alternative<StrokeEvent>(event)) {
        in_stroke_ = true;
        has_points_ = false;
    }
}

std::string why_nowhere(const EventOrder& order) {
    if (order.ended_by().empty())
        return "a point outside of a stroke; a stroke begins with 'stroke', and is over with 'end'";
    return fmt::format(
        "a point of a stroke that the '{0}' before it has ended; put the '{0}' after the stroke's 'end'",
        order.ended_by());
}

}  // namespace tangi
