// first_opening_test.cpp: what is read beside the window comes out of it, or what went wrong, or it is
// stopped.
#include "viewer/app/first_opening.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(FirstOpening, GivesWhatWasOpened) {
    std::atomic<bool> go_on = false;
    std::vector<double> told;
    FirstOpening opening(
        [&](const Progress& progress) {
            report(progress, "read painting", 0.25);
            while (!go_on) std::this_thread::yield();
            OpenedPainting opened;
            opened.file = "a.exr";
            return opened;
        },
        [&](std::string_view, double fraction) {
            told.push_back(fraction);
            return true;
        });
    while (opening.state().fraction == 0) std::this_thread::yield();
    EXPECT_EQ(opening.state().stage, "read painting");
    EXPECT_FALSE(opening.over());
    go_on = true;
    EXPECT_EQ(opening.take().file, "a.exr");
    EXPECT_EQ(told, std::vector{0.25});
}

TEST(FirstOpening, ThrowsWhatWasThrown) {
    FirstOpening bad([](const Progress&) -> OpenedPainting { fail("a.exr: is damaged"); }, {});
    EXPECT_EQ(error_of([&] { bad.take(); }), "a.exr: is damaged");
    FirstOpening interrupted(
        [](const Progress& progress) -> OpenedPainting {
            report(progress, "read painting", 0.5);
            return {};
        },
        [](std::string_view, double) { return false; });
    EXPECT_THROW(interrupted.take(), Cancelled);
}

TEST(FirstOpening, StopsWhenTheWindowGoes) {
    std::atomic<bool> stopped = false;
    {
        const FirstOpening endless(
            [&](const Progress& progress) -> OpenedPainting {
                try {
                    for (;;) report(progress, "read painting", 0.5);
                } catch (const Cancelled&) {
                    stopped = true;
                    throw;
                }
            },
            {});
    }
    EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace tangi
