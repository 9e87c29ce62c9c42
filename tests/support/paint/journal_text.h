// journal_text.h: journals as text.
#pragma once

#include <string>

namespace tangi {

// The first line of a journal.
inline const std::string kJournalHeader = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n";

}  // namespace tangi
