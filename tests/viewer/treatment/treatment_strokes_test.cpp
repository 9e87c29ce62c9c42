// treatment_strokes_test.cpp: what is painted by hand on a treatment can be painted again from what
// its steps keep.
#include <gmock/gmock.h>

#include "retouch/treatment/treatment_strokes.h"
#include "tests/support/viewer/treatment_controllers.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

using ControllersStrokes = TreatmentControllers;
using testing::HasSubstr;

// With its journal, a step keeps what its strokes went on from: the brush as the step before left it, and the
// masks that brushes stopped at, which may change in the midst of it.
TEST_F(ControllersStrokes, StrokesOfAStepMakeItsLayerByThemselves) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.where = {DamageClass::abrasion};
    t.current = DamageClass::abrasion;
    t.brush_mm = 12;
    draw(70, 80, 90, 80);
    t.ask.keep = true;
    settle();
    const auto paint = [&](double y_mm, BrushStart start) {
        StrokeEvent event;
        event.brush = brush_presets().at("flat");
        event.brush.size_mm = 8;
        event.start = start;
        if (start == BrushStart::clean) event.paint = {{"Titanium White", 1}};
        painter_->send(event);
        for (int i = 0; i <= 20; ++i)
            painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = 3.0 * i - 30, .y_mm = y_mm}});
        painter_->send(EndEvent{});
        settle();
    };
    const auto save = [&] {
        painter_->save();
        settle();
    };
    const auto repeated = [&] {
        const Treatment now = treatment();
        return repeat_strokes(now, now.read_canvas());
    };
    paint(0, BrushStart::clean);
    save();
    paint(1, BrushStart::same);
    t.confined = false;
    settle();
    paint(20, BrushStart::same);
    t.confined = true;
    t.feather_mm = 2;
    settle();
    paint(-1, BrushStart::clean);
    save();
    StrokesRepeated both = repeated();
    EXPECT_THAT(both.faults, testing::IsEmpty());
    EXPECT_EQ(both.painted_again, 2) << testing::PrintToString(said_);
    EXPECT_EQ(both.not_repeated, 0);
    EXPECT_FALSE(fs::exists(folder_ / "a.treatment" / "painting.unsaved.jsonl"));

    // Opened again, the brush is what it was; after a crash, masks are as they were for each stroke.
    const fs::path file = folder_ / "a.treatment" / "painting.exr";
    show(file);
    settle();
    paint(2, BrushStart::same);
    t.confined = false;
    settle();
    paint(25, BrushStart::same);
    const int painted = state_.painter.painted_px;
    EXPECT_GT(painted, 50);
    t.confined = true;
    settle();
    show(file);  // without saving
    settle();
    painter_->recover(*left_over(recovery_files(file)));
    settle();
    EXPECT_EQ(state_.painter.painted_px, painted);
    save();
    EXPECT_THAT(treatment().check(), testing::IsEmpty());
    both = repeated();
    EXPECT_THAT(both.faults, testing::IsEmpty());
    EXPECT_EQ(both.painted_again, 3);

    // What lies on a layer that was removed cannot be painted again.
    t.ask.remove = "retouch 1";
    settle();
    both = repeated();
    EXPECT_THAT(both.faults, testing::IsEmpty());
    EXPECT_EQ(both.painted_again, 0);
    EXPECT_EQ(both.not_repeated, 3);
}

// Paints mixed on the palette and not used yet are no step; they are not lost.
TEST_F(ControllersStrokes, WhatWasOnlyMixedStaysInTheJournal) {
    begin();
    PaletteEvent piles;
    piles.paints = {"Bone Black", "Titanium White"};
    painter_->send(piles);
    settle();
    painter_->save();
    settle();
    const fs::path file = folder_ / "a.treatment" / "painting.exr";
    EXPECT_EQ(treatment().log().entries().size(), 1u);
    const auto journal = left_over(recovery_files(file));
    ASSERT_TRUE(journal);
    ASSERT_EQ(journal->entries.size(), 2u);
    EXPECT_TRUE(std::holds_alternative<PaintsEvent>(journal->entries[0].event));
    EXPECT_TRUE(std::holds_alternative<PaletteEvent>(journal->entries[1].event));
}

// Strokes of a sitting stay to be recovered where somebody else did a step meanwhile.
TEST_F(ControllersStrokes, AStepOfAnotherProgramIsSaid) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 12;
    draw(70, 80, 90, 80);
    t.ask.keep = true;
    settle();
    stroke(0);
    Mask mask(160, 160);
    mask(80, 80) = 1;
    Treatment::open(folder_ / "a.treatment")
        .record({.action = "draw damage", .masks = {{"loss_to_ground", mask}}}, {"B", "test"});
    painter_->save();
    painter_->wait();
    EXPECT_THAT(painter_->fetch().messages, testing::ElementsAre(HasSubstr("changed by another program")));
    t.ask.fill = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("record"));
    show(folder_ / "a.treatment" / "painting.exr");
    settle();
    EXPECT_TRUE(left_over(recovery_files(folder_ / "a.treatment" / "painting.exr")));
}

// Where the folder is gone, nobody knows where brushes are to stop.
TEST_F(ControllersStrokes, NothingIsPaintedWhileTheFolderIsElsewhere) {
    begin();
    state_.treatment_state.brush_mm = 12;
    draw(70, 80, 90, 80);
    state_.treatment_state.ask.keep = true;
    settle();
    ASSERT_EQ(state_.treatment_state.no_strokes, "");
    const auto look_again = [this] {
        std::this_thread::sleep_for(std::chrono::milliseconds(600));
        settle();
    };
    fs::rename(folder_ / "a.treatment", folder_ / "b.treatment");
    look_again();
    EXPECT_THAT(state_.treatment_state.no_strokes, HasSubstr("not where it was"));
    EXPECT_TRUE(state_.treatment_state.on) << "it is no painting without a treatment";
    fs::rename(folder_ / "b.treatment", folder_ / "a.treatment");
    look_again();
    EXPECT_EQ(state_.treatment_state.no_strokes, "");
    stroke(0);
    EXPECT_GT(state_.painter.painted_px, 50);
    EXPECT_EQ(state_.painter.outside_px, 0);
}

TEST_F(ControllersStrokes, StrokesOfACrashStopAtTheSameDamage) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.where = {DamageClass::abrasion};
    t.current = DamageClass::abrasion;
    t.brush_mm = 12;
    draw(70, 80, 90, 80);
    t.ask.keep = true;
    settle();
    stroke(0);
    const int painted = state_.painter.painted_px;
    EXPECT_GT(painted, 50);
    const fs::path file = folder_ / "a.treatment" / "painting.exr";
    show(file);  // without saving
    settle();
    EXPECT_EQ(t.where, std::set<DamageClass>{DamageClass::abrasion});
    auto journal = left_over(recovery_files(file));
    ASSERT_TRUE(journal);
    painter_->recover(std::move(*journal));
    settle();
    EXPECT_EQ(state_.painter.painted_px, painted);
    EXPECT_EQ(state_.painter.outside_px, 0);
}

}  // namespace
}  // namespace tangi
