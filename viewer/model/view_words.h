// view_words.h: light, view and look as words, "azimuth=135&elevation=50&…": as links to web pages have them,
// and annotations keep them (docs/guide/web-export.md; viewer/web/page/link.js).
#pragma once

#include <string>
#include <string_view>

#include "viewer/model/window_state.h"

namespace tangi {

// What pages know, and behind it what the window alone has: further lights, near ones, the illuminant, the
// ends of scales. Pages ignore that.
std::string view_words(const WindowState& state);

// Shows it again. What is no number, or not among the words, stays as it is; a number that the hand cannot
// reach is taken as the nearest that it can.
void follow_view_words(WindowState& state, std::string_view words);

}  // namespace tangi
