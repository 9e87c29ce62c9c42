// panel_input.h: what pointer and keyboard do to the panels, event by event.
//
// Dear ImGui (1.86) knows what is down at one moment, not what went down and up since the last: two clicks
// within a slow frame would be one, and a key that was up again would never have been down. So it is given as
// many moments as it takes: the panels are gone through once for each, and drawn after the last.
#pragma once

#include <array>
#include <bitset>
#include <deque>

#include "viewer/devices/input.h"

namespace tangi {

class PanelInput {
public:
    void put(const InputEvent& event) { events_.push_back(event); }
    // What was put last is no key for the panels.
    void take_back_key() {
        if (!events_.empty() && events_.back().kind == InputEvent::Kind::key) events_.pop_back();
    }
    bool waits() const { return !events_.empty(); }
    void clear() { events_.clear(); }

    struct Fed {
        bool enter = false, escape = false;  // were pressed
    };
    // Moves what is one moment to the panels into ImGui::GetIO(), between the backends' new frame and Dear
    // ImGui's. `finger`: where a finger is the pointer. `ready_to_type`: where this is false, keys and text
    // wait: what they are meant for is not there yet.
    Fed feed(const std::optional<glm::dvec2>& finger, bool ready_to_type);

    // A list that is unfolded, or a menu: keys are meant for it.
    static bool popup_is_open();
    static void close_popups();  // within a frame

private:
    struct Moment;
    bool fits(const InputEvent& event, const Moment& moment) const;
    bool repeats(const InputEvent& event) const;
    void take(const InputEvent& event, Moment& moment, Fed& fed);
    void count_click(const InputEvent& event);

    std::deque<InputEvent> events_;
    std::array<bool, 5> buttons_{};  // that are down
    std::bitset<512> keys_;          // the same
    // When they went down last; long ago to begin with.
    std::array<double, 5> pressed_s_{-1e9, -1e9, -1e9, -1e9, -1e9};
};

}  // namespace tangi
