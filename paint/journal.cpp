#include "paint/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/json_text.h"

namespace tangi {

namespace {

using nlohmann::json;

const char* const kFirstLine = R"({"format": "tangipaint strokes", "version": 1})";

// Nothing where a line is no JSON; `why` says why.
std::optional<json> parsed_line(std::string_view line, const std::string& where, std::string* why = nullptr) {
    try {
        return parse_json(line, where);
    } catch (const json::parse_error& error) {
        if (why) *why = why_no_json(line, error.byte);
        return {};
    }
}

void require_header(const std::string& line, const std::string& where) {
    const auto header = parsed_line(line, where);
    if (!header || !header->is_object() || header->value("format", json()) != "tangipaint strokes")
        fail("{}: is not a journal of strokes; its first line must be {}", where, kFirstLine);
    const auto version = header->find("version");
    if (version == header->end()) fail("{}: has no 'version'; the line must be {}", where, kFirstLine);
    if (*version != 1) fail("{}: has version {}, but this program reads version 1", where, shown(*version));
}

// Ends of lines are LF, CR LF, or CR alone, as on old Macs; JSON has neither within a text.
std::size_t end_of_line(std::string_view text, std::size_t begin) {
    return std::min(text.find_first_of("\r\n", begin), text.size());
}

// What happened that its author cannot have meant, since strokes begin with "stroke" and end with "end".
std::vector<JournalWarning> misplaced(const Journal& journal) {
    std::vector<JournalWarning> warnings;
    int stroke = 0;  // line of the one under way; 0: none
    bool has_points = false;
    const auto warn = [&](int line, const std::string& words) { warnings.push_back({line, words}); };
    for (const auto& [line, event] : journal.entries) {
        if (std::holds_alternative<PointEvent>(event)) {
            has_points = true;
            continue;
        }
        const bool begins = std::holds_alternative<StrokeEvent>(event),
                   ends = std::holds_alternative<EndEvent>(event);
        if (stroke == 0 && ends) warn(line, "an 'end' without a stroke: it ends nothing");
        if (stroke > 0 && !has_points) warn(stroke, "the stroke has no points: it paints nothing");
        if (stroke > 0 && begins)
            warn(stroke,
                 fmt::format("the stroke has no 'end' before that of line {} begins; it ends there", line));
        else if (stroke > 0 && !ends)
            warn(line, fmt::format("'{}' comes before the 'end' of the stroke of line {}, which it ends",
                                   name_of(event), stroke));
        stroke = begins ? line : 0;
        has_points = false;
    }
    if (stroke > 0)
        warn(stroke, fmt::format("the stroke has no {}; it ends with the journal",
                                 has_points ? "'end'" : "points and no 'end'"));
    return warnings;
}

}  // namespace

Journal read_journal(const std::filesystem::path& path, const std::map<std::string, BrushSettings>& presets) {
    const std::string text = read_text_file(path);
    Journal journal;
    journal.source = path.string();
    int line = 0;
    std::uint64_t strokes = 0;
    bool has_header = false;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = end_of_line(text, begin);
        const bool whole = end < text.size();
        const std::string content = text.substr(begin, end - begin);
        begin = end + (text.compare(end, 2, "\r\n") == 0 ? 2 : 1);
        const std::string where = fmt::format("{}:{}", path.string(), ++line);
        if (content.find_first_not_of(" \t") == std::string::npos) continue;
        if (!has_header) {
            require_header(content, where);
            has_header = true;
            continue;
        }
        std::string why;
        const auto object = parsed_line(content, where, &why);
        if (!object) {
            if (whole) fail("{}: is not JSON: {}; one event is one line", where, why);
            journal.warnings.push_back({line, "the last line is cut short, as by a crash; it is left out"});
            break;
        }
        Event event = event_from_json(*object, where, presets);
        if (auto* stroke = std::get_if<StrokeEvent>(&event)) {
            // Strokes of one seed have the same streaks.
            if (!object->contains("seed")) stroke->seed = strokes;
            ++strokes;
        }
        journal.entries.push_back({line, std::move(event)});
    }
    if (!has_header) fail("{}: is empty; its first line must be {}", path.string(), kFirstLine);
    for (JournalWarning& warning : misplaced(journal)) journal.warnings.push_back(std::move(warning));
    std::ranges::stable_sort(journal.warnings, {}, &JournalWarning::line);
    return journal;
}

JournalWriter::JournalWriter(const std::filesystem::path& path) : path_(path) {
    file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) fail("{}: cannot be written: {}", path.string(), std::strerror(errno));
    try {
        const std::string text = read_text_file(path);
        if (text.empty()) {
            write(fmt::format("{}\n", kFirstLine));
        } else {
            require_header(text.substr(0, end_of_line(text, 0)), path.string() + ":1");
            if (text.find('\n') == std::string::npos && text.find('\r') != std::string::npos)
                fail(
                    "{}: its lines end with CR alone, as on old Macs, and it can be read but not gone on "
                    "with; save it with line ends LF",
                    path.string());
            const auto end = text.rfind('\n');
            const std::size_t torn = end == std::string::npos ? 0 : end + 1;
            // What was written whole but for its line end counts, as it does for who reads it.
            const bool is_whole = torn < text.size() && parsed_line(text.substr(torn), path.string());
            const auto length = static_cast<off_t>(is_whole ? text.size() : torn);
            if (::ftruncate(file_, length) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
                fail("{}: cannot be written: {}", path.string(), std::strerror(errno));
            if (is_whole) write("\n");
            if (length == 0) write(fmt::format("{}\n", kFirstLine));
        }
    } catch (...) {
        ::close(file_);
        throw;
    }
}

JournalWriter::~JournalWriter() { ::close(file_); }

void JournalWriter::append(const Event& event) { write(to_json(event).dump() + "\n"); }

void JournalWriter::sync() {
    if (::fdatasync(file_) != 0) fail("{}: cannot be written: {}", path_.string(), std::strerror(errno));
}

void JournalWriter::write(std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(file_, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0)
            fail("{}: cannot be written: {}", path_.string(), std::strerror(written == 0 ? ENOSPC : errno));
        text.remove_prefix(static_cast<std::size_t>(written));
    }
}

}  // namespace tangi
