// fault_injector.cpp: a library to preload (LD_PRELOAD): a program's n-th call that changes a file fails, or
// the program is killed there; its n-th large allocation finds no memory; its clock stands still.
//
//   TP_FAULT_UNDER     only calls on files in this folder count (an absolute path without links)
//   TP_FAULT_AT        the call that fails, from 1; without it none does
//   TP_FAULT_ERRNO     with what (5, EIO, where not given); 0: the program is killed before the call
//   TP_FAULT_STAYS     1: so do all later ones that need room, as on a disk that stays full
//   TP_FAULT_TORN      1: where that call is a write, half of the bytes are written before it fails
//   TP_FAULT_READS     1: the calls that count are those that read (open for reading, read, and their kin);
//                      where one fails, so do all later ones of the same file
//   TP_FAULT_TRACE     file to which a line is added for each call that counts: what it does, and to what
//   TP_FAULT_MEMORY_AT the allocation of 64 KiB and more that fails, from 1, once libraries are ready; 0:
//                      none, but they are traced ("memory BYTES") instead of the calls
//   TP_FAULT_TIME      [s] since 1970, all the time
//
// All of this from main() on: what libraries do before is no concern of the program's. Counted are open for
// writing, write, fsync, rename, mkdir, unlink, ftruncate, and their kin. Nothing here allocates.
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include <atomic>

namespace {

std::atomic<long> calls{0}, allocations{0};
std::atomic<bool> program_has_begun{false};
constexpr size_t kLarge = 64 * 1024;  // [bytes] what libraries ask for in little is not what runs out

long number(const char* name, long otherwise) {
    const char* text = getenv(name);
    return text && *text ? atol(text) : otherwise;
}

template <class Function>
Function real(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool is_under(const char* path) {
    if (!program_has_begun) return false;
    static const char* const folder = getenv("TP_FAULT_UNDER");
    if (!folder || !path) return false;
    const size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == 0);
}

void trace(const char* kind, const char* path) {
    static const char* const file = getenv("TP_FAULT_TRACE");
    if (!file) return;
    const long to = syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    char line[PATH_MAX + 32];
    const int length = snprintf(line, sizeof line, "%s %s\n", kind, path);
    if (to < 0) return;
    (void)syscall(SYS_write, to, line, static_cast<size_t>(length));
    (void)syscall(SYS_close, to);
}

bool traces_memory() {
    static const bool is_given = getenv("TP_FAULT_MEMORY_AT") != nullptr;
    return is_given;
}

// What a write was to write, of which half gets there where it is torn; at -1: where the file is.
struct Bytes {
    int file = -1;
    const void* bytes = nullptr;
    size_t count = 0;
    off_t at = -1;
};

// A call that may fail.
struct Call {
    const char* kind;
    bool needs_room = false, reads = false;
    Bytes written{};
};

void tear(const Bytes& whole) {
    if (whole.file < 0) return;
    if (whole.at < 0)
        (void)syscall(SYS_write, whole.file, whole.bytes, whole.count / 2);
    else
        (void)syscall(SYS_pwrite64, whole.file, whole.bytes, whole.count / 2, whole.at);
}

// Where a file could not be read once, it cannot be read again: a bad sector stays.
bool is_of_failed(const char* path, bool fails_now) {
    static char failed[2 * PATH_MAX] = "";
    if (fails_now && strlen(path) < sizeof failed) strcpy(failed, path);
    return strcmp(failed, path) == 0;
}

// True where this call is to fail: errno is set.
bool fails(const Call& call, const char* path) {
    static const long at = number("TP_FAULT_AT", 0), with = number("TP_FAULT_ERRNO", EIO);
    static const bool stays = number("TP_FAULT_STAYS", 0) != 0, torn = number("TP_FAULT_TORN", 0) != 0,
                      reads = number("TP_FAULT_READS", 0) != 0;
    if (call.reads != reads) return false;
    const int before = errno;
    const long count = ++calls;
    if (!traces_memory()) trace(call.kind, path);
    errno = before;
    if (reads && at != 0 && is_of_failed(path, count == at)) {
        errno = static_cast<int>(with);
        return true;
    }
    if (at == 0 || count < at || (count > at && !(stays && call.needs_room))) return false;
    if (count == at && stays && !call.needs_room) return false;
    if (count == at && torn) tear(call.written);
    if (with == 0) {
        syscall(SYS_kill, getpid(), SIGKILL);
        pause();
    }
    errno = static_cast<int>(with);
    return true;
}

bool path_fails(const Call& call, int folder, const char* path) {
    char whole[2 * PATH_MAX];
    const int before = errno;
    if (path && path[0] != '/') {
        char base[PATH_MAX] = "";
        if (folder == AT_FDCWD) {
            if (syscall(SYS_getcwd, base, sizeof base) < 0) return false;
        } else {
            char link[64];
            snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
            const ssize_t length = readlink(link, base, sizeof base - 1);
            if (length < 0) return false;
            base[length] = 0;
        }
        snprintf(whole, sizeof whole, "%s/%s", base, path);
        path = whole;
    }
    errno = before;
    return is_under(path) && fails(call, path);
}

bool file_fails(const Call& call, int file) {
    char link[64], path[PATH_MAX];
    const int before = errno;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    errno = before;
    if (length < 0) return false;
    path[length] = 0;
    return is_under(path) && fails(call, path);
}

bool is_for_writing(int flags) {
    return (flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC)) != 0;
}

