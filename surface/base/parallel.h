// parallel.h: loops over rows and items on all cores, whose results never depend on the number of threads.
#pragma once

#include <functional>

namespace tangi {

// Threads that parallel loops may use from now on; 0 = as many as the machine has.
void set_thread_count(int threads);
int thread_count();

// Calls body(begin, end) over disjoint ranges that cover [begin, end), on all threads. Half of `grain` items
// at least go to one call, where there are as many. An exception in a body ends the loop and comes out here.
void parallel_for(int begin, int end, int grain, const std::function<void(int begin, int end)>& body);

}  // namespace tangi
