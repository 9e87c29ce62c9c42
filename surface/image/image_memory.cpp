#include "surface/image/image_memory.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "surface/file/scratch_memory.h"

namespace tangi {

namespace {

// [bytes] Smaller ones are as many as there are bands, tiles and rows: none of them grows with the painting.
constexpr std::size_t kLarge = std::size_t(16) << 20;

// Never destroyed: images of static lifetime give their memory back after anything else.
class ImagePool {
public:
    void limit(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        limit_ = bytes;
        limit_scratch_pages(bytes == kNoImageLimit ? bytes : bytes / 2);
    }
    bool would_go_to_disk(double bytes) {
        const std::lock_guard lock(mutex_);
        return goes_to_disk(bytes);
    }
    void* take(std::size_t bytes);
    void give(void* data, std::size_t bytes);

private:
    bool goes_to_disk(double bytes) const {
        return limit_ != kNoImageLimit &&
               static_cast<double>(held_) + bytes > static_cast<double>(limit_ / 2);
    }

    std::mutex mutex_;
    std::size_t limit_ = kNoImageLimit;
    std::size_t held_ = 0;  // [bytes] of large images in memory
    std::map<void*, ScratchMemory> on_disk_;
};

void* ImagePool::take(std::size_t bytes) {
    std::unique_lock lock(mutex_);
    if (goes_to_disk(static_cast<double>(bytes))) {
        lock.unlock();  // room on disk takes a moment to get
        ScratchMemory memory(bytes, 0);
        lock.lock();
        void* const data = memory.data();
        on_disk_.emplace(data, std::move(memory));
        return data;
    }
    void* const data = ::operator new(bytes);
    held_ += bytes;
    return data;
}

void ImagePool::give(void* data, std::size_t bytes) {
    std::unique_lock lock(mutex_);
    if (auto found = on_disk_.extract(data)) {
        lock.unlock();
        return;  // unmapped here
    }
    held_ -= bytes;
    lock.unlock();
    ::operator delete(data);
}

ImagePool& pool() {
    static ImagePool& all = *new ImagePool;
    return all;
}

}  // namespace

void limit_image_memory(std::size_t bytes) { pool().limit(bytes); }

bool images_go_to_disk(double bytes) { return pool().would_go_to_disk(bytes); }

void* take_image_memory(std::size_t bytes) {
    return bytes < kLarge ? ::operator new(bytes) : pool().take(bytes);
}

void give_image_memory(void* data, std::size_t bytes) noexcept {
    if (bytes < kLarge)
        ::operator delete(data);
    else
        pool().give(data, bytes);
}

}  // namespace tangi
