// memory_check.cpp: says that there is too little memory before libraries are made ready, of which some end
// the program without a word where there is none (OpenImageIO, log4cplus).
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <string_view>

namespace {

// [bytes] Of address space, beyond what the loader maps. Measured on two cores, by lowering the limit until
// it fails: libraries take 62 MB until main(), and the smallest work of any command, with its threads, 105
// MB.
constexpr std::size_t kToBegin = std::size_t{128} << 20;

void require_memory_to_begin(int /*argc*/, char** /*argv*/, char** /*environment*/) {
    void* const room =
        ::mmap(nullptr, kToBegin, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room != MAP_FAILED) {
        ::munmap(room, kToBegin);
        return;
    }
    constexpr std::string_view words =
        "tangipaint: not enough memory to begin; give it more (ulimit -v, or the limit of a container)\n";
    (void)!::write(STDERR_FILENO, words.data(), words.size());
    ::_exit(1);
}

}  // namespace

// Called by the loader before anything else of the program and its libraries (System V ABI, gABI chapter 5).
// The sanitizers reserve memory there themselves, and come after it.
#ifndef __SANITIZE_ADDRESS__
[[gnu::section(".preinit_array"), gnu::used]] static void (*const kBefore)(int, char**,
                                                                           char**) = require_memory_to_begin;
#endif
