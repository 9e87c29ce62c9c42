// parallel_test.cpp: loops that visit every item once, on any number of threads, and let exceptions
// out.
#include "surface/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "surface/base/progress.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Gives the thread count back to the machine whatever the test does.
struct Threads {
    explicit Threads(int count) { set_thread_count(count); }
    ~Threads() { set_thread_count(0); }
};

TEST(ParallelFor, VisitsEveryItemOnce) {
    for (const int threads : {1, 2, 5}) {
        const Threads limit(threads);
        for (const auto& [begin, end, grain] :
             {std::tuple{0, 1000, 1}, {0, 1000, 64}, {-7, 13, 3}, {5, 6, 100}}) {
            std::vector<std::atomic<int>> visits(static_cast<std::size_t>(end - begin));
            parallel_for(begin, end, grain, [&, first = begin, last = end](int b, int e) {
                EXPECT_LE(first, b);
                EXPECT_LT(b, e);
                EXPECT_LE(e, last);
                for (int i = b; i < e; ++i) ++visits[static_cast<std::size_t>(i - first)];
            });
            for (const auto& count : visits) EXPECT_EQ(count, 1);
        }
    }
}

TEST(ParallelFor, GivesNoCallLessThanHalfAGrain) {
    for (const int items : {17, 40, 1000}) {
        std::atomic<int> smallest = items;
        parallel_for(0, items, 16, [&](int b, int e) {
            int seen = smallest;
            while (e - b < seen && !smallest.compare_exchange_weak(seen, e - b)) {
            }
        });
        EXPECT_GE(smallest, 8) << items;
    }
}

TEST(ParallelFor, OverNothingCallsNothing) {
    parallel_for(3, 3, 1, [](int, int) { ADD_FAILURE(); });
    parallel_for(3, -3, 1, [](int, int) { ADD_FAILURE(); });
}

TEST(ParallelFor, LetsExceptionsOutWithTheirType) {
    EXPECT_EQ(error_of([] {
                  parallel_for(0, 100, 1, [](int b, int e) {
                      if (b <= 42 && 42 < e) fail("item {} is bad", 42);
                  });
              }),
              "item 42 is bad");
    EXPECT_THROW(parallel_for(0, 10, 1, [](int, int) { throw Cancelled(); }), Cancelled);
    // And goes on working afterwards.
    std::atomic<int> sum = 0;
    parallel_for(0, 10, 1, [&](int b, int e) { sum += e - b; });
    EXPECT_EQ(sum, 10);
}

TEST(ParallelFor, MayBeNested) {
    std::atomic<int> sum = 0;
    parallel_for(0, 20, 1, [&](int b, int e) {
        for (int i = b; i < e; ++i) parallel_for(0, 30, 1, [&](int c, int d) { sum += d - c; });
    });
    EXPECT_EQ(sum, 600);
}

// What follows it in the other's body takes its results for there.
TEST(ParallelFor, WithinAnotherThatAnExceptionEndsIsDoneAsAWhole) {
    std::atomic<int> cut_short = 0;
    const auto body = [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            std::atomic<int> done = 0;
            parallel_for(0, 100, 1, [&](int b, int e) {
                std::this_thread::sleep_for(std::chrono::microseconds(20 * (e - b)));
                done += e - b;
            });
            cut_short += done != 100;
            if (i % 3 == 2) throw Error("enough");
        }
    };
    for (int trial = 0; trial < 10; ++trial) EXPECT_THROW(parallel_for(0, 12, 1, body), Error);
    EXPECT_EQ(cut_short, 0);
}

TEST(ThreadCount, IsWhatWasSetAndGoesBack) {
    const int machine = thread_count();
    EXPECT_GE(machine, 1);
    {
        const Threads one(1);
        EXPECT_EQ(thread_count(), 1);
        set_thread_count(3);
        EXPECT_EQ(thread_count(), 3);
    }
    EXPECT_EQ(thread_count(), machine);
}

TEST(ThreadCount, OfOneRunsEverythingOnTheCaller) {
    const Threads one(1);
    const auto caller = std::this_thread::get_id();
    parallel_for(0, 100, 1, [&](int, int) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(Progress, ThatReturnsFalseCancels) {
    EXPECT_NO_THROW(report({}, "stage", 0.5));
    std::string told;
    const Progress listen = [&](std::string_view stage, double fraction) {
        told = fmt::format("{} {}", stage, fraction);
        return fraction < 1;
    };
    EXPECT_NO_THROW(report(listen, "fit", 0.25));
    EXPECT_EQ(told, "fit 0.25");
    EXPECT_THROW(report(listen, "fit", 1), Cancelled);
}

}  // namespace
}  // namespace tangi
