// usable_stack.h: a stack without the photographs that are damaged, for who can do without some.
#pragma once

#include "capture/stack.h"

namespace tangi {

// As open_stack(), but photographs that cannot be opened are left out, each with a warning that names it.
// Throws Error where that leaves none, and for all else that is wrong.
Stack open_usable_stack(const std::filesystem::path& folder, const StackOptions& options = {});

}  // namespace tangi
