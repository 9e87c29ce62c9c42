#include "surface/file/stale_temporaries.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
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

constexpr std::size_t kMachineDigits = 8;

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

// Where a temporary name of today's form ends its stem, and where ".tmp" after it does.
struct TemporaryName {
    std::size_t stem_end = 0, end = 0;  // end 0: it is not one
    long process = 0;
    bool is_here = false;
};

TemporaryName parsed(std::string_view name, std::size_t from = 0) {
    constexpr std::string_view kEnd = ".tmp", kHex = "0123456789abcdef";
    for (std::size_t at = name.find(kEnd, from); at != std::string_view::npos; at = name.find(kEnd, at + 1)) {
        if (at < kMachineDigits + 4 || name[at - kMachineDigits - 1] != '-') continue;
        const std::string_view machine = name.substr(at - kMachineDigits, kMachineDigits);
        if (machine.find_first_not_of(kHex) != std::string_view::npos) continue;
        const std::size_t dash = at - kMachineDigits - 1,
                          dot = name.substr(0, dash).find_last_not_of("0123456789");
        if (dot == std::string_view::npos || dot == 0 || name[dot] != '.') continue;
        const std::size_t digits = dash - dot - 1;
        if (digits == 0 || digits > 9) continue;
        return {dot, at + kEnd.size(), std::stol(std::string(name.substr(dot + 1, digits))),
                machine == this_machine()};
    }
    return {};
}

// A process that ended and that nobody has asked about yet has its number still.
bool is_zombie(long process) {
    std::ifstream status(fmt::format("/proc/{}/stat", process));
    const std::string text{std::istreambuf_iterator<char>(status), {}};
    const std::size_t name_end = text.rfind(") ");
    return name_end != std::string::npos && text.substr(name_end + 2, 1) == "Z";
}

bool is_over(long process) {
    const auto number = static_cast<pid_t>(process);
    if (number == ::getpid()) return false;
    return ::kill(number, 0) == 0 ? is_zombie(process) : errno == ESRCH;
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
    if (!is_over(owner.process)) return false;
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

void sweep_temporaries(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<std::string> swept;
    {
        const std::lock_guard lock(mutex);
        if (!swept.insert(folder.string()).second) return;
    }
    for (const fs::directory_entry& entry : hidden_in(folder)) {
        const std::string name = entry.path().filename().string();
        const TemporaryName temporary = parsed(name);
        std::error_code ignored;
        if (name.starts_with('.') && temporary.is_here && is_over(temporary.process))
            fs::remove_all(entry.path(), ignored);
    }
}

std::string in_lasting_names(std::string message) {
    std::size_t from = 0;
    while (true) {
        const TemporaryName found = parsed(message, from);
        if (found.end == 0) return message;
        // The name begins with a dot, behind a slash or where a word does.
        std::size_t begin = found.stem_end;
        while (begin > 0 && message[begin - 1] != '/') --begin;
        if (begin == 0 || message[begin] != '.') {
            from = found.end;
            continue;
        }
        const std::string stem = message.substr(begin + 1, found.stem_end - begin - 1);
        if (stem == kWithinFolder) {  // what is in it will be in the folder that it is in
            message.erase(begin - 1, found.end - begin + 1);
            from = begin - 1;
        } else {
            message.replace(begin, found.end - begin, stem);
            from = begin + stem.size();
        }
    }
}

}  // namespace tangi
