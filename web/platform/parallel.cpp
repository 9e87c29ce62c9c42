// parallel.cpp: loops of the web engine, on the one thread of its worker. surface/base/parallel.h has no
// results that depend on the number of threads.
#include "surface/base/parallel.h"

namespace tangi {

void set_thread_count(int) {}
int thread_count() { return 1; }

void parallel_for(int begin, int end, int, const std::function<void(int, int)>& body) {
    if (begin < end) body(begin, end);
}

}  // namespace tangi
