// painting_window.h: the real window with a small painting, on a screen of its own.
#pragma once

#include "surface/painting_file/painting_file.h"
#include "tests/programs/support/window_screen.h"
#include "tests/support/viewer/viewer_support.h"

namespace tangi {

namespace fs = std::filesystem;

inline constexpr Region kCanvas{310, 10, 780, 660};  // of the window, without panels, probe and status line

inline Surface small_painting() {
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

    void start(const std::vector<std::string>& further = {}) { program_ = window_on(*screen_, further); }
    // A window of the painting, as it is when it shows it.
    std::unique_ptr<Program> window_on(Screen& screen, const std::vector<std::string>& further = {}) const {
        std::vector<std::string> words = {"paint", painting_.string(), "--size",
                                          fmt::format("{}x{}", Screen::kWidth, Screen::kHeight)};
        words.insert(words.end(), further.begin(), further.end());
        auto program = std::make_unique<Program>(words, screen.conditions());
        const bool shown = Screen::until(
            [&] { return !program->running() || glm::length(screen.picture()(kMiddleX, kMiddleY)) > 0.3f; });
        EXPECT_TRUE(shown && program->running()) << program->wait().err;
        screen.settled();
        return program;
    }
    // All of it comes while the window is held still: for it, that is one very slow frame.
    void in_one_frame(const std::vector<std::string>& words) {
        program_->signal(SIGSTOP);
        screen_->x(words);
        program_->signal(SIGCONT);
    }
    // Left, until it is seen what came of it.
    void click(int x, int y) {
        screen_->x({"mousemove", std::to_string(x), std::to_string(y), "click", "1"});
        screen_->settled();
    }
    void click(const std::pair<int, int>& at) { click(at.first, at.second); }
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

}  // namespace tangi
