// shown_texts.h: what the panels show of texts that are not the program's own: names, notes, messages.
#pragma once

#include <functional>
#include <string_view>

#include "viewer/model/window_state.h"

namespace tangi {

// Tells `see` of all of them; what is typed at this moment is not among them.
void each_shown_text(const WindowState& state, const std::function<void(std::string_view)>& see);

}  // namespace tangi
