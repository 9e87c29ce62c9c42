// viewer_window_test.cpp: the real window, driven by a pointer and a keyboard: tilt, light, paint, undo,
// save, crash.
#include "paint/canvas_file.h"
#include "paint/journal.h"
#include "viewer_support.h"
#include "window_screen.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

constexpr Region kCanvas{310, 10, 780, 660};  // of the window, without panels, probe and status line
constexpr int kMiddleX = 650, kMiddleY = 350;

Surface small_painting() {
    Surface s = painted_surface(160, 120);
    s.mm_per_pixel = 0.5;  // a brush of 12 mm is much smaller than the painting
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x)
            s.diffuse(x, y) = {0.6f, 0.5f + 0.001f * static_cast<float>(x), 0.4f};
    return s;
}

class Window : public testing::Test {
protected:
    void SetUp() override {
        screen_ = Screen::open();
        if (!screen_) GTEST_SKIP() << "no Xvfb and xdotool here";
        painting_ = folder_ / "small.exr";
        write_painting(painting_, small_painting());
    }

    void start() {
        program_ = std::make_unique<Program>(
            std::vector<std::string>{"paint", painting_.string(), "--size",
                                     fmt::format("{}x{}", Screen::kWidth, Screen::kHeight)},
            screen_->conditions());
        const bool shown = Screen::until([&] {
            const auto p = screen_->picture();
            return !program_->running() || glm::length(p(kMiddleX, kMiddleY)) > 0.3f;
        });
        ASSERT_TRUE(shown && program_->running()) << program_->wait().err;
        screen_->settled();
    }
    void paint_a_stroke() {
        screen_->key("b");
        screen_->drag(1, {kMiddleX - 150, kMiddleY}, {kMiddleX + 130, kMiddleY + 40});
    }
    Finished close(const std::string& key = "ctrl+q") {
        screen_->key(key);
        return program_->wait();
    }

    TestDir folder_;
    fs::path painting_;
    std::unique_ptr<Screen> screen_;
    std::unique_ptr<Program> program_;
};

TEST_F(Window, TiltsLightsPaintsUndoesAndSaves) {
    start();
    const auto upright = screen_->settled();
    screen_->drag(3, {kMiddleX, kMiddleY}, {kMiddleX + 90, kMiddleY + 40});
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.02)) << "tilted";
    screen_->settled();
    screen_->key("r");
    EXPECT_TRUE(screen_->becomes_alike(upright, kCanvas, 0.004)) << "straightened";
    screen_->key("l");
    screen_->drag(1, {kMiddleX, kMiddleY}, {kMiddleX + 300, kMiddleY + 20});
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.02)) << "lit from elsewhere";
    const auto raking = screen_->settled();

    const Region stroke{kMiddleX - 60, kMiddleY, kMiddleX + 60, kMiddleY + 30}, elsewhere{320, 500, 700, 600};
    paint_a_stroke();
    EXPECT_TRUE(screen_->becomes_different(raking, stroke, 0.08)) << "painted";
    const auto painted = screen_->settled();
    EXPECT_LT(Screen::difference(raking, painted, elsewhere), 0.01);
    screen_->key("ctrl+z");
    EXPECT_TRUE(screen_->becomes_alike(raking, stroke, 0.02)) << "undone";
    screen_->key("ctrl+y");
    EXPECT_TRUE(screen_->becomes_alike(painted, stroke, 0.02)) << "redone";

    screen_->key("ctrl+s");
    screen_->settled();
    const Finished done = close();
    EXPECT_EQ(done.code, 0) << done.err;
    const auto json = done.json();
    EXPECT_EQ(json["strokes"], 1);
    EXPECT_EQ(json["saves"], 1);
    EXPECT_EQ(json["unsaved"], false);
    EXPECT_GT(json["light_deg"][1], 0);
    EXPECT_LT(json["light_deg"][1], 45) << "the light was moved down";
    const Canvas canvas = read_canvas(painting_);
    EXPECT_FALSE(canvas.wet().empty());
    EXPECT_EQ(hash_of(canvas.dry()), hash_of(small_painting())) << "the dry layer never changes";
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("small.exr", "small.strokes.jsonl"));
    EXPECT_GT(read_journal(folder_ / "small.strokes.jsonl").entries.size(), 5u);
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
    screen_->settled();
    screen_->key("ctrl+q");
    screen_->settled();
    EXPECT_TRUE(program_->running()) << "it asks";
    screen_->key("Return");  // save and close
    const Finished done = program_->wait();
    EXPECT_EQ(done.json()["saves"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
}

TEST_F(Window, ResizedToNothingGoesOn) {
    start();
    screen_->x({"search", "--name", "TangiPaint", "windowsize", "1", "1"});
    EXPECT_TRUE(Screen::until([&] { return glm::length(screen_->picture()(kMiddleX, kMiddleY)) < 0.05f; }))
        << "gone";
    screen_->x({"search", "--name", "TangiPaint", "windowsize", "1000", "700"});
    EXPECT_TRUE(Screen::until([&] { return glm::length(screen_->picture()(kMiddleX, kMiddleY)) > 0.1f; }))
        << "back";
    EXPECT_EQ(close().code, 0);
}

TEST(NoWindow, SaysWhatIsMissing) {
    TestDir folder;
    write_painting(folder / "a.exr", small_painting());
    Conditions nowhere;
    nowhere.environment = {{"DISPLAY", ":4711"}, {"WAYLAND_DISPLAY", ""}};
    const Finished done = Program({"paint", (folder / "a.exr").string()}, nowhere).wait();
    EXPECT_EQ(done.code, 1);
    EXPECT_THAT(done.err, testing::HasSubstr("no window can be opened"));
    EXPECT_THAT(done.err, testing::HasSubstr("display"));
    EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.exr"));
}

TEST(NoWindow, MistypedIsAUsageError) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"paint"},
                                                  {"paint", "a.exr", "--substrate", "linen"},
                                                  {"paint", "--substrate", "glass"},
                                                  {"paint", "--substrate", "linen", "--size", "big"}})
        EXPECT_EQ(Program(words).wait().code, 2);
}

