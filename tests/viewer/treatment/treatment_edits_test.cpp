// treatment_edits_test.cpp: the desk of treatments: steps that are undone, corrections that are not in
// the log, and what is said of them.
#include <gmock/gmock.h>

#include "tests/support/viewer/treatment_controllers.h"

namespace tangi {
namespace {

using testing::HasSubstr;

class ControllerEdits : public TreatmentControllers {
protected:
    const DamageRow& loss() const {
        return state_.treatment_state.damage[static_cast<std::size_t>(DamageClass::loss_to_ground)];
    }
};

TEST_F(ControllerEdits, WhatWasTakenOffComesBackByUndo) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 12;
    draw(60, 80, 100, 80);
    t.ask.keep = true;
    settle();
    EXPECT_EQ(t.next_undo.step, "draw loss to ground");
    t.ask.isolate = true;
    settle();
    t.ask.varnish = true;
    settle();
    ASSERT_EQ(t.layers.size(), 2u) << testing::PrintToString(said_);
    EXPECT_EQ(t.next_undo.step, "lay varnish 1");
    const std::vector<TreatmentLayer> before = treatment().layers();
    t.layers_moved = false;
    t.ask.remove = "isolating varnish 1";
    settle();
    ASSERT_EQ(t.layers.size(), 1u) << testing::PrintToString(said_);
    EXPECT_TRUE(t.layers_moved);
    EXPECT_EQ(t.next_undo.step, "take off isolating varnish 1");
    t.ask.undo_step = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("isolating varnish 1 on the painting again"));
    const std::vector<TreatmentLayer> after = treatment().layers();
    ASSERT_EQ(after.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(after[i].name, before[i].name);
        EXPECT_EQ(after[i].sha256, before[i].sha256);
    }
    EXPECT_THAT(treatment().check(), testing::IsEmpty());
    EXPECT_EQ(t.next_undo.step, "lay varnish 1");
}

TEST_F(ControllerEdits, NoReportLeavesOutWhatIsNotInTheLog) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 12;
    draw(60, 80, 100, 80);
    const std::filesystem::path html = folder_ / "report.html";
    const auto is_refused = [&](const char* why) {
        t.ask.report_wanted = true;
        settle();
        EXPECT_FALSE(std::exchange(t.ask.report_dialog, false)) << why;
        EXPECT_THAT(said_.back(), HasSubstr(why));
        said_.clear();
        t.ask.report = html;
        settle();
        EXPECT_FALSE(std::filesystem::exists(html)) << why;
        EXPECT_THAT(said_.back(), HasSubstr(why));
    };
    is_refused("first enter the corrections of the map");
    t.ask.keep = true;
    settle();
    stroke(0);
    ASSERT_TRUE(state_.painter.unsaved);
    is_refused("first record what was painted");
    painter_->save();
    settle();
    state_.left_over_strokes = 3;
    is_refused("first recover the strokes");
    state_.left_over_strokes = 0;
    t.ask.report_wanted = true;
    documents_->take();
    EXPECT_TRUE(std::exchange(t.ask.report_dialog, false));
    t.ask.report = html;
    settle();
    EXPECT_TRUE(std::filesystem::exists(html)) << testing::PrintToString(said_);
}

TEST_F(ControllerEdits, TheLegendCountsCorrections) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 6;
    draw(20, 20, 60, 20);
    ASSERT_TRUE(loss().corrected);
    EXPECT_EQ(loss().corrected->count, 1);
    EXPECT_FALSE(loss().there) << "not in the log";
    const double one = loss().corrected->area_cm2;
    draw(20, 140, 60, 140);
    EXPECT_EQ(loss().corrected->count, 2);
    EXPECT_NEAR(loss().corrected->area_cm2, 2 * one, 0.01 * one);
    t.ask.undo = true;
    settle();
    EXPECT_EQ(loss().corrected->count, 1);
    t.ask.keep = true;
    settle();
    EXPECT_FALSE(loss().corrected);
    EXPECT_NEAR(loss().logged.area_cm2, one, 1e-6);
    draw(20, 140, 60, 140);
    EXPECT_EQ(loss().corrected->count, 2);
    EXPECT_EQ(loss().logged.count, 1);
    t.ask.varnish = true;  // a step of something else leaves them
    settle();
    ASSERT_TRUE(loss().corrected);
    t.ask.drop_edits = true;
    settle();
    EXPECT_FALSE(loss().corrected);
}

TEST_F(ControllerEdits, PolygonsThatDrawNothingSayWhy) {
    begin();
    TreatmentState& t = state_.treatment_state;
    const auto polygon = [&](const Polygon& corners) {
        said_.clear();
        t.touches.push_back({MaskTouch::Kind::polygon, {}, false, corners});
        settle();
    };
    polygon({{20, 20}, {40, 40}, {60, 60}});
    EXPECT_THAT(said_, testing::ElementsAre(HasSubstr("encloses nothing")));
    polygon({{20.4, 20.4}, {20.8, 20.4}, {20.8, 20.8}});
    EXPECT_THAT(said_, testing::ElementsAre(HasSubstr("no pixel by half")));
    EXPECT_EQ(t.edits, 0);
    // Under way while the map is entered in the log: not part of it, and still there.
    t.polygon = {{100, 100}, {120, 100}, {120, 120}};
    said_.clear();
    t.ask.keep = true;
    settle();
    EXPECT_THAT(said_, testing::ElementsAre(HasSubstr("not closed")));
    polygon({{20, 20}, {40, 20}, {40, 40}});
    EXPECT_EQ(t.edits, 1);
    t.ask.keep = true;
    settle();
    EXPECT_THAT(said_.back(), testing::AllOf(HasSubstr("is in the log"), HasSubstr("not closed")));
    EXPECT_EQ(t.polygon.size(), 3u);
    EXPECT_EQ(treatment().mask(DamageClass::loss_to_ground)(115, 105), 0);
}

}  // namespace
}  // namespace tangi
