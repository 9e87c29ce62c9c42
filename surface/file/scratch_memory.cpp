#include "surface/file/scratch_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "surface/file/anonymous_temp_file.h"

namespace tangi {

namespace {

// How often pages are counted. Between two counts a processor that writes 4 GB/s adds 80 MB.
constexpr auto kBetween = std::chrono::milliseconds(20);

// [bytes] Pages of files that this process has in memory (proc(5), statm).
std::size_t resident_of_files() {
    std::ifstream file("/proc/self/statm");
    std::size_t all = 0, resident = 0, shared = 0;
    file >> all >> resident >> shared;
    return shared * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

// Those of all scratch memory that is on disk.
class Mappings {
public:
    void limit(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        limit_ = bytes;
        if (limit_ != kNone && !std::exchange(watched_, true)) std::thread([this] { keep_small(); }).detach();
        changed_.notify_one();
    }
    void add(void* data, std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        all_.emplace(data, bytes);
        changed_.notify_one();
    }
    void remove(void* data) {
        const std::lock_guard lock(mutex_);
        all_.erase(data);
    }

private:
    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

    // Pages are dropped from the process, not lost: they stay with their file.
    void keep_small() {
        std::unique_lock lock(mutex_);
        while (true) {
            changed_.wait(lock, [this] { return !all_.empty() && limit_ != kNone; });
            if (resident_of_files() > limit_)
                for (const auto& [data, bytes] : all_) ::madvise(data, bytes, MADV_DONTNEED);
            lock.unlock();
            std::this_thread::sleep_for(kBetween);
            lock.lock();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<void*, std::size_t> all_;
    std::size_t limit_ = kNone;
    bool watched_ = false;
};

// Never destroyed: memory of static lifetime is given back after anything else.
Mappings& mappings() {
    static Mappings& all = *new Mappings;
    return all;
}

// Null where there is not the room: it is reserved now, since a page that finds none later ends the program.
void* on_disk(std::size_t bytes, const std::string& folder) {
    const int file = open_nameless_file(folder);
    if (file < 0) return nullptr;
    void* data = MAP_FAILED;
    if (::posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0)
        data = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);  // the mapping keeps it
    return data == MAP_FAILED ? nullptr : data;
}

}  // namespace

void limit_scratch_pages(std::size_t bytes) { mappings().limit(bytes); }

std::string folder_for_scratch_memory() {
    const char* given = std::getenv("TMPDIR");
    return given && *given ? given : "/var/tmp";
}

ScratchMemory::ScratchMemory(std::size_t bytes, std::size_t most_held, const std::string& folder)
    : bytes_(bytes) {
    if (bytes == 0) return;
    if (bytes > most_held)
        data_ = tangi::on_disk(bytes, folder.empty() ? folder_for_scratch_memory() : folder);
    on_disk_ = data_ != nullptr;
    if (on_disk_) mappings().add(data_, bytes_);
    if (on_disk_) return;
    data_ = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data_ != MAP_FAILED) return;
    data_ = nullptr;
    throw std::bad_alloc();
}

ScratchMemory::~ScratchMemory() {
    if (on_disk_) mappings().remove(data_);
    if (data_) ::munmap(data_, bytes_);
}

ScratchMemory::ScratchMemory(ScratchMemory&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      on_disk_(std::exchange(other.on_disk_, false)) {}

ScratchMemory& ScratchMemory::operator=(ScratchMemory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    std::swap(on_disk_, other.on_disk_);
    return *this;
}

}  // namespace tangi
