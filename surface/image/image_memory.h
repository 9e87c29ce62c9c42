// image_memory.h: where the pixels of images are: in memory, or, of more than is to be held there, on disk,
// with those in memory that were used last. So what goes over an image row by row takes no more memory of a
// large one.
#pragma once

#include <cstddef>
#include <limits>
#include <new>

namespace tangi {

// [bytes] What large images (from 16 MiB on) may hold in memory, all together, from now on; half of it is of
// those that are made first and stay there, half of pages that come and go (scratch_memory.h: files without a
// name in $TMPDIR, or /var/tmp), those of other scratch memory among them. Without a limit at first. Where
// the disk has not the room, memory is taken all the same.
constexpr std::size_t kNoImageLimit = std::numeric_limits<std::size_t>::max();
void limit_image_memory(std::size_t bytes);

// Whether images of so many bytes, made now, would be on disk.
bool images_go_to_disk(double bytes);

// Any number of threads. Throws std::bad_alloc.
void* take_image_memory(std::size_t bytes);
void give_image_memory(void* data, std::size_t bytes) noexcept;

// Of the pixels of Image.
template <class T>
struct ImageAllocator {
    using value_type = T;
    ImageAllocator() = default;
    template <class U>
    ImageAllocator(const ImageAllocator<U>&) {}
    T* allocate(std::size_t count) {
        if (count > kNoImageLimit / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(take_image_memory(count * sizeof(T)));
    }
    void deallocate(T* data, std::size_t count) noexcept { give_image_memory(data, count * sizeof(T)); }
    friend bool operator==(const ImageAllocator&, const ImageAllocator&) { return true; }
};

}  // namespace tangi
