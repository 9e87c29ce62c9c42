// window_sitting_test.cpp: what the real window does so that no stroke is lost.
#include "paint/files/canvas_file.h"
#include "paint/session/journal.h"
#include "tests/programs/support/painting_window.h"
#include "tests/programs/support/small_disk.h"
#include "tests/support/paint/record_support.h"

namespace tangi {
namespace {

int strokes_in(const Journal& journal) {
    return static_cast<int>(std::ranges::count_if(
        journal.entries, [](const auto& entry) { return std::holds_alternative<StrokeEvent>(entry.event); }));
}

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
    const auto second = window_on(*other_screen);
    other_screen->key("Return");  // would recover
    other_screen->key("b");
    other_screen->drag(1, {kMiddleX - 150, kMiddleY - 60}, {kMiddleX + 130, kMiddleY - 20});
    other_screen->settled();
    other_screen->key("ctrl+q");
    const auto result = second->wait().json();
    EXPECT_EQ(result["strokes"], 0);
    EXPECT_EQ(result["unsaved"], false);
    EXPECT_EQ(bytes_of(unsaved), journal);
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().json()["saves"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
}

// Eight megabytes that are full for as long as five strokes take: more than the rest of a page.
TEST_F(Window, ADiskThatIsFullForAMomentLosesNoStroke) {
    const SmallDisk disk(8);
    if (!disk.is_there()) GTEST_SKIP() << "no disk can be mounted here";
    fs::copy(painting_, disk / "small.exr");
    painting_ = disk / "small.exr";
    const RecoveryFiles files = recovery_files(painting_);
    start();
    screen_->key("b");
    const auto strokes = [&](int count, int from_y) {
        for (int i = 0; i < count; ++i)
            screen_->drag(1, {kMiddleX - 150, from_y + 30 * i}, {kMiddleX + 130, from_y + 30 * i + 10});
        screen_->settled();
    };
    strokes(2, kMiddleY - 100);
    disk.fill();
    strokes(5, kMiddleY - 100);
    EXPECT_LT(strokes_in(recovered_journal(files.unsaved)), 7) << "the disk was not full";
    disk.make_room();
    strokes(3, kMiddleY + 20);
    program_->signal(SIGKILL);
    program_->wait();
    EXPECT_EQ(strokes_in(read_journal(files.unsaved)), 10);
    start();
    screen_->key("Return");
    screen_->settled();
    screen_->key("ctrl+s");
    screen_->settled();
    const auto result = close().json();
    EXPECT_EQ(result["saves"], 1);
    EXPECT_EQ(result["strokes"], 10);
    EXPECT_EQ(strokes_in(read_journal(files.record)), 10);
    EXPECT_TRUE(recorded_as_saved(painting_));
}

// The button is down while keys come, as of somebody whose other hand is quicker.
TEST_F(Window, KeysInMidStrokeEndTheStroke) {
    start();
    paint_a_stroke();
    for (const std::string key : {"ctrl+z", "ctrl+y", "d", "h", "c", "ctrl+s", "Escape", "F1", "b"}) {
        screen_->x({"key",   "b",    "mousemove", "560",   "300",       "mousedown", "1",   "mousemove",
                    "600",   "320",  "sleep",     "0.05",  "mousemove", "640",       "330", "sleep",
                    "0.05",  "key",  key,         "sleep", "0.05",      "mousemove", "700", "400",
                    "sleep", "0.05", "mousemove", "720",   "420",       "mouseup",   "1"});
        screen_->settled();
        if (key == "F1" || key == "c") screen_->key(key == "c" ? "Escape" : key);  // what it opened
        screen_->settled();
    }
    screen_->key("ctrl+s");
    screen_->settled();
    const auto result = close().json();
    EXPECT_EQ(result["unsaved"], false);
    EXPECT_EQ(result["saves"], 2);
    const Journal record = read_journal(recovery_files(painting_).record);
    EXPECT_TRUE(record.warnings.empty()) << record.warnings.front().text;
    EXPECT_GT(strokes_in(record), 8);
    EXPECT_TRUE(recorded_as_saved(painting_));
}

// Another painting of this name came by mv: it is not written over, and a name is asked for.
TEST_F(Window, APaintingThatWasReplacedIsNotOverwritten) {
    start();
    paint_a_stroke();
    screen_->settled();
    write_painting(folder_ / "other.exr", painted_surface(100, 80, 5));
    fs::rename(folder_ / "other.exr", painting_);
    const std::string theirs = bytes_of(painting_);
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_TRUE(bytes_of(painting_) == theirs);
    const fs::path mine = folder_ / "mine.exr";  // into the dialog that is there
    screen_->key("ctrl+a");
    screen_->enter(mine.string());
    screen_->settled();
    const auto result = close().json();
    EXPECT_EQ(result["saves"], 1);
    EXPECT_EQ(result["unsaved"], false);
    EXPECT_TRUE(bytes_of(painting_) == theirs);
    ASSERT_TRUE(fs::exists(mine));
    EXPECT_TRUE(recorded_as_saved(mine));
}

// A crash, and then cp of another painting over this one: its strokes are none of that.
TEST_F(Window, StrokesOfAnotherPaintingAreNotRecovered) {
    start();
    paint_a_stroke();
    screen_->settled();
    program_->signal(SIGKILL);
    program_->wait();
    const RecoveryFiles files = recovery_files(painting_);
    const std::string theirs = bytes_of(files.unsaved);
    Surface other = small_painting();
    other.diffuse(0, 0) = Rgb(0.1f);
    write_painting(painting_, other);
    const std::string before = bytes_of(painting_);
    start();
    screen_->key("Return");  // puts them aside
    screen_->settled();
    EXPECT_EQ(bytes_of(folder_ / "small.discarded.jsonl"), theirs);
    EXPECT_TRUE(bytes_of(painting_) == before);
    paint_a_stroke();
    screen_->key("ctrl+s");
    screen_->settled();
    const auto result = close().json();
    EXPECT_EQ(result["strokes"], 1);
    EXPECT_EQ(result["saves"], 1);
    EXPECT_EQ(strokes_in(read_journal(files.record)), 1);
    EXPECT_TRUE(recorded_as_saved(painting_));
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
