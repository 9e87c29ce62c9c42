// history_test.cpp: undo and redo, bit for bit.
#include "paint/session/history.h"

#include <gmock/gmock.h>

#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

void paint_stroke(Canvas& canvas, History& history, int number) {
    history.begin(canvas);
    Brush brush(brush_presets().at("round"), kTestPixel, static_cast<std::uint64_t>(number));
    brush.load({{add_paint(canvas, artist_acrylics().paints[static_cast<std::size_t>(number)].name), 1}}, 1);
    stroke(canvas, brush, {-12, number - 2.0}, {12, 2.0 - number});
    history.end(canvas);
}

TEST(History, UndoAndRedoGiveTheSameBits) {
    Canvas canvas = flat_canvas();
    History history;
    std::vector<PaintLayer> states = {canvas.wet()};
    for (int i = 0; i < 4; ++i) {
        paint_stroke(canvas, history, i);
        states.push_back(canvas.wet());
    }
    for (int i = 3; i >= 0; --i) {
        EXPECT_TRUE(history.undo(canvas));
        EXPECT_TRUE(identical(canvas.wet(), states[static_cast<std::size_t>(i)])) << i;
    }
    EXPECT_TRUE(canvas.wet().empty());
    EXPECT_FALSE(history.undo(canvas));
    for (int i = 1; i <= 4; ++i) {
        EXPECT_TRUE(history.redo(canvas));
        EXPECT_TRUE(identical(canvas.wet(), states[static_cast<std::size_t>(i)])) << i;
    }
    EXPECT_FALSE(history.redo(canvas));
}

TEST(History, WhatIsPaintedAfterAnUndoReplacesWhatWasUndone) {
    Canvas canvas = flat_canvas();
    History history;
    paint_stroke(canvas, history, 0);
    const PaintLayer first = canvas.wet();
    paint_stroke(canvas, history, 1);
    history.undo(canvas);
    paint_stroke(canvas, history, 2);
    EXPECT_FALSE(history.can_redo());
    history.undo(canvas);
    EXPECT_TRUE(identical(canvas.wet(), first));
}

TEST(History, DryingAndLiftingAreUndoneToo) {
    Canvas canvas = flat_canvas();
    History history;
    paint_stroke(canvas, history, 0);
    const PaintLayer wet = canvas.wet();
    history.begin(canvas);
    dry(canvas, "first");
    history.end(canvas);
    history.begin(canvas);
    lift_off(canvas, "first");
    history.end(canvas);
    EXPECT_TRUE(canvas.dried().empty());
    history.undo(canvas);
    ASSERT_EQ(canvas.dried().size(), 1u);
    EXPECT_TRUE(identical(canvas.dried()[0].paint, wet));
    history.undo(canvas);
    EXPECT_TRUE(canvas.dried().empty());
    EXPECT_TRUE(identical(canvas.wet(), wet));
    EXPECT_FALSE(canvas.take_dirty().empty());
}

// Sets where temporary files go, for as long as it lives.
class TemporaryFolder {
public:
    explicit TemporaryFolder(const std::filesystem::path& folder) {
        if (const char* before = std::getenv("TMPDIR")) before_ = before;
        ::setenv("TMPDIR", folder.c_str(), 1);
    }
    ~TemporaryFolder() {
        if (before_)
            ::setenv("TMPDIR", before_->c_str(), 1);
        else
            ::unsetenv("TMPDIR");
    }

private:
    std::optional<std::string> before_;
};