// Relit by the program with these further words; what it said on stdout and stderr.
std::pair<Image<Rgb>, Finished> relit(const TestDir& folder, const std::string& name,
                                      std::vector<std::string> words, const Conditions& conditions = {}) {
    words.insert(words.begin(), {"relight", (folder / "a.exr").string(), "--light=-1,0.4,0.5",
                                 "--point-light=4,5,9", "--out", (folder / name).string()});
    Finished done = Program(words, conditions).wait();
    EXPECT_EQ(done.code, 0) << done.err;
    return {read_picture(folder / name), done};
}

TEST(RelightGpu, DrawsTheSamePicture) {
    try {
        gl::HeadlessContext();
    } catch (const Error& error) {
        GTEST_SKIP() << "no OpenGL here: " << error.what();
    }
    TestDir folder;
    write_painting(folder / "a.exr", small_painting());
    const auto [reference, by_reference] = relit(folder, "r.exr", {});
    const auto [drawn, by_gl] = relit(folder, "g.exr", {"--gpu"});
    EXPECT_GE(part_within(drawn, reference, 1), 0.999);
    EXPECT_EQ(by_reference.json()["drawn_by"], "reference renderer");
    EXPECT_NE(by_gl.json()["drawn_by"], "reference renderer");
}

TEST(RelightGpu, FallsBackWithANote) {
    TestDir folder;
    write_painting(folder / "a.exr", small_painting());
    Conditions bare;
    bare.environment = {{"__EGL_VENDOR_LIBRARY_DIRS", "/nowhere"}, {"LIBGL_DRIVERS_PATH", "/nowhere"}};
    const auto [reference, by_reference] = relit(folder, "r.exr", {});
    const auto [fallen, done] = relit(folder, "g.exr", {"--gpu"}, bare);
    EXPECT_TRUE(images_near(fallen, reference, 0));
    EXPECT_THAT(done.err, testing::HasSubstr("warning: --gpu: "));
    EXPECT_THAT(done.err, testing::HasSubstr("the reference renderer draws instead"));
    EXPECT_EQ(done.json()["drawn_by"], "reference renderer");
}

}  // namespace
}  // namespace tangi
