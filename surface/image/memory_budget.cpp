#include "surface/image/memory_budget.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>

#include "surface/base/error.h"
#include "surface/file/scratch_memory.h"
#include "surface/image/image.h"
#include "surface/image/image_memory.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// The number that a file begins with; nothing where it says "max", or is not there.
std::optional<double> number_in_file(const fs::path& path) {
    std::ifstream file(path);
    double number = 0;
    return file >> number ? std::optional(number) : std::nullopt;
}

// The number behind a word at the beginning of a line.
double number_behind(const fs::path& path, std::string_view word) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(word)) {
            std::istringstream rest(line.substr(word.size()));
            double number = 0;
            return rest >> number ? number : 0;
        }
    return 0;
}

// What the system can give without ending processes (proc(5)).
double left_of_system(const fs::path& proc) {
    constexpr double kib = 1024;
    const double available = number_behind(proc / "meminfo", "MemAvailable:");
    return available > 0 ? kib * (available + number_behind(proc / "meminfo", "SwapFree:")) : kNoLimit;
}

// Where one version keeps its numbers, by what names.
struct CgroupFiles {
    const char *limit, *used, *given_back;
};
constexpr CgroupFiles kSecond = {"memory.max", "memory.current", "inactive_file "};
constexpr CgroupFiles kFirst = {"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "};

// The least of a group and those that it is in. Pages of files that nobody used of late count as used, and
// are given back first (cgroups(7), Documentation/admin-guide/cgroup-v2.rst).
double left_of_groups(const fs::path& root, const fs::path& group, const CgroupFiles& files) {
    double left = kNoLimit;
    for (fs::path at = group.relative_path();; at = at.parent_path()) {
        const fs::path folder = root / at;
        const auto limit = number_in_file(folder / files.limit), used = number_in_file(folder / files.used);
        if (limit && used)
            left = std::min(left, *limit - *used + number_behind(folder / "memory.stat", files.given_back));
        if (at.empty()) return left;
    }
}

double left_of_cgroups(const fs::path& root) {
    std::ifstream file(root / "proc/self/cgroup");
    const fs::path groups = root / "sys/fs/cgroup";
    double left = kNoLimit;
    for (std::string line; std::getline(file, line);) {  // "number:controllers:/path"
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        if (controllers == ",,")
            left = std::min(left, left_of_groups(groups, line.substr(second + 1), kSecond));
        if (controllers.find(",memory,") != std::string::npos)
            left = std::min(left, left_of_groups(groups / "memory", line.substr(second + 1), kFirst));
    }
    return left;
}

// What setrlimit(2) leaves beside what is mapped (proc(5), statm: all, and data with stack, in pages).
double left_of_limits(const fs::path& proc) {
    std::ifstream file(proc / "self/statm");
    double all = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
    file >> all >> resident >> shared >> text >> library >> data;
    const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
    const auto left = [](auto resource, double used) {
        rlimit limit{};
        if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNoLimit;
        return std::max(static_cast<double>(limit.rlim_cur) - used, 0.0);
    };
    return std::min(left(RLIMIT_AS, all * page), left(RLIMIT_DATA, data * page));
}

}  // namespace

double memory_left(const fs::path& root) {
    const double left = std::min(left_of_system(root / "proc"), left_of_limits(root / "proc"));
    return std::max(std::min(left, left_of_cgroups(root)), 0.0);
}

namespace {

constexpr double kWorthAsking = 64.0 * 1024 * 1024;  // looking takes as long as unpacking some megabytes

void require_left(const fs::path& path, double bytes, double left, std::string_view what) {
    if (bytes <= left) return;
    fail(
        "{}: {} takes {:.1f} GB of memory, and {:.1f} GB are left; reduce it, or cut it in parts, or give "
        "the program more (ulimit -v, or the limit of a container)",
        path.string(), what, bytes / 1e9, left / 1e9);
}

}  // namespace

void require_memory(const fs::path& path, double bytes, std::string_view what) {
    if (bytes > kWorthAsking) require_left(path, bytes, memory_left(), what);
}

namespace {

std::mutex claims_mutex;
double all_claims = 0;  // [bytes]

}  // namespace

MemoryClaim::MemoryClaim(const fs::path& path, double bytes, std::string_view what) {
    const std::lock_guard lock(claims_mutex);
    require_memory(
        path, all_claims + bytes,
        all_claims > 0 ? fmt::format("{}, and of the other files that are open,", what) : std::string(what));
    all_claims += bytes;
    bytes_ = bytes;
}

void MemoryClaim::give_back() {
    if (bytes_ == 0) return;
    const std::lock_guard lock(claims_mutex);
    all_claims -= std::exchange(bytes_, 0);
}

void require_memory_of_surface(const fs::path& path, int width, int height, double beside,
                               std::string_view what) {
    constexpr double maps = sizeof(Vec3) + sizeof(Rgb) + 4 * sizeof(float);  // surface.h
    const double bytes = (maps + beside) * width * height;
    const std::string all = fmt::format("{} of {} x {} pixels", what, width, height);
    if (!images_go_to_disk(bytes)) return require_memory(path, bytes, all);
    require_left(path, bytes, left_of_limits("/proc"), all);  // what is on disk takes addresses, too
    const std::string folder = folder_for_scratch_memory();
    std::error_code unknown;
    const fs::space_info room = fs::space(folder, unknown);
    if (!unknown && static_cast<double>(room.available) < bytes)
        fail(
            "{}: {} takes {:.1f} GB on disk in {}, and {:.1f} GB are left; set TMPDIR to a folder with more "
            "room",
            path.string(), all, bytes / 1e9, folder, static_cast<double>(room.available) / 1e9);
}

}  // namespace tangi
