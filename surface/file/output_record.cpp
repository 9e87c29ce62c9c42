#include "surface/file/output_record.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kRecordMagic = "tangipaint outputs 1", kRecordStem = ".outputs.",
                           kRecordEnd = ".commit";

// In a folder that is to take another's place, and in that place until the set is there: exchanging them
// again would bring the old one back.
constexpr const char* kNewFolder = ".tangipaint-new";

[[noreturn]] void cannot_be_placed(const fs::path& to) {
    fail("{}: cannot be put in place: {}", to.string(), std::strerror(errno));
}

bool is_there(const fs::path& path) {
    struct stat status = {};
    return ::lstat(path.c_str(), &status) == 0;
}

bool is_folder(const fs::path& path) {
    struct stat status = {};
    return ::lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
}

// A record in a stranger's folder may name links that lie there, too.
bool leads_out(const fs::path& folder, const fs::path& path) {
    std::error_code unknown;
    const fs::path root = fs::weakly_canonical(folder, unknown),
                   place = fs::weakly_canonical((folder / path).parent_path(), unknown);
    return unknown || std::mismatch(root.begin(), root.end(), place.begin(), place.end()).first != root.end();
}

void rename_to(const fs::path& from, const fs::path& to, const fs::path& named) {
    if (::rename(from.c_str(), to.c_str()) != 0) cannot_be_placed(named);
}

// A record that somebody else wrote may name what it likes: it moves nothing beyond its folder, and only what
// has a temporary name.
bool stays_within(const fs::path& path) {
    return !path.empty() && path.is_relative() &&
           std::none_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

bool is_temporary(const fs::path& path) {
    return stays_within(path) && std::any_of(path.begin(), path.end(), [](const fs::path& part) {
               const std::string name = part.string();
               return name.starts_with('.') && in_lasting_names("/" + name) != "/" + name;
           });
}

}  // namespace

fs::path OutputMove::aside() const { return from.string() + ".old"; }

