#include "surface/stale_temporaries.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <map>
#include <mutex>
#include <string_view>
#include <vector>

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr auto kUntouched = std::chrono::minutes(10), kEmpty = std::chrono::minutes(24 * 60);

// Process numbers that are alike on two machines, or in two containers, are not of one process.
const std::string& this_machine() {
    static const std::string machine = [] {
        std::array<char, 256> host{};
        ::gethostname(host.data(), host.size() - 1);
        struct stat processes {};
        ::stat("/proc/self/ns/pid", &processes);
        std::uint32_t hash = 2166136261u;  // FNV-1a
        for (const char c : fmt::format("{} {}", host.data(), processes.st_ino))
            hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
        return fmt::format("{:08x}", hash);
    }();
    return machine;
}

struct Owner {
    long process = 0;  // 0: the name is not that of a temporary file
    bool is_here = false;
};

Owner owner_in(std::string_view name, const std::string& before, const std::string& after) {
    if (!name.starts_with(before)) return {};
    name.remove_prefix(before.size());
    const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
    if (digits == 0 || digits > 9) return {};
    Owner owner{std::stol(std::string(name.substr(0, digits)))};
    name.remove_prefix(digits);
    if (name.starts_with('-')) {  // not in names that earlier versions gave
        owner.is_here = name.substr(1).starts_with(this_machine());
        name.remove_prefix(std::min(this_machine().size() + 1, name.size()));
    }
    return name.starts_with(after) ? owner : Owner();
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

bool is_stale(const fs::directory_entry& entry, const Owner& owner) {
    const auto process = static_cast<pid_t>(owner.process);
    if (process == ::getpid() || ::kill(process, 0) == 0 || errno != ESRCH) return false;
    if (owner.is_here) return true;
    std::error_code gone;
    const auto age = fs::file_time_type::clock::now() - entry.last_write_time(gone);
    if (gone) return false;
    return age > (fs::is_empty(entry.path(), gone) ? kEmpty : kUntouched);
}

}  // namespace

std::string temporary_name(const std::string& stem, const std::string& extension) {
    return fmt::format(".{}.{}-{}.tmp{}", stem, ::getpid(), this_machine(), extension);
}

void remove_stale_temporaries(const fs::path& target, const std::string& stem, const std::string& extension) {
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    const std::string before = "." + stem + ".", after = ".tmp" + extension;
    for (const fs::directory_entry& entry : hidden_in(folder)) {
        const Owner owner = owner_in(entry.path().filename().string(), before, after);
        std::error_code ignored;
        if (owner.process > 0 && entry.exists(ignored) && is_stale(entry, owner))
            fs::remove_all(entry.path(), ignored);
    }
}

}  // namespace tangi
