// viewer_window_sitting_test.cpp: what the real window does so that no stroke is lost.
#include "paint/canvas_file.h"
#include "paint/journal.h"
#include "painting_window.h"

namespace tangi {
namespace {

TEST_F(Window, StrokesOfACrashAreRecovered) {
    start();
    const auto bare = screen_->settled();
    paint_a_stroke();
    const auto painted = screen_->settled();
    program_->signal(SIGKILL);
    program_->wait();
    EXPECT_TRUE(fs::exists(folder_ / "small.unsaved.jsonl"));
    start();
    EXPECT_TRUE(screen_->becomes_alike(bare, kCanvas, 0.01)) << "not before one asks for it";
    screen_->key("Return");
    EXPECT_TRUE(screen_->becomes_alike(painted, kCanvas, 0.01));
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().json()["saves"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
    EXPECT_FALSE(fs::exists(folder_ / "small.unsaved.jsonl"));
}

TEST_F(Window, ASecondWindowLeavesTheSittingOfTheFirstAlone) {
    start();
    paint_a_stroke();
    screen_->settled();
    const fs::path unsaved = folder_ / "small.unsaved.jsonl";
    const std::string journal = bytes_of(unsaved);
    EXPECT_FALSE(journal.empty());
    const auto other_screen = Screen::open();
    ASSERT_TRUE(other_screen);
    Program second(
        {"paint", painting_.string(), "--size", fmt::format("{}x{}", Screen::kWidth, Screen::kHeight)},
        other_screen->conditions());
    ASSERT_TRUE(Screen::until([&] {
        return !second.running() || glm::length(other_screen->picture()(kMiddleX, kMiddleY)) > 0.3f;
    }));
    other_screen->settled();
    other_screen->key("Return");  // would recover
    other_screen->key("b");
    other_screen->drag(1, {kMiddleX - 150, kMiddleY - 60}, {kMiddleX + 130, kMiddleY - 20});
    other_screen->settled();
    other_screen->key("ctrl+q");
    const auto result = second.wait().json();
    EXPECT_EQ(result["strokes"], 0);
    EXPECT_EQ(result["unsaved"], false);
    EXPECT_EQ(bytes_of(unsaved), journal);
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().json()["saves"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
}

TEST_F(Window, EndedInMidStrokeLosesNothing) {
    start();
    screen_->key("b");
    screen_->x({"mousemove", "600", "300", "mousedown", "1", "mousemove", "640", "310", "sleep", "0.05",
                "mousemove", "680", "330", "sleep", "0.05"});
    program_->signal(SIGTERM);
    const Finished done = program_->wait();
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.json()["unsaved"], true);
    const Journal journal = read_journal(folder_ / "small.unsaved.jsonl");
    ASSERT_GE(journal.entries.size(), 3u);
    EXPECT_TRUE(std::holds_alternative<EndEvent>(journal.entries.back().event));
    EXPECT_TRUE(read_canvas(painting_).wet().empty());
}

TEST_F(Window, AsksBeforeItLosesStrokes) {
    start();
    paint_a_stroke();
    screen_->x({"mousemove", "100", "400", "click", "--repeat", "40", "--delay", "20", "5"});
    screen_->settled();
    screen_->key("ctrl+q");
    const auto asking = screen_->settled();
    EXPECT_TRUE(program_->running()) << "it asks";
    bool seen = false;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 250; ++x) {
            const Rgb c = asking(x, y);
            seen |= c.r > 0.9f && c.g > 0.7f && c.g < 0.9f && c.b < 0.4f;
        }
    EXPECT_TRUE(seen) << "the question, though the panels were scrolled down";
    screen_->key("Return");  // save and close
    const Finished done = program_->wait();
    EXPECT_EQ(done.json()["saves"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
}

}  // namespace
}  // namespace tangi