void OutputMove::prepare(const fs::path& folder) const {
    if (kind == Kind::withdraw) return;
    if (!is_folder(folder / from)) {
        // A second name keeps what was there. A file system without such names puts in place all the same.
        (void)::link((folder / to).c_str(), (folder / aside()).c_str());
    } else if (is_there(folder / to)) {
        const int mark = ::open((folder / from / kNewFolder).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        if (mark < 0) cannot_be_placed(folder / to);
        ::close(mark);
    }
}

void OutputMove::forward(const fs::path& folder) const {
    const fs::path there = folder / to, temporary = folder / from;
    if (kind == Kind::withdraw) {
        if (is_there(there)) rename_to(there, temporary, there);
        return;
    }
    if (is_folder(temporary) && is_folder(there) && is_there(temporary / kNewFolder)) {
        if (!exchange_folders(temporary, there)) cannot_be_placed(there);
    } else if (is_there(temporary) && (!is_folder(temporary) || !is_there(there / kNewFolder))) {
        rename_to(temporary, there, there);
    }
}

void OutputMove::back(const fs::path& folder) const {
    const fs::path there = folder / to, temporary = folder / from, before = folder / aside();
    if (kind == Kind::withdraw) {
        if (is_there(temporary)) rename_to(temporary, there, there);
    } else if (is_there(there / kNewFolder)) {
        if (!exchange_folders(temporary, there)) cannot_be_placed(there);
    } else if (!is_there(temporary)) {
        rename_to(there, temporary, there);
        if (is_there(before)) rename_to(before, there, there);
    }
}

void OutputMove::clean(const fs::path& folder) const noexcept {
    std::error_code ignored;
    fs::remove_all(folder / *from.begin(), ignored);  // what was replaced or withdrawn, or a hidden folder
    fs::remove(folder / aside(), ignored);
    if (kind == Kind::withdraw && to.has_parent_path())
        fs::remove(folder / to.parent_path(), ignored);  // only where it is empty
    if (kind == Kind::put && is_folder(folder / to)) fs::remove(folder / to / kNewFolder, ignored);
}

std::string OutputRecord::text() const {
    std::string text;
    const auto add = [&](std::string_view field) { text.append(field).push_back('\0'); };
    add(kRecordMagic);
    for (const OutputMove& move : moves) {
        add(move.kind == OutputMove::Kind::put ? "put" : "withdraw");
        add(move.from.string()), add(move.to.string());
    }
    if (first) add("first"), add(first->string());
    for (const fs::path& folder : elsewhere) add("elsewhere"), add(folder.string());
    add("end");
    return text;
}

bool is_record_name(const std::string& name) {
    return name.starts_with(kRecordStem) && name.ends_with(kRecordEnd);
}

std::string new_record_name() {
    static std::atomic<int> sets = 0;
    const std::string name = temporary_name("outputs", "");
    return name.substr(0, name.size() - std::string_view(".tmp").size()) +
           fmt::format("-{}{}", ++sets, kRecordEnd);
}

bool OutputRecord::stays_within(const fs::path& folder) const {
    return std::none_of(moves.begin(), moves.end(), [&](const OutputMove& move) {
        return leads_out(folder, move.from) || leads_out(folder, move.to);
    });
}

std::optional<OutputRecord> record_in(const std::string& text) {
    std::vector<std::string> fields;
    for (std::size_t from = 0, end; (end = text.find('\0', from)) != std::string::npos; from = end + 1)
        fields.push_back(text.substr(from, end - from));
    if (fields.size() < 2 || fields.front() != kRecordMagic || fields.back() != "end") return {};
    OutputRecord record;
    for (std::size_t i = 1; i + 1 < fields.size();) {
        const std::string& what = fields[i++];
        const bool moves = what == "put" || what == "withdraw";
        if (i + (moves ? 2 : 1) >= fields.size()) return {};
        if (moves) {
            record.moves.push_back({what == "put" ? OutputMove::Kind::put : OutputMove::Kind::withdraw,
                                    fields[i], fields[i + 1]});
            if (!is_temporary(record.moves.back().from) || !stays_within(record.moves.back().to)) return {};
            i += 2;
        } else if (what == "first") {
            record.first = fields[i++];
        } else if (what == "elsewhere") {
            record.elsewhere.emplace_back(fields[i++]);
        } else {
            return {};
        }
    }
    return record;
}

RecordFile::RecordFile(fs::path path, const OutputRecord& record, fs::path named)
    : path_(std::move(path)), named_(std::move(named)) {
    temporary_ = path_.parent_path() / temporary_name(path_.filename().string(), "");
    file_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) cannot_be_placed(named_);
    (void)::flock(file_, LOCK_EX);  // a file system without locks is no reason to write nothing
    std::string text = record.text();
    for (std::string_view left = text; !left.empty();) {
        const ssize_t count = ::write(file_, left.data(), left.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            const int reason = errno;
            ::close(file_);
            ::unlink(temporary_.c_str());
            errno = reason;
            cannot_be_placed(named_);
        }
        left.remove_prefix(static_cast<std::size_t>(count));
    }
    if (::fsync(file_) == 0) return;
    const int reason = errno;
    ::close(file_);
    ::unlink(temporary_.c_str());
    errno = reason;
    cannot_be_placed(named_);
}

RecordFile::RecordFile(fs::path path) : path_(std::move(path)), named_(path_) {
    file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
    if (file_ < 0) return;
    while (::flock(file_, LOCK_EX) != 0 && errno == EINTR) {
    }
    struct stat held = {}, there = {};
    placed_ = ::fstat(file_, &held) == 0 && ::stat(path_.c_str(), &there) == 0 &&
              held.st_ino == there.st_ino && held.st_dev == there.st_dev;
}

RecordFile::~RecordFile() {
    if (!temporary_.empty() && !placed_) ::unlink(temporary_.c_str());
    if (file_ >= 0) ::close(file_);
}

void RecordFile::place() {
    rename_to(temporary_, path_, named_);
    placed_ = true;
    sync_folder(path_.parent_path(), named_);
}

void RecordFile::remove() noexcept { ::unlink(path_.c_str()); }

}  // namespace tangi
