// names_test.cpp: in the real window: characters that no text had before, names as people type
// them, the list of keys.
#include <gmock/gmock.h>

#include "tests/programs/support/painting_window.h"

namespace tangi {
namespace {

constexpr Region kPanelColumn{0, 0, 300, 700};
constexpr std::pair<int, int> kTurnField{97, 381};

float brightest(const Image<Rgb>& picture, const Region& region) {
    float most = 0;
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) most = std::max(most, picture(x, y).g);
    return most;
}

// What is drawn of them, not what the atlas has: the device must get the new one.
TEST_F(Window, PanelsAreStillSeenWhenNewCharactersComeUp) {
    start();
    const auto before = screen_->settled();
    ASSERT_GT(brightest(before, kPanelColumn), 0.8f);
    const auto are_seen = [&](const char* when) {
        screen_->settled();
        EXPECT_GT(brightest(screen_->picture(), kPanelColumn), 0.8f) << when;
        EXPECT_GT(brightest(screen_->picture(), {400, 150, 900, 550}), 0.8f) << "the dialog " << when;
        screen_->key("Escape");
        EXPECT_TRUE(screen_->becomes_alike(before, kPanelColumn, 0.005)) << when;
    };
    screen_->key("ctrl+shift+s");
    screen_->settled();
    screen_->x({"key", "ctrl+a", "type", "--delay", "20", "№ 5"});
    are_seen("typed as a name");
    write_bytes(folder_ / "♀ 6.exr", "no painting");
    screen_->key("ctrl+o");
    are_seen("of a file in a list");
    screen_->x({"mousemove", std::to_string(kTurnField.first), std::to_string(kTurnField.second), "keydown",
                "ctrl", "click", "1", "keyup", "ctrl"});
    screen_->settled();
    screen_->x({"type", "--delay", "20", "☼"});
    screen_->settled();
    EXPECT_GT(brightest(screen_->picture(), kPanelColumn), 0.8f) << "typed as a number";
    screen_->x({"key", "Escape", "mousemove", "650", "350"});
    EXPECT_TRUE(screen_->becomes_alike(before, {0, 0, 300, 370}, 0.005));
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, ANameIsSavedAsItIsMeant) {
    start();
    fs::create_directory(folder_ / "sub");
    const auto save_as = [&](const std::string& name) {
        screen_->key("ctrl+shift+s");
        screen_->settled();
        screen_->x({"key", "ctrl+a"});
        screen_->enter(name);
        screen_->settled();
    };
    const auto bare = screen_->settled();
    for (const std::string& name : {std::string(".exr"), std::string("..."), std::string(240, 'n')}) {
        save_as(name);
        EXPECT_GT(Screen::difference(bare, screen_->picture(), {450, 250, 850, 450}), 0.05)
            << "still asks: " << name.substr(0, 10);
        screen_->key("Escape");
        screen_->settled();
    }
    save_as(" lead.exr ");
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "lead.exr"); }));
    save_as("sub/");  // goes there, with the name as it was
    screen_->key("Return");
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "sub" / "lead.exr"); }));
    screen_->settled();
    EXPECT_EQ(close().json()["painting"], (folder_ / "sub" / "lead.exr").string());
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("lead.exr", "small.exr", "sub"));
    EXPECT_THAT(names_in(folder_ / "sub"), testing::ElementsAre("lead.exr"));
}

TEST_F(Window, EscapeClosesTheListOfKeys) {
    start();
    const auto bare = screen_->settled();
    screen_->key("F1");
    EXPECT_TRUE(screen_->becomes_different(bare, kCanvas, 0.05));
    screen_->settled();
    screen_->key("Escape");
    EXPECT_TRUE(screen_->becomes_alike(bare, kCanvas, 0.005));
    paint_a_stroke();
    EXPECT_TRUE(
        screen_->becomes_different(bare, {kMiddleX - 60, kMiddleY, kMiddleX + 60, kMiddleY + 30}, 0.08))
        << "and one paints where it was";
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().code, 0);
}

}  // namespace
}  // namespace tangi