Call call_of_open(int flags) { return {"open", (flags & O_CREAT) != 0, !is_for_writing(flags)}; }

bool memory_fails(size_t bytes) {
    if (!program_has_begun || bytes < kLarge || !traces_memory()) return false;
    static const long at = number("TP_FAULT_MEMORY_AT", 0);
    if (at == 0) {
        char size[32];
        snprintf(size, sizeof size, "%zu", bytes);
        trace("memory", size);
    }
    if (++allocations != at) return false;
    errno = ENOMEM;
    return true;
}

long frozen_s() {
    if (!program_has_begun) return -1;
    static const long s = number("TP_FAULT_TIME", -1);
    return s;
}

using Main = int (*)(int, char**, char**);
Main main_of_program = nullptr;

int main_with_faults(int count, char** words, char** environment) {
    program_has_begun = true;
    return main_of_program(count, words, environment);
}

}  // namespace

// The names are those of the C library, and parameters of its functions take no further parentheses.
// NOLINTBEGIN(bugprone-reserved-identifier, bugprone-macro-parentheses)
extern "C" {

void* __libc_malloc(size_t bytes);
void* __libc_memalign(size_t alignment, size_t bytes);
void* __libc_calloc(size_t count, size_t bytes);
void* __libc_realloc(void* old, size_t bytes);

#define TP_OPEN(name)                                                                   \
    int name(const char* path, int flags, ...) {                                        \
        va_list more;                                                                   \
        va_start(more, flags);                                                          \
        const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0; \
        va_end(more);                                                                   \
        if (path_fails(call_of_open(flags), AT_FDCWD, path)) return -1;                 \
        static const auto next = real<int (*)(const char*, int, ...)>(#name);           \
        return next(path, flags, mode);                                                 \
    }
TP_OPEN(open)
TP_OPEN(open64)

#define TP_OPENAT(name)                                                                 \
    int name(int folder, const char* path, int flags, ...) {                            \
        va_list more;                                                                   \
        va_start(more, flags);                                                          \
        const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0; \
        va_end(more);                                                                   \
        if (path_fails(call_of_open(flags), folder, path)) return -1;                   \
        static const auto next = real<int (*)(int, const char*, int, ...)>(#name);      \
        return next(folder, path, flags, mode);                                         \
    }
TP_OPENAT(openat)
TP_OPENAT(openat64)

#define TP_FOPEN(name)                                                             \
    FILE* name(const char* path, const char* mode) {                               \
        const bool writes = strpbrk(mode, "wa+") != nullptr;                       \
        if (path_fails({"open", writes, !writes}, AT_FDCWD, path)) return nullptr; \
        static const auto next = real<FILE* (*)(const char*, const char*)>(#name); \
        return next(path, mode);                                                   \
    }
TP_FOPEN(fopen)
TP_FOPEN(fopen64)

#define TP_ON_FILE(call, result, failure, name, parameters, arguments, file) \
    result name parameters {                                                 \
        if (file_fails(call, file)) return failure;                          \
        static const auto next = real<result(*) parameters>(#name);          \
        return next arguments;                                               \
    }
#define TP_WRITE(...) (Call{"write", true, false, Bytes{__VA_ARGS__}})
TP_ON_FILE(TP_WRITE(f, b, n), ssize_t, -1, write, (int f, const void* b, size_t n), (f, b, n), f)
TP_ON_FILE(TP_WRITE(f, b, n, o), ssize_t, -1, pwrite, (int f, const void* b, size_t n, off_t o), (f, b, n, o),
           f)
TP_ON_FILE(TP_WRITE(f, b, n, o), ssize_t, -1, pwrite64, (int f, const void* b, size_t n, off64_t o),
           (f, b, n, o), f)
TP_ON_FILE(TP_WRITE(f, v->iov_base, v->iov_len), ssize_t, -1, writev, (int f, const iovec* v, int n),
           (f, v, n), f)
TP_ON_FILE(TP_WRITE(), int, EIO, posix_fallocate, (int f, off_t o, off_t n), (f, o, n), f)
TP_ON_FILE(TP_WRITE(fileno(f), b, s* n), size_t, 0, fwrite, (const void* b, size_t s, size_t n, FILE* f),
           (b, s, n, f), fileno(f))
TP_ON_FILE((Call{"fsync"}), int, -1, fsync, (int f), (f), f)
TP_ON_FILE((Call{"fsync"}), int, -1, fdatasync, (int f), (f), f)
TP_ON_FILE((Call{"ftruncate"}), int, -1, ftruncate, (int f, off_t n), (f, n), f)
TP_ON_FILE((Call{"ftruncate"}), int, -1, ftruncate64, (int f, off64_t n), (f, n), f)
#define TP_READ (Call{"read", false, true})
TP_ON_FILE(TP_READ, ssize_t, -1, read, (int f, void* b, size_t n), (f, b, n), f)
TP_ON_FILE(TP_READ, ssize_t, -1, readv, (int f, const iovec* v, int n), (f, v, n), f)
TP_ON_FILE(TP_READ, ssize_t, -1, pread, (int f, void* b, size_t n, off_t o), (f, b, n, o), f)
TP_ON_FILE(TP_READ, ssize_t, -1, pread64, (int f, void* b, size_t n, off64_t o), (f, b, n, o), f)
TP_ON_FILE(TP_READ, size_t, 0, fread, (void* b, size_t s, size_t n, FILE* f), (b, s, n, f), fileno(f))

DIR* opendir(const char* path) {
    if (path_fails({"open", false, true}, AT_FDCWD, path)) return nullptr;
    static const auto next = real<DIR* (*)(const char*)>("opendir");
    return next(path);
}

#define TP_ON_PATH(kind, room, name, parameters, arguments, folder, path) \
    int name parameters {                                                 \
        if (path_fails({kind, room}, folder, path)) return -1;            \
        static const auto next = real<int(*) parameters>(#name);          \
        return next arguments;                                            \
    }
TP_ON_PATH("rename", false, rename, (const char* a, const char* b), (a, b), AT_FDCWD, b)
TP_ON_PATH("rename", false, renameat, (int f, const char* a, int g, const char* b), (f, a, g, b), g, b)
TP_ON_PATH("rename", false, renameat2, (int f, const char* a, int g, const char* b, unsigned how),
           (f, a, g, b, how), g, b)
TP_ON_PATH("link", true, link, (const char* a, const char* b), (a, b), AT_FDCWD, b)
TP_ON_PATH("mkdir", true, mkdir, (const char* p, mode_t m), (p, m), AT_FDCWD, p)
TP_ON_PATH("mkdir", true, mkdirat, (int f, const char* p, mode_t m), (f, p, m), f, p)
TP_ON_PATH("unlink", false, unlink, (const char* p), (p), AT_FDCWD, p)
TP_ON_PATH("unlink", false, unlinkat, (int f, const char* p, int how), (f, p, how), f, p)
TP_ON_PATH("unlink", false, remove, (const char* p), (p), AT_FDCWD, p)
TP_ON_PATH("unlink", false, rmdir, (const char* p), (p), AT_FDCWD, p)

void* malloc(size_t bytes) { return memory_fails(bytes) ? nullptr : __libc_malloc(bytes); }
void* calloc(size_t count, size_t bytes) {
    return memory_fails(count * bytes) ? nullptr : __libc_calloc(count, bytes);
}
void* realloc(void* old, size_t bytes) { return memory_fails(bytes) ? nullptr : __libc_realloc(old, bytes); }
void* aligned_alloc(size_t alignment, size_t bytes) {
    return memory_fails(bytes) ? nullptr : __libc_memalign(alignment, bytes);
}
int posix_memalign(void** to, size_t alignment, size_t bytes) {
    if (memory_fails(bytes)) return ENOMEM;
    *to = __libc_memalign(alignment, bytes);
    return *to ? 0 : ENOMEM;
}

int __libc_start_main(Main main, int count, char** words, void (*begin)(), void (*end)(), void (*at_exit)(),
                      void* stack_end) {
    main_of_program = main;
    static const auto next = real<decltype(&__libc_start_main)>("__libc_start_main");
    return next(main_with_faults, count, words, begin, end, at_exit, stack_end);
}

time_t time(time_t* to) {
    timespec now{};
    if (frozen_s() < 0)
        syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
    else
        now.tv_sec = frozen_s();
    if (to) *to = now.tv_sec;
    return now.tv_sec;
}
int clock_gettime(clockid_t clock, timespec* to) {
    if (clock != CLOCK_REALTIME || frozen_s() < 0)
        return static_cast<int>(syscall(SYS_clock_gettime, clock, to));
    *to = {frozen_s(), 0};
    return 0;
}
int gettimeofday(timeval* to, void* zone) {
    if (frozen_s() < 0) return static_cast<int>(syscall(SYS_gettimeofday, to, zone));
    *to = {frozen_s(), 0};
    return 0;
}
}
// NOLINTEND(bugprone-reserved-identifier, bugprone-macro-parentheses)
