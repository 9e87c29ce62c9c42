// provenance.h: which program made a painting or a result, of which files, as JSON; nothing of the machine.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace tangi {

// [{"file": name without folder, "bytes", "sha256": 64 hex digits, "modified": "2026-03-01T12:34:56Z"}, …] in
// the order of the files; of a painting in tiles they are painting.json's. Throws Error naming one that
// cannot be read.
nlohmann::json records_of(const std::vector<std::filesystem::path>& files);

// The first of these files that is not what the record of its name says, or has none; nothing where all are.
// One of the recorded size and date is taken for the same. Throws Error naming one that cannot be read.
std::optional<std::filesystem::path> changed_since(const nlohmann::json& records,
                                                   const std::vector<std::filesystem::path>& files);

// {"program": "tangipaint 0.2.0", "command", "options", "inputs"}: what the attribute `provenance` holds of
// paintings that a command made (docs/reference/quantities.md).
nlohmann::json provenance_of(const char* command, nlohmann::json options, nlohmann::json inputs);

// How another folder than the one that options were given for finds a file: relative to `folder`, or its name
// alone where it lies far from it.
std::string portable_path(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace tangi
