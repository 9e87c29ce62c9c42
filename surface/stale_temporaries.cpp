#include "surface/stale_temporaries.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <mutex>
#include <string_view>
#include <vector>

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr auto kUntouched = std::chrono::minutes(10), kEmpty = std::chrono::minutes(24 * 60);

// The process in the name of a temporary file; 0 where it is none.
long process_in(std::string_view name, const std::string& before, const std::string& after) {
    if (!name.starts_with(before)) return 0;
    name.remove_prefix(before.size());
    const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
    if (digits == 0 || digits > 9 || !name.substr(digits).starts_with(after)) return 0;
    return std::stol(std::string(name.substr(0, digits)));
}

// Looked at once: what other programs leave from then on is the next one's, and a folder that thousands of
// files are written to is not listed thousands of times.
const std::vector<fs::directory_entry>& hidden_in(const fs::path& folder) {
    static std::mutex mutex;
    static std::map<std::string, std::vector<fs::directory_entry>> known;
    const std::lock_guard lock(mutex);
    const auto [found, is_new] = known.try_emplace(folder.string());
    std::error_code ignored;
    if (is_new)
        for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
             entry.increment(ignored))
            if (entry->path().filename().string().find(".tmp") != std::string::npos)
                found->second.push_back(*entry);
    return found->second;
}

bool is_stale(const fs::directory_entry& entry, long process) {
    if (process == ::getpid() || ::kill(static_cast<pid_t>(process), 0) == 0 || errno != ESRCH) return false;
    std::error_code gone;
    const auto age = fs::file_time_type::clock::now() - entry.last_write_time(gone);
    if (gone) return false;
    return age > (fs::is_empty(entry.path(), gone) ? kEmpty : kUntouched);
}

}  // namespace

std::string temporary_name(const std::string& stem, const std::string& extension) {
    return fmt::format(".{}.{}.tmp{}", stem, ::getpid(), extension);
}

void remove_stale_temporaries(const fs::path& target, const std::string& stem, const std::string& extension) {
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    const std::string before = "." + stem + ".", after = ".tmp" + extension;
    for (const fs::directory_entry& entry : hidden_in(folder)) {
        const long process = process_in(entry.path().filename().string(), before, after);
        std::error_code ignored;
        if (process > 0 && entry.exists(ignored) && is_stale(entry, process))
            fs::remove_all(entry.path(), ignored);
    }
}

}  // namespace tangi
