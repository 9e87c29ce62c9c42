#include "surface/file/scratch_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "surface/base/loop_pieces.h"
#include "surface/file/anonymous_temp_file.h"

namespace tangi {

namespace {

// How often pages are counted. Between two counts a processor that reads 10 GB/s adds 10 MB.
constexpr auto kBetween = std::chrono::milliseconds(1);

// [bytes] Taken out of memory at a time, before pages are counted again: all at once takes a tenth of a
// second, in which as many come in.
constexpr std::size_t kPiece = std::size_t(64) << 20;

// [bytes] Pages of files that this process has in memory (proc(5), statm). Asked a thousand times a second,
// by the process that opens it: what is forked later would be told of its parent.
std::size_t resident_of_files() {
    static const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    char words[128];
    const ssize_t length = ::pread(file, words, sizeof words - 1, 0);
    if (length <= 0) return 0;
    words[length] = 0;
    std::size_t all = 0, resident = 0, shared = 0;
    std::sscanf(words, "%zu %zu %zu", &all, &resident, &shared);
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
    // Of threads that touch pages: another one may wait for a processor while these fill the memory.
    void keep_small_now() {
        using std::chrono::steady_clock;
        const auto now = steady_clock::now().time_since_epoch().count();
        const auto before = counted_.load(std::memory_order_relaxed);
        if (now - before < steady_clock::duration(kBetween).count()) return;
        counted_.store(now, std::memory_order_relaxed);
        const std::lock_guard lock(mutex_);
        make_room();
    }
    void add(void* data, std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        for (std::size_t at = 0; at < bytes; at += kPiece)
            pieces_.emplace(static_cast<std::byte*>(data) + at, std::min(kPiece, bytes - at));
        bytes_ += bytes;
        changed_.notify_one();
    }
    void remove(void* data, std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        std::byte* const begin = static_cast<std::byte*>(data);
        pieces_.erase(pieces_.lower_bound(begin), pieces_.lower_bound(begin + bytes));
        bytes_ -= bytes;
    }

private:
    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

    // For what is no loop of parallel_for().
    void keep_small() {
        std::unique_lock lock(mutex_);
        while (true) {
            changed_.wait(lock, [this] { return !pieces_.empty() && limit_ != kNone; });
            make_room();
            lock.unlock();
            std::this_thread::sleep_for(kBetween);
            lock.lock();
        }
    }

    void make_room() {
        for (std::size_t dropped = 0; dropped < bytes_ && resident_of_files() > limit_;)
            dropped += drop_piece();
    }

    // The piece after that which was dropped last, round and round; its size. Its pages are taken out of the
    // process, not lost: they stay with their file.
    std::size_t drop_piece() {
        auto next = pieces_.upper_bound(dropped_last_);
        if (next == pieces_.end()) next = pieces_.begin();
        ::madvise(next->first, next->second, MADV_DONTNEED);
        dropped_last_ = next->first;
        return next->second;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::byte*, std::size_t> pieces_;  // of mappings: their sizes
    std::size_t bytes_ = 0;                     // of all
    std::byte* dropped_last_ = nullptr;
    std::atomic<std::chrono::steady_clock::rep> counted_ = 0;  // when a thread of a loop last did
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

void limit_scratch_pages(std::size_t bytes) {
    mappings().limit(bytes);
    set_between_pieces([] { mappings().keep_small_now(); });
}

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
    if (on_disk_) mappings().remove(data_, bytes_);
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
