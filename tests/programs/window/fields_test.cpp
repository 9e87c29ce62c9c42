// fields_test.cpp: in the real window: numbers with a decimal comma, a small window with a
// treatment, what is compared under its own light, doubts that the fit had.
#include <gmock/gmock.h>

#include "retouch/treatment/treatment.h"
#include "surface/provenance/fit_doubts.h"
#include "tests/programs/support/painting_window.h"

namespace tangi {
namespace {

// Places of the panels: Width under Treatment, once that was asked for; Turn under Tools, before.
constexpr std::pair<int, int> kWidth{97, 330}, kTurn{97, 381};

TEST_F(Window, ADecimalCommaIsOneInTheWidthOfATreatment) {
    Surface painting = small_painting();
    painting.scale_known = false;
    painting.mm_per_pixel = 1;
    write_painting(painting_, painting);
    start();
    screen_->key("ctrl+t");  // asks for its width
    screen_->settled();
    for (const char* typed : {"1.234,5", "12 cm", "120,5"}) {
        click(kWidth);
        screen_->enter(typed);
        screen_->settled();
    }
    screen_->x({"mousemove", std::to_string(kMiddleX), std::to_string(kMiddleY)});
    screen_->key("ctrl+t");
    const fs::path treatment = folder_ / "small.treatment";
    EXPECT_TRUE(Screen::until([&] { return fs::exists(treatment / "log.jsonl"); }));
    screen_->settled();
    EXPECT_NEAR(Treatment::open(treatment).mm_per_pixel(), 120.5 / 160, 1e-9);
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, WhatCanBeReadInTwoWaysLeavesASliderAsItIs) {
    start();
    const auto upright = screen_->settled();
    const auto type = [&](const std::string& text) {
        screen_->x({"mousemove", std::to_string(kTurn.first), std::to_string(kTurn.second), "keydown", "ctrl",
                    "click", "1", "keyup", "ctrl"});
        screen_->settled();
        screen_->enter(text);
        screen_->settled();
    };
    type("1.234,5");
    constexpr Region kMessage{310, 656, 700, 676};
    EXPECT_LT(Screen::difference(upright, screen_->picture(), {350, 150, 950, 600}), 0.002) << "not turned";
    EXPECT_GT(Screen::difference(upright, screen_->picture(), kMessage), 0.01) << "and it is said why";
    type("45,5");
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.05)) << "turned by 45.5 degrees, not by 455";
    type("0");
    EXPECT_TRUE(screen_->becomes_alike(upright, {350, 150, 950, 600}, 0.01));
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, ATreatmentLeavesRoomForThePaintingInASmallWindow) {
    Surface painting = small_painting();
    painting.scale_known = true;
    write_painting(painting_, painting);
    start();
    screen_->key("ctrl+t");
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "small.treatment" / "log.jsonl"); }));
    screen_->settled();
    screen_->x({"search", "--name", "TangiPaint", "windowsize", "800", "600"});
    const auto picture = screen_->settled();
    const auto is_bright = [&](int x, int y) { return glm::length(picture(x, y)) > 0.4f; };
    EXPECT_TRUE(is_bright(365, 300) && is_bright(765, 300)) << "it is 400 pixels wide at least";
    click(120, 18);  // the other panels
    EXPECT_GT(Screen::difference(picture, screen_->settled(), {0, 40, 330, 600}), 0.02);
    EXPECT_LT(Screen::difference(picture, screen_->picture(), {340, 100, 790, 500}), 0.01);
    EXPECT_EQ(close().code, 0);
}

// All that a fit has doubts about, not the first of them alone.
TEST(FitDoubtsOfTheProgram, AreKeptWithThePainting) {
    const TinyStack stack;
    write_bytes(fs::path(stack.path()) / "stray.png", "no photograph");
    const std::string lights = bytes_of(stack.lights());
    const auto line = lights.find('\n');
    write_bytes(stack.lights(), std::to_string(std::stoi(lights) + 2) + lights.substr(line) +
                                    "gone_1.png 0.5 0.5 0.7\ngone_2.png -0.5 0.5 0.7\n");
    const Finished done = tangipaint({"fit", stack.path(), "--out", stack.out("p.exr")});
    const auto json = done.json();
    const auto doubts = doubts_of(read_painting(stack.out("p.exr")));
    ASSERT_GE(json["warnings"].size(), 2u) << done.out;
    for (const char* kind : {"warnings", "poor"})
        for (const auto& text : json[kind]) EXPECT_THAT(doubts, testing::Contains(text.get<std::string>()));
}

}  // namespace
}  // namespace tangi
