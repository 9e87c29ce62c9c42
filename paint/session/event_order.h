// event_order.h: which event may come when: a stroke begins with "stroke", goes on with points, and is over
// with "end"; nothing else comes between.
//
// The window's painter, the writer of journals, their reader and the session go by it alike, so that nothing
// is painted that is not recorded, and nothing recorded that replays as something else.
#pragma once

#include <string>
#include <string_view>

#include "paint/session/journal_event.h"

namespace tangi {

class EventOrder {
public:
    enum class Fit {
        fits,
        after_end,  // a stroke is under way, and has to end first
        nowhere     // a point or an end, and no stroke is under way
    };
    Fit fit(const Event& event) const;

    // It happens. What has to come after the end of a stroke ends it; what fits nowhere changes nothing.
    void take(const Event& event);
    // The stroke under way ends, since this comes next.
    void end_by(const Event& event);

    bool in_stroke() const { return in_stroke_; }
    bool has_points() const { return has_points_; }  // the stroke under way
    // What has ended the last stroke in place of an "end", for messages; empty where nothing has.
    std::string_view ended_by() const { return ended_by_; }

private:
    bool in_stroke_ = false, has_points_ = false;
    std::string_view ended_by_;  // of name_of()
};

// Why a point has no place, where it has none.
std::string why_nowhere(const EventOrder& order);

}  // namespace tangi
