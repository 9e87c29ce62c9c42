// error_message.h: what a person is told of an exception, whoever threw it.
#pragma once

#include <exception>
#include <filesystem>
#include <string>

#include "surface/base/memory_error.h"
#include "surface/file/file_name.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

// What went wrong, in the words that a person is told: no library's for memory and files, no temporary name.
inline std::string message_of(const std::exception& error) {
    if (says_no_memory(error)) return kNoMemory;
    const auto* of_file = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
    return in_lasting_names(of_file ? words_of(*of_file) : error.what());
}

}  // namespace tangi
