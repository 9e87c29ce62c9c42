#include "surface/base/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <new>
#include <stdexcept>

#include "surface/base/error.h"
#include "surface/base/loop_pieces.h"
#include "surface/base/memory_error.h"

namespace tangi {

namespace {

using oneapi::tbb::global_control;

std::unique_ptr<global_control>& limit() {
    static std::unique_ptr<global_control> control;
    return control;
}

std::atomic<void (*)()> between_pieces = nullptr;

void do_in_pieces(int begin, int end, int grain, const std::function<void(int, int)>& body) {
    if (!between_pieces.load()) return body(begin, end);
    const int pieces = std::max(1, (end - begin) / grain);
    const auto boundary = [&](int i) {
        return begin + static_cast<int>(static_cast<long>(end - begin) * i / pieces);
    };
    for (int i = 0; i < pieces; ++i) {
        body(boundary(i), boundary(i + 1));
        end_piece();
    }
}

}  // namespace

void set_thread_count(int threads) {
    limit().reset();
    if (threads > 0)
        limit() = std::make_unique<global_control>(global_control::max_allowed_parallelism,
                                                   static_cast<std::size_t>(threads));
}

int thread_count() {
    return static_cast<int>(global_control::active_value(global_control::max_allowed_parallelism));
}

void set_between_pieces(void (*between)()) { between_pieces = between; }

void end_piece() {
    if (const auto between = between_pieces.load()) between();
}

void parallel_for(int begin, int end, int grain, const std::function<void(int, int)>& body) {
    if (begin >= end) return;
    // A loop within another one's body is done as a whole, though an exception ends the other meanwhile: what
    // follows it in the body takes its results for there.
    oneapi::tbb::task_group_context context(oneapi::tbb::task_group_context::isolated);
    try {
        oneapi::tbb::parallel_for(
            oneapi::tbb::blocked_range<int>(begin, end, static_cast<std::size_t>(grain)),
            [&](const auto& range) { do_in_pieces(range.begin(), range.end(), grain, body); }, context);
    } catch (const std::runtime_error& error) {  // of TBB, where there is no memory for a thread
        if (!dynamic_cast<const Error*>(&error) && says_no_memory(error)) throw std::bad_alloc();
        throw;
    }
}

}  // namespace tangi
