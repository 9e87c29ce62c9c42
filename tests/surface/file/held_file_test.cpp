// held_file_test.cpp: what one process at a time has, and gives back.
#include "surface/file/held_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using Taken = HeldFile::Taken;

TEST(HeldFiles, AreOfOneAtATimeAndGoneAfterwards) {
    const TestDir dir;
    const fs::path file = dir / "a.lock";
    {
        HeldFile one, two;
        EXPECT_EQ(one.take(file), Taken::yes);
        EXPECT_TRUE(one.is_held(file));
        EXPECT_EQ(two.take(file), Taken::by_another);
        HeldFile moved = std::move(one);
        EXPECT_EQ(two.take(file), Taken::by_another);
        moved.give_back();
        EXPECT_EQ(two.take(file), Taken::yes);
        EXPECT_EQ(two.take(dir / "b.lock"), Taken::yes);
        EXPECT_FALSE(fs::exists(file));
    }
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{});
    EXPECT_EQ(HeldFile().take(dir / "none/a.lock"), Taken::cannot);
}

TEST(HeldFiles, AreFreeWhereTheirProcessWasKilled) {
    const TestDir dir;
    int told[2];
    ASSERT_EQ(::pipe(told), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        HeldFile file;
        const char taken = file.take(dir / "a.lock") == Taken::yes;
        (void)!::write(told[1], &taken, 1);
        ::pause();
    }
    char taken = 0;
    ASSERT_EQ(::read(told[0], &taken, 1), 1);
    EXPECT_EQ(taken, 1);
    HeldFile file;
    EXPECT_EQ(file.take(dir / "a.lock"), Taken::by_another);
    ::kill(child, SIGKILL);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    EXPECT_EQ(file.take(dir / "a.lock"), Taken::yes);
    ::close(told[0]), ::close(told[1]);
}

}  // namespace
}  // namespace tangi
