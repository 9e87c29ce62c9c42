// open_screened.h: a stack without the photographs that cannot be used, for who can do without some.
#pragma once

#include "capture/photo/rejected_photo.h"
#include "capture/stack/stack.h"
#include "capture/stack/stack_calibration.h"

namespace tangi {

struct UsableOptions {
    bool any_loss = false;   // however many cannot be used, as long as one is left
    bool finds_mask = true;  // a picture in the folder whose name says mask is one, where none is given
    LightAxes light_axes{};  // of the vectors of an .lp
};

struct UsableStack {
    Stack stack;
    std::vector<RejectedPhoto> rejected;  // lit from below the painting's plane, too
    bool lights_by_order = false;         // no name in the lights file is that of a photograph
    std::optional<std::filesystem::path> found_mask{};
    std::vector<std::string> poor{};  // what calibrate called poor of what is used
};

// As open_stack(), but goes on without photographs that cannot be opened, that are not stored as most are
// (size, channels, bits, orientation), that are listed and missing, or have two lights, and without lines of
// an .lp that are none: each with a warning that names it. Throws Error as require_few() where these are too
// many, and for all else that is wrong.
UsableStack open_usable_stack(const std::filesystem::path& folder, const StackOptions& options,
                              const UsableOptions& usable = {});

// As open_photographs(), but goes on without photographs that cannot be used, which are added to `rejected`;
// with a warning for each. Throws as open_usable_stack().
Stack open_usable_photographs(const std::vector<std::filesystem::path>& paths, const StackOptions& options,
                              std::vector<RejectedPhoto>& rejected);

}  // namespace tangi
