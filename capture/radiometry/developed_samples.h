// developed_samples.h: what pixels of a few photographs, as they are developed so far, say of a stack's
// brackets and frames.
#pragma once

#include <vector>

#include "capture/radiometry/develop_stack.h"

namespace tangi {

// Fitted and held out.
std::vector<StackPhoto*> all_photos(Stack& stack);

// The settings of all brackets from the pixels of a few, put into the photographs and the report. Warns where
// settings are not what they are said to be.
void relate_exposures(Stack& stack, DevelopReport& report_);

// Frames that do not belong to these photographs show in their brightness: warns, or throws Error where
// nothing could come of it. To be called before ambient light is taken off.
void check_frames(Stack& stack, const DevelopReport& report_);

}  // namespace tangi
