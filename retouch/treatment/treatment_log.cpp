#include "retouch/treatment/treatment_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/append_file.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int kVersion = 1;
const std::string kSeal = ",\"sha256\":\"";
constexpr std::size_t kDigits = 64;

fs::path head_path(const fs::path& log) {
    fs::path path = log;
    return path.replace_extension(".head.json");
}

// The text without its hash, and with it.
struct Line {
    std::string sealed, sha256;
};

Line sealed(const json& content) {
    const std::string body = json_line(content);
    const std::string hash = sha256_of(body);
    return {body.substr(0, body.size() - 1) + kSeal + hash + "\"}", hash};
}

// Empty where the line does not end with a hash.
std::string body_of(const std::string& line, std::string& hash) {
    const std::size_t tail = kSeal.size() + kDigits + 2;
    if (line.size() <= tail || !line.ends_with("\"}")) return {};
    const std::size_t seal = line.size() - tail;
    if (line.compare(seal, kSeal.size(), kSeal) != 0) return {};
    hash = line.substr(seal + kSeal.size(), kDigits);
    return line.substr(0, seal) + "}";
}

}  // namespace

std::vector<LogEntry> chained_entries(const std::string& text, std::vector<LogFault>& faults, bool& torn) {
    std::vector<LogEntry> entries;
    std::string previous(kDigits, '0');
    std::size_t from = 0;
    for (int number = 1; from < text.size(); ++number) {
        const std::size_t end = text.find('\n', from);
        torn = end == std::string::npos;
        if (torn) break;
        const std::string line = text.substr(from, end - from);
        from = end + 1;
        LogEntry entry{number, {}, {}};
        const std::string body = body_of(line, entry.sha256);
        if (body.empty()) {
            faults.push_back({number, "does not end with its hash: it was edited, or is no line of a log"});
            break;
        }
        if (sha256_of(body) != entry.sha256) {
            faults.push_back({number, "was edited: its text does not have the hash that it ends with"});
            break;
        }
        entry.content = json_or_discarded(body);
        if (!entry.content.is_object() || !entry.content.contains("previous")) {
            faults.push_back({number, "is no line of a log"});
            break;
        }
        if (entry.content["previous"] != previous) {
            faults.push_back({number, number == 1 ? "is not the first of its log: lines before it were cut"
                                                  : "does not follow the line before it: a line was "
                                                    "removed, put in, moved or written anew here"});
            break;
        }
        previous = entry.sha256;
        entries.push_back(std::move(entry));
    }
    return entries;
}

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                       utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

TreatmentLog TreatmentLog::begin(const fs::path& path, json content) {
    std::error_code missing;
    if (fs::exists(path, missing))
        fail("{}: there is a log already; go on with it, or choose another folder", path.string());
    content["format"] = kTreatmentFormat;
    content["version"] = kVersion;
    content["previous"] = std::string(kDigits, '0');
    const Line line = sealed(content);
    TreatmentLog log(path);
    log.entries_.push_back({1, std::move(content), line.sha256});
    log.seen_bytes_ = log.whole_bytes_ = line.sealed.size() + 1;
    // The head first: it is the log that makes a treatment, and no crash may leave one without a head.
    log.write_head();
    write_text_file(path, line.sealed + "\n");
    return log;
}

