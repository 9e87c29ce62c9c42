// treatment_window_test.cpp: a treatment in the real window, by pointer and keyboard: damage is
// suggested, corrected with the brush, filled, isolated, painted over its border, varnished; saved and opened
// again.
#include <gmock/gmock.h>

#include "datasets/procedural_painting.h"
#include "paint/canvas/appearance.h"
#include "retouch/treatment/treatment.h"
#include "surface/painting_file/painting_file.h"
#include "tests/programs/support/window_screen.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

// Of the window: the painting between the two columns.
constexpr Region kCanvasBesidePanels{310, 200, 660, 500};
constexpr int kX = 485, kY = 350;  // its middle

class TreatmentWindow : public testing::Test {
protected:
    void SetUp() override {
        screen_ = Screen::open();
        if (!screen_) GTEST_SKIP() << "no Xvfb and xdotool here";
        PaintingOptions options;
        options.seed = 5;
        options.width = options.height = 160;
        options.mm_per_pixel = 0.5;
        surface_ = surface_of(procedural_painting(options));
        write_painting(folder_ / "p.exr", surface_);
    }

    void start(const fs::path& what) {
        program_ = std::make_unique<Program>(
            std::vector<std::string>{"paint", what.string(), "--by", "A. Restorer", "--size",
                                     fmt::format("{}x{}", Screen::kWidth, Screen::kHeight)},
            screen_->conditions());
        const bool shown = Screen::until([&] {
            const auto p = screen_->picture();
            return !program_->running() || glm::length(p(kX, kY)) > 0.1f;
        });
        ASSERT_TRUE(shown && program_->running()) << program_->wait().err;
        rest();
    }
    // How often the log has this action.
    std::ptrdiff_t logged(const std::string& action) const {
        if (!fs::exists(treatment_ / "log.head.json")) return 0;
        const std::string log = bytes_of(treatment_ / "log.jsonl");
        std::ptrdiff_t count = 0;
        for (auto at = log.find("\"action\":\"" + action + "\""); at != std::string::npos;
             at = log.find("\"action\":\"" + action + "\"", at + 1))
            ++count;
        return count;
    }
    bool becomes_logged(const std::string& action, std::ptrdiff_t times = 1) const {
        const bool is = Screen::until([&] { return logged(action) >= times; });
        rest();
        return is;
    }
    // Until nothing has moved for a second; a progress bar does.
    void rest() const {
        Image<Rgb> last = screen_->picture();
        auto since = std::chrono::steady_clock::now();
        Screen::until([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            Image<Rgb> now = screen_->picture();
            if (!images_near(now, last, 0)) since = std::chrono::steady_clock::now();
            last = std::move(now);
            return std::chrono::steady_clock::now() - since >= std::chrono::seconds(1);
        });
    }

    TestDir folder_;
    Surface surface_;
    fs::path treatment_ = folder_ / "p.treatment";
    std::unique_ptr<Screen> screen_;
    std::unique_ptr<Program> program_;
};

TEST_F(TreatmentWindow, TheWholeSequence) {
    start(folder_ / "p.exr");
    screen_->key("ctrl+t");
    ASSERT_TRUE(becomes_logged("begin"));
    const auto bare = screen_->picture();

    screen_->key("ctrl+g");
    EXPECT_TRUE(screen_->becomes_different(bare, kCanvasBesidePanels, 0.002))
        << "the suggestion lies over the painting";
    rest();
    EXPECT_EQ(logged("suggest damage"), 0) << "nothing is changed before one takes it over";
    screen_->key("ctrl+Return");
    ASSERT_TRUE(becomes_logged("suggest damage"));

    // Two strokes of the damage brush, of which one is undone.
    screen_->key("k");
    screen_->drag(1, {kX - 120, kY - 20}, {kX - 60, kY - 20});
    screen_->drag(1, {kX + 60, kY + 90}, {kX + 120, kY + 90});
    screen_->key("ctrl+z");
    rest();
    screen_->key("ctrl+k");
    ASSERT_TRUE(becomes_logged("draw damage"));
    const Mask mask = Treatment::open(treatment_).mask(DamageClass::loss_to_ground);
    EXPECT_GT(area_of(mask, 1).mm2, 30);

    screen_->key("ctrl+f");
    ASSERT_TRUE(becomes_logged("fill"));
    screen_->key("ctrl+i");
    ASSERT_TRUE(becomes_logged("varnish"));

    // The map made room for what was laid.
    const auto filled = screen_->picture();
    screen_->key("b");
    screen_->drag(1, {kX - 90, kY - 80}, {kX - 90, kY + 60});
    rest();
    EXPECT_GT(Screen::difference(filled, screen_->picture(), {kX - 100, kY - 24, kX - 80, kY - 16}), 0.01)
        << "within the damage there is paint";
    screen_->key("n");  // saved all the same while a state is shown
    rest();
    screen_->key("ctrl+s");
    ASSERT_TRUE(becomes_logged("retouch"));
    screen_->key("ctrl+shift+i");
    ASSERT_TRUE(becomes_logged("varnish", 2));
    screen_->key("ctrl+q");
    const Finished done = program_->wait();
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.json()["unsaved"], false);

    const Treatment treatment = Treatment::open(treatment_);
    EXPECT_THAT(treatment.check(), testing::IsEmpty());
    EXPECT_EQ(treatment.dry_sha256(), sha256_of(surface_));
    const std::vector<TreatmentLayer> layers = treatment.layers();
    ASSERT_EQ(layers.size(), 4u);
    const Canvas canvas = treatment.read_canvas();
    const OnOriginal outside = on_original(canvas.dried()[2].paint, mask, treatment.mm_per_pixel());
    EXPECT_EQ(layers[2].role, LayerRole::retouch);
    EXPECT_GT(area_of(additions(canvas.dried()[2].paint), 1).mm2, 5);
    EXPECT_EQ(outside.pixels, 0) << "the stroke went far over the border";
    for (const LogEntry& entry : treatment.log().entries()) EXPECT_EQ(entry.content["who"], "A. Restorer");

    // Opened again by its folder; seen as it was before, and as it is.
    start(treatment_);
    const auto now = screen_->picture();
    screen_->key("n");
    EXPECT_TRUE(screen_->becomes_different(now, kCanvasBesidePanels, 0.002)) << "before";
    rest();
    screen_->x({"key", "n", "key", "n", "key", "n", "key", "n"});
    EXPECT_TRUE(screen_->becomes_alike(now, kCanvasBesidePanels, 0.002)) << "now";
    rest();
    screen_->key("ctrl+shift+r");
    rest();
    screen_->x({"key", "ctrl+a"});
    screen_->enter((folder_ / "report.html").string());
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "report.html"); }));
    rest();
    screen_->key("ctrl+q");
    EXPECT_EQ(program_->wait().code, 0);
}

}  // namespace
}  // namespace tangi
