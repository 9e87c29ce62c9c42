// paint_history_test.cpp: undo and redo, bit for bit.
#include "paint/history.h"

#include <gtest/gtest.h>

#include "tests/paint_support.h"
#include "tests/test_support.h"

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
    dry(canvas, "first", canvas.region());
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

TEST(History, KeepsToItsBudget) {
    Canvas canvas = flat_canvas();
    const std::size_t budget = 600000;
    History history(budget);
    for (int i = 0; i < 12; ++i) paint_stroke(canvas, history, i % 3);
    EXPECT_LE(history.bytes(), budget);
    int undone = 0;
    while (history.undo(canvas)) ++undone;
    EXPECT_GE(undone, 1);
    EXPECT_LT(undone, 12);
}

}  // namespace
}  // namespace tangi
