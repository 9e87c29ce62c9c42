// cpu_clock.h: time that this process had a processor for: what work takes where nothing else runs.
#pragma once

#include <time.h>

inline double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
