#include "surface/file/version.h"

#include "surface/file/version_number.h"

namespace tangi {

const char* version() { return kVersion; }

std::string program_name() { return std::string("tangipaint ") + kVersion; }

}  // namespace tangi
