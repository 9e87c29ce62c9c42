// named_inputs.h: the files that a command line names, for the record of what a result was made of.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "surface/file/file_stamp.h"

namespace tangi {

class NamedInputs {
public:
    // Of words and of flags' values, those that are files now, paintings in tiles, and the visible files of
    // other folders.
    explicit NamedInputs(std::span<char* const> words);
    // As records_of() (provenance.h) of those that are still the same: what was written, or has changed, is
    // no input. Files that cannot be read any more are left out.
    nlohmann::json records() const;

private:
    std::vector<std::pair<std::filesystem::path, FileStamp>> files_;
};

}  // namespace tangi
