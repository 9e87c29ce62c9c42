// random_hand_test.cpp: the real window under a hand that does anything at all: it neither dies nor
// complains.
//
// Short here. TP_RANDOM_S=3600 lets it go on for an hour, TP_RANDOM_SEED=7 is another hand; under the
// sanitizers (preset asan, random_tests) it is tests/window_program.cpp, which is the window without the
// other commands.
#include "random_hand.h"

#include <fstream>

#include "viewer_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

double number_of(const char* variable, double otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atof(text) : otherwise;
}

TEST(RandomHand, TheWindowGoesOn) {
    const auto screen = Screen::open();
    if (!screen) GTEST_SKIP() << "no Xvfb and xdotool here";
    const TestDir folder;
    // So deep that no hand climbs to what is not the test's.
    fs::path deep = folder.path();
    for (int i = 0; i < 12; ++i) deep /= "d";
    fs::create_directories(deep);
    for (const char* name : {"a.exr", "b.exr"}) {
        Surface painting = painted_surface(160, 120, name[0] == 'a' ? 1 : 2);
        painting.mm_per_pixel = 0.5;
        write_painting(deep / name, painting);
    }
    write_bytes(deep / "broken.exr", "no painting");
    Conditions conditions = screen->conditions();
    const double seconds = number_of("TP_RANDOM_S", 10);
    // Strokes that wait are painted before it closes, which takes the sanitizers a while.
    conditions.timeout = std::chrono::seconds(static_cast<int>(3 * seconds) + 300);
    conditions.cwd = deep;
    const auto seed = static_cast<std::uint64_t>(number_of("TP_RANDOM_SEED", 1));
    Program window({"paint", "a.exr", "--size", fmt::format("{}x{}", Screen::kWidth, Screen::kHeight),
                    "--camera", "/nowhere"},
                   conditions);
    ASSERT_TRUE(
        Screen::until([&] { return !window.running() || glm::length(screen->picture()(650, 350)) > 0.1f; }));
    RandomHand hand(*screen, seed,
                    {(deep / "a.exr").string(), "b.exr", "broken.exr", "new", "../d", "\\\\ ?*", "3.5"});
    std::string log;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    int rounds = 0;
    for (; window.running() && std::chrono::steady_clock::now() < end; ++rounds) log += hand.act() + '\n';
    if (!window.running()) {
        const Finished ended = window.wait();
        FAIL() << "seed " << seed << ", round " << rounds << ": ended with code " << ended.code << ":\n"
               << ended.err << ended.out << "\nwhat the hand did:\n"
               << (log.size() > 20'000 ? log.substr(log.size() - 20'000) : log);
    }
    EXPECT_GT(rounds, 0);
    window.signal(SIGTERM);
    const Finished done = window.wait();
    EXPECT_EQ(done.code, 0) << "seed " << seed << ", round " << rounds << ":\n" << done.err << "\n" << log;
}

}  // namespace
}  // namespace tangi