TreatmentLog TreatmentLog::open(const fs::path& path) {
    TreatmentLog log(path);
    const std::string text = read_text_file(path);
    std::vector<LogFault> faults;
    bool torn = false;
    log.entries_ = chained_entries(text, faults, torn);
    if (!faults.empty())
        fail("{}:{}: {}; take the log from a backup, nothing is done with this one", path.string(),
             faults.front().line, faults.front().what);
    if (log.entries_.empty() || log.entries_.front().content.value("format", json()) != kTreatmentFormat)
        fail("{}:1: is not the first line of a treatment's log; take the log from a backup", path.string());
    if (log.entries_.front().content.value("version", json()) != kVersion)
        fail("{}: is of a newer version of the program; this one reads version {}", path.string(), kVersion);
    log.whole_bytes_ = text.rfind('\n') + 1;
    log.seen_bytes_ = text.size();
    if (torn)
        log.warnings_.push_back(fmt::format("{}:{}: was cut short by a crash and is left out", path.string(),
                                            log.entries_.size() + 1));

    const fs::path head = head_path(path);
    const json stored = json_or_discarded(read_text_file(head));
    if (!stored.is_object() || !stored.contains("lines") || !stored["lines"].is_number_unsigned() ||
        !stored.contains("sha256") || !stored["sha256"].is_string())
        fail("{}: is not the head of a log; take it from a backup", head.string());
    const auto lines = stored["lines"].get<std::size_t>();
    if (lines > log.entries_.size())
        fail("{}:{}: the log was cut: {} line{} missing at its end; take it from a backup", path.string(),
             log.entries_.size() + 1, lines - log.entries_.size(),
             lines - log.entries_.size() == 1 ? " is" : "s are");
    if (lines == 0 || log.entries_[lines - 1].sha256 != stored["sha256"].get<std::string>())
        fail("{}:{}: is not the line that {} names: the log was written anew; take it from a backup",
             path.string(), std::max<std::size_t>(lines, 1), head.filename().string());
    // A crash may come between a line and its head, which then is one line behind.
    if (lines + 1 < log.entries_.size())
        fail("{}:{}: lines were put in after the last one that {} knows; take both from a backup",
             path.string(), lines + 1, head.filename().string());
    if (lines + 1 == log.entries_.size())
        log.warnings_.push_back(fmt::format(
            "{}:{}: is not in {} yet: a crash came between, or somebody put the line in; the next step "
            "takes it as it is",
            path.string(), lines + 1, head.filename().string()));
    return log;
}

LogHold::LogHold(const fs::path& log) : file_(::open(log.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ < 0) fail("{}: cannot be read: {}", log.string(), std::strerror(errno));
    // A file system without locks is no reason to do nothing: then append() finds what another one wrote.
    while (::flock(file_, LOCK_EX) != 0 && errno == EINTR) {
    }
}

LogHold::~LogHold() { ::close(file_); }

// Its length tells lines that were added, the chain one that was edited.
void TreatmentLog::require_unchanged() const {
    const std::string text = read_text_file(path_);
    std::vector<LogFault> faults;
    bool torn = false;
    const std::vector<LogEntry> now = chained_entries(text, faults, torn);
    if (text.size() != seen_bytes_ || !faults.empty() || now.empty() || now.back().sha256 != head())
        fail(
            "{}: was changed by another program since it was read; nothing was done: read it again (run the "
            "command, or open the treatment, anew)",
            path_.string());
}

const LogEntry& TreatmentLog::append(json content) { return append(std::move(content), LogHold(path_)); }

const LogEntry& TreatmentLog::append(json content, const LogHold& /*held*/,
                                     const std::function<void()>& last) {
    require_unchanged();
    content["previous"] = head();
    const Line line = sealed(content);
    {
        AppendFile file(path_, AppendFile::Open::existing);
        if (seen_bytes_ > whole_bytes_) file.cut(whole_bytes_);
        seen_bytes_ = whole_bytes_;
        file.append_synced(line.sealed + "\n");
        entries_.push_back({static_cast<int>(entries_.size()) + 1, std::move(content), line.sha256});
        try {
            if (last) last();
            write_head();
        } catch (...) {  // without its head the line is not written, and is taken back
            if (!has_head()) {
                entries_.pop_back();
                file.cut(whole_bytes_);
                throw;
            }
        }
    }
    seen_bytes_ = whole_bytes_ += line.sealed.size() + 1;
    return entries_.back();
}

// Whether the head that is on the disk is that of the last line.
bool TreatmentLog::has_head() const {
    try {
        const json stored = json_or_discarded(read_text_file(head_path(path_)));
        return stored.is_object() && stored.value("sha256", json()) == head();
    } catch (const Error&) {
        return false;
    }
}

void TreatmentLog::complete_head(const LogHold& /*held*/) const {
    if (!has_head()) write_head();
}

void TreatmentLog::remove_torn_line(const LogHold& /*held*/) {
    if (seen_bytes_ == whole_bytes_) return;
    AppendFile(path_, AppendFile::Open::existing).cut(whole_bytes_);
    seen_bytes_ = whole_bytes_;
}

bool TreatmentLog::is_as_long_as_known() const {
    std::error_code unknown;
    return fs::file_size(path_, unknown) == whole_bytes_ && !unknown;
}

void TreatmentLog::write_head() const {
    const json head = {{"lines", entries_.size()}, {"sha256", this->head()}};
    write_text_file(head_path(path_), json_line(head) + "\n");
}

}  // namespace tangi
