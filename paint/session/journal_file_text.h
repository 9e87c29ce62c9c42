// journal_file_text.h: the text of a journal's file: its first line and its other lines.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "paint/session/journal.h"

namespace tangi {

// The least that a first line is.
inline constexpr std::string_view kJournalFirstLine = R"({"format": "tangipaint strokes", "version": 1})";

// The first line, without its end.
std::string first_line(const JournalHead& head);
// Whether a text, without the end of a line, is a part of a first line, as a crash leaves it.
bool is_torn_first_line(std::string_view text);

// Nothing where a line is no JSON; `why` says why. Throws Error for what parse_json() refuses.
std::optional<nlohmann::json> parsed_line(std::string_view line, const std::string& where,
                                          std::string* why = nullptr);

// What a first line says. Throws Error naming `where` for anything but one of this version.
JournalHead head_from(std::string_view line, const std::string& where);

// Ends of lines are LF, CR LF, or CR alone, as on old Macs; JSON has neither within a text.
std::size_t end_of_line(std::string_view text, std::size_t begin);

// Throws Error saying why where a journal with this event could not be read: a pile without paint, numbers
// beyond their limits or not finite, names that are too long.
void require_readable(const Event& event);

}  // namespace tangi
