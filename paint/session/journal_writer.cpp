// journal_writer.cpp: of journals: their text, and files that are written event by event.
#include "paint/session/journal.h"
#include "paint/session/journal_file_text.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"

namespace tangi {

namespace {

// Of a first line: what may come after it says what the journal is of.
constexpr std::string_view kFirstLineStart = kJournalFirstLine.substr(0, kJournalFirstLine.size() - 1);

// [bytes] Where a last line without its end begins.
std::size_t begin_of_torn(std::string_view text) {
    const auto end = text.rfind('\n');
    return end == std::string_view::npos ? 0 : end + 1;
}

// What was written whole but for its line end counts, as it does for who reads it.
bool lacks_only_its_end(std::string_view line) {
    try {
        return !line.empty() && parsed_line(line, {}).has_value();
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

std::optional<nlohmann::json> parsed_line(std::string_view line, const std::string& where, std::string* why) {
    try {
        return parse_json(line, where);
    } catch (const nlohmann::json::parse_error& error) {
        if (why) *why = why_no_json(line, error.byte);
        return {};
    }
}

std::string first_line(const JournalHead& head) {
    std::string line = fmt::format("{}, \"software\": \"{}\"", kFirstLineStart, program_name());
    if (!head.on.empty()) line += fmt::format(", \"on\": \"{}\"", head.on);
    if (!head.makes.empty()) line += fmt::format(", \"makes\": \"{}\"", head.makes);
    return line + "}";
}

bool is_torn_first_line(std::string_view text) {
    if (text.find_first_of("\r\n") != std::string_view::npos) return false;
    return kFirstLineStart.starts_with(text) || (text.starts_with(kFirstLineStart) && !text.ends_with('}'));
}

JournalHead head_from(std::string_view line, const std::string& where) {
    const auto header = parsed_line(line, where);
    if (!header || !header->is_object() || header->value("format", nlohmann::json()) != "tangipaint strokes")
        fail("{}: is not a journal of strokes; its first line must be {}", where, kJournalFirstLine);
    const auto version = header->find("version");
    if (version == header->end()) fail("{}: has no 'version'; the line must be {}", where, kJournalFirstLine);
    if (*version != 1) fail("{}: has version {}, but this program reads version 1", where, shown(*version));
    const auto text = [&](const char* field) {
        const nlohmann::json value = header->value(field, nlohmann::json(""));
        if (!value.is_string())
            fail("{}: '{}' is {}, not the hash of a painting", where, field, shown(value));
        return value.get<std::string>();
    };
    return {text("on"), text("makes")};
}

std::size_t end_of_line(std::string_view text, std::size_t begin) {
    return std::min(text.find_first_of("\r\n", begin), text.size());
}

void require_readable(const Event& event) {
    const std::string where = fmt::format("this '{}' is left out", name_of(event));
    (void)event_from_json(parse_json(journal_line(event), where), where);
}

std::string journal_line(const Event& event) { return json_line(to_json(event)) + "\n"; }

std::string journal_text(const JournalHead& head, std::string_view lines) {
    return fmt::format("{}\n{}", first_line(head), lines);
}

std::string journal_text(std::span<const Journal::Entry> entries) {
    std::string lines;
    for (const Journal::Entry& entry : entries) lines += journal_line(entry.event);
    return journal_text(JournalHead{}, lines);
}

std::string lines_of_events(std::string_view text) {
    const std::size_t first = text.find('\n'), torn = begin_of_torn(text);
    if (first == std::string_view::npos) return {};
    const std::string_view last = text.substr(torn);
    if (lacks_only_its_end(last)) return fmt::format("{}\n", text.substr(first + 1));
    return std::string(text.substr(first + 1, torn - first - 1));
}

JournalWriter::JournalWriter(const std::filesystem::path& path, const JournalHead& head) : file_(path) {
    const std::string text = read_text_file(path);
    if (!text.empty()) go_on_with(text);
    if (file_.length() == 0) file_.append(journal_text(head, {}));
}

void JournalWriter::go_on_with(const std::string& text) {
    const std::filesystem::path& path = file_.path();
    if (is_torn_first_line(text)) {
        file_.cut(0);  // a crash came before anything was recorded
        return;
    }
    (void)head_from(text.substr(0, end_of_line(text, 0)), path.string() + ":1");
    if (text.find('\n') == std::string::npos && text.find('\r') != std::string::npos)
        fail(
            "{}: its lines end with CR alone, as on old Macs, and it can be read but not gone on with; save "
            "it with line ends LF",
            path.string());
    const std::size_t torn = begin_of_torn(text);
    if (lacks_only_its_end(std::string_view(text).substr(torn)))
        file_.append("\n");
    else if (torn < text.size())
        file_.cut(torn);
    for (const Journal::Entry& entry : recovered_journal(path).entries) order_.take(entry.event);
    if (order_.in_stroke()) append(EndEvent{});
}

void JournalWriter::append(const Event& event) {
    TP_REQUIRE(order_.fit(event) == EventOrder::Fit::fits, "an event is recorded where it belongs");
    file_.append(journal_line(event));
    order_.take(event);
}

}  // namespace tangi
