// version.h: which TangiPaint this is, as it says it in results, files and --version.
#pragma once

#include <string>

namespace tangi {

const char* version();       // "0.2.0"
std::string program_name();  // "tangipaint 0.2.0"

}  // namespace tangi
