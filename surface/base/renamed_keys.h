// renamed_keys.h: keys of JSON files that had other names in version 0.1.
#pragma once

#include <nlohmann/json.hpp>

namespace tangi {

// The same values under the names that keys have now, at any depth: files of both spellings are read.
nlohmann::json with_present_keys(nlohmann::json value);

}  // namespace tangi
