// carried_test.cpp: what a brush brings along to the palette that paints are mixed on.
#include <gtest/gtest.h>

#include "paint/optics/palette.h"
#include "viewer/model/window_state.h"

namespace tangi {
namespace {

WindowState with_paints() {
    WindowState state;
    state.palette = artist_acrylics();
    state.mix = {{"Titanium White", 1}};
    return state;
}

TEST(Carried, ABrushComesCleanToThePaletteAndGoesOnWithWhatItTookUp) {
    WindowState state = with_paints();
    const StrokeEvent first = state.board_stroke(1);
    EXPECT_EQ(first.on, Place::palette);
    EXPECT_TRUE(first.paint.empty());
    EXPECT_EQ(first.start, BrushStart::clean);
    EXPECT_EQ(state.board_stroke(2).start, BrushStart::same);
    EXPECT_EQ(state.stroke(3).start, BrushStart::same) << "on the painting, too";
}

TEST(Carried, WhatIsChosenIsLaidOnThePaletteOnce) {
    WindowState state = with_paints();
    state.board_stroke(1);
    state.board.carried = Carried::chosen;
    const StrokeEvent chosen = state.board_stroke(2);
    ASSERT_EQ(chosen.paint.size(), 1u);
    EXPECT_EQ(chosen.paint[0].first, "Titanium White");
    EXPECT_EQ(chosen.start, BrushStart::clean);
    EXPECT_EQ(state.board_stroke(3).start, BrushStart::same);
}

TEST(Carried, AWashedBrushPaintsWithThePanelsMixture) {
    WindowState state = with_paints();
    state.board_stroke(1);
    state.board.carried = Carried::nothing;
    EXPECT_TRUE(WindowState(state).board_stroke(2).paint.empty());
    EXPECT_EQ(state.stroke(3).paint.size(), 1u);
    EXPECT_EQ(state.on_brush().recipe.size(), 1u);
}

}  // namespace
}  // namespace tangi