TEST(History, BeyondItsBudgetItGoesToDiskAndComesBackBitForBit) {
    const TestDir dir;
    const TemporaryFolder here(dir.path());
    Canvas canvas = flat_canvas();
    const std::size_t budget = 100000;  // of about 40 tiles, six
    History history(budget);
    std::vector<PaintLayer> states = {canvas.wet()};
    for (int i = 0; i < 12; ++i) {
        paint_stroke(canvas, history, i % 3);
        states.push_back(canvas.wet());
        EXPECT_LE(history.bytes(), budget) << i;
    }
    EXPECT_GT(history.bytes_on_disk(), 500000u);
    EXPECT_EQ(history.take_warning(), "");
    EXPECT_TRUE(std::filesystem::is_empty(dir.path()));  // the file has no name
    for (int round = 0; round < 2; ++round) {
        for (std::size_t i = 12; i-- > 0;) {
            ASSERT_TRUE(history.undo(canvas)) << i;
            EXPECT_TRUE(identical(canvas.wet(), states[i])) << i;
        }
        EXPECT_FALSE(history.undo(canvas));
        for (std::size_t i = 1; i <= 12; ++i) {
            ASSERT_TRUE(history.redo(canvas)) << i;
            EXPECT_TRUE(identical(canvas.wet(), states[i])) << i;
        }
    }
}

TEST(History, RoomOnDiskIsUsedAgain) {
    const TestDir dir;
    const TemporaryFolder here(dir.path());
    Canvas canvas = flat_canvas();
    History history(0);
    paint_stroke(canvas, history, 0);
    paint_stroke(canvas, history, 1);
    const auto two = history.bytes_on_disk();
    for (int i = 0; i < 5; ++i) {  // what was undone is gone for good
        history.undo(canvas);
        paint_stroke(canvas, history, 1);
    }
    EXPECT_EQ(history.bytes_on_disk(), two);
}

TEST(History, DryingPartsAndLiftingThemComesBackFromDisk) {
    Canvas canvas = flat_canvas();
    History history(0);
    const auto act = [&](const std::function<void()>& action) {
        history.begin(canvas);
        action();
        history.end(canvas);
    };
    paint_stroke(canvas, history, 0);
    std::vector<std::vector<DriedLayer>> states = {canvas.dried()};
    const std::vector<std::function<void()>> actions = {
        [&] {
            dry(canvas, "a", CirclePart{{-6, 0}, 3});
        },
        [&] {
            dry(canvas, "b", CirclePart{{6, 0}, 3});
        },
        [&] {
            dry(canvas, "b", CirclePart{{2, 0}, 3}, 0.5);
        },
        [&] { dry(canvas, "a"); },  // another of this name, on top
        [&] { lift_off(canvas, "b"); },
        [&] { lift_off(canvas, "a"); }};
    for (const auto& action : actions) {
        act(action);
        states.push_back(canvas.dried());
    }
    const auto expect = [&](const std::vector<DriedLayer>& layers) {
        ASSERT_EQ(canvas.dried().size(), layers.size());
        for (std::size_t i = 0; i < layers.size(); ++i) {
            EXPECT_EQ(canvas.dried()[i].name, layers[i].name);
            EXPECT_TRUE(identical(canvas.dried()[i].paint, layers[i].paint)) << i;
        }
    };
    for (std::size_t i = actions.size(); i-- > 0;) {
        SCOPED_TRACE(i);
        history.undo(canvas);
        expect(states[i]);
    }
    for (std::size_t i = 1; i <= actions.size(); ++i) {
        SCOPED_TRACE(i);
        history.redo(canvas);
        expect(states[i]);
    }
}

TEST(History, AFullDiskCostsTheOldestStepsAndIsTold) {
    const TestDir dir;
    Canvas canvas = flat_canvas();
    for (const bool missing : {true, false}) {
        const TemporaryFolder here(missing ? dir / "missing" : dir.path());
        const FullDisk full(300000);
        History history(100000);
        for (int i = 0; i < 12; ++i) paint_stroke(canvas, history, i % 3);
        EXPECT_LE(history.bytes(), 400000u);  // the last step: four tiles of three paints in two films
        EXPECT_THAT(history.take_warning(),
                    testing::AllOf(testing::HasSubstr(dir.path().string()), testing::HasSubstr("TMPDIR"),
                                   testing::HasSubstr("no longer be undone")));
        EXPECT_EQ(history.take_warning(), "");
        int undone = 0;
        while (history.undo(canvas)) ++undone;
        EXPECT_GE(undone, 1);
        EXPECT_LT(undone, 12);
    }
}

}  // namespace
}  // namespace tangi
