// treatment_controller_test.cpp: a treatment beside the window, without one: damage is suggested and drawn,
// filled, retouched; painting stops at it; all of it is in the log.
#include <gmock/gmock.h>

#include "paint/canvas/appearance.h"
#include "surface/file/atomic_file.h"
#include "tests/support/viewer/treatment_controllers.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr auto kLoss = static_cast<std::size_t>(DamageClass::loss_to_ground);

using Controllers = TreatmentControllers;

TEST_F(Controllers, TheWholeSequenceIsInTheLog) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.ask.suggest = true;
    settle();
    ASSERT_TRUE(t.suggestion) << testing::PrintToString(said_);
    EXPECT_FALSE(treatment().has_mask(DamageClass::loss_to_ground)) << "a suggestion changes nothing";
    const int all = t.suggestion->shown;
    ASSERT_GT(all, 0);
    t.suggestion->threshold = 1;
    settle();
    EXPECT_LT(t.suggestion->shown, all) << "the slider leaves out what is less sure";
    t.suggestion->threshold = 0.5f;
    settle();
    t.ask.accept = true;
    settle();
    ASSERT_TRUE(t.damage[kLoss].there);
    EXPECT_GT(t.damage[kLoss].logged.area_cm2, 0);

    // Corrected by hand, undone, redone, and kept.
    const double before = t.damage[kLoss].logged.area_cm2;
    t.brush_mm = 6;
    draw(20, 20, 60, 20);
    draw(20, 140, 60, 140);
    t.ask.undo = true;
    settle();
    EXPECT_EQ(t.edits, 1);
    t.ask.keep = true;
    settle();
    EXPECT_EQ(t.edits, 0);
    const Mask mask = treatment().mask(DamageClass::loss_to_ground);
    EXPECT_EQ(mask(40, 20), 1);
    EXPECT_EQ(mask(40, 140), 0);
    EXPECT_GT(t.damage[kLoss].logged.area_cm2, before);

    t.ask.fill = true;
    settle();
    t.ask.isolate = true;
    settle();
    ASSERT_EQ(t.layers.size(), 2u) << testing::PrintToString(said_);
    EXPECT_EQ(t.layers[0].on_original.pixels, 0);

    // Strokes right across the picture end at the mask.
    ASSERT_EQ(t.no_strokes, "");
    const double y_mm = (79.5 - 20) * 0.5;
    stroke(y_mm);
    EXPECT_GT(state_.painter.painted_px, 50);
    EXPECT_EQ(state_.painter.outside_px, 0);
    t.ask.varnish = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("first record")) << "no step over strokes that are not logged";
    painter_->save();
    settle();
    ASSERT_EQ(t.layers.size(), 3u);
    EXPECT_EQ(t.layers[2].role, LayerRole::retouch);
    EXPECT_FALSE(state_.painter.unsaved);
    EXPECT_EQ(state_.painter.painted_px, 0);

    t.confined = false;
    settle();
    stroke(y_mm);
    EXPECT_GT(state_.painter.outside_px, 50) << "counted as it is painted";
    painter_->save();
    settle();
    EXPECT_GT(t.layers[3].on_original.pixels, 50);
    t.ask.varnish = true;
    settle();
    EXPECT_EQ(t.layers.size(), 5u);

    EXPECT_TRUE(treatment().check().empty());
    std::vector<std::string> actions;
    const Treatment done = treatment();
    for (const LogEntry& entry : done.log().entries())
        actions.push_back(entry.content["action"].get<std::string>());
    EXPECT_THAT(actions, testing::ElementsAre("begin", "suggest damage", "draw damage", "fill", "varnish",
                                              "retouch", "retouch", "varnish"));
    EXPECT_EQ(t.log.size(), actions.size());

    // Reopened, it is as it was left; taken off, it is the original.
    show(folder_ / "a.treatment" / "painting.exr");
    settle();
    EXPECT_FALSE(t.confined) << "as it was left";
    EXPECT_EQ(t.layers.size(), 5u);
    t.ask.undo_step = true;
    settle();
    EXPECT_EQ(t.layers.size(), 4u) << "the varnish is off";
    EXPECT_EQ(t.log.size(), actions.size() + 1) << "and both are in the log";
    EXPECT_THAT(t.log.front().action, testing::StartsWith("undo"));
    draw(20, 140, 60, 140);
    t.ask.undo_step = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("first enter the corrections"));
    t.ask.keep = true;
    settle();
    t.ask.undo_step = true;
    settle();
    EXPECT_EQ(treatment().mask(DamageClass::loss_to_ground)(40, 140), 0) << "as it was before";
    t.ask.remove_all = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("bit for bit"));
    EXPECT_EQ(sha256_of(appearance(treatment().read_canvas())), treatment().dry_sha256());
}

TEST_F(Controllers, AreasOfOtherClassesAreLookedForAndChangeNothing) {
    begin();
    TreatmentState& t = state_.treatment_state;
    for (const auto& [what, as] : {std::pair(Suggesting::old_fill, DamageClass::old_fill),
                                   {Suggesting::overpaint, DamageClass::overpaint},
                                   {Suggesting::stain, DamageClass::stain},
                                   {Suggesting::abrasion, DamageClass::abrasion}}) {
        t.suggesting = what;
        t.ask.suggest = true;
        settle();
        ASSERT_TRUE(t.suggestion) << testing::PrintToString(said_);
        EXPECT_EQ(t.suggestion->as, as);
        EXPECT_EQ(t.suggestion->threshold, 0.5f) << "what is less sure is offered, not shown";
        EXPECT_LE(t.suggestion->shown, t.suggestion->regions);
        EXPECT_FALSE(treatment().has_mask(as));
    }
}

// What was laid with other settings, or on other damage, is not what one would apply.
TEST_F(Controllers, AStalePreviewIsNotApplied) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 12;
    draw(60, 80, 100, 80);
    t.ask.keep = true;
    settle();
    const auto preview = [&] {
        t.ask.preview = true;
        settle();
        ASSERT_TRUE(t.preview) << testing::PrintToString(said_);
        ASSERT_FALSE(t.preview->stale);
    };
    const auto is_refused = [&](const char* what) {
        settle();
        EXPECT_TRUE(t.preview && t.preview->stale) << what;
        t.ask.apply = true;
        settle();
        EXPECT_TRUE(t.layers.empty()) << what;
        EXPECT_THAT(said_.back(), HasSubstr("preview it again")) << what;
    };
    preview();
    t.retouch.thickness_mm *= 2;
    is_refused("another film");
    t.retouch.thickness_mm /= 2;
    settle();
    EXPECT_FALSE(t.preview->stale) << "as it was laid";
    t.mode = RetouchMode::neutral;
    is_refused("another kind");
    preview();
    t.illuminants[0] = !t.illuminants[0];
    is_refused("other illuminants");
    preview();
    draw(30, 30, 40, 30);
    t.ask.keep = true;
    is_refused("more damage");
    preview();
    t.ask.apply = true;
    settle();
    EXPECT_EQ(t.layers.size(), 1u) << testing::PrintToString(said_);
}

TEST_F(Controllers, AStaleSuggestionIsNotTakenOver) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.ask.suggest = true;
    settle();
    ASSERT_TRUE(t.suggestion && t.suggestion->shown > 0) << testing::PrintToString(said_);
    const double before = t.loss.depth_mm;
    t.loss.depth_mm *= 1.5;
    settle();
    EXPECT_TRUE(t.suggestion->stale);
    t.ask.accept = true;
    settle();
    EXPECT_FALSE(treatment().has_mask(DamageClass::loss_to_ground));
    EXPECT_THAT(said_.back(), HasSubstr("suggest again"));
    t.loss.depth_mm = before;
    t.suggesting = Suggesting::gloss;
    settle();
    EXPECT_FALSE(t.suggestion->stale) << "it is of losses";
    t.ask.accept = true;
    settle();
    EXPECT_TRUE(treatment().has_mask(DamageClass::loss_to_ground)) << testing::PrintToString(said_);
}

TEST_F(Controllers, ARetouchIsLookedAtBeforeItIsApplied) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 12;
    draw(60, 80, 100, 80);
    t.ask.keep = true;
    settle();
    t.mode = RetouchMode::tratteggio;
    t.retouch.pitch_mm = 2;
    t.retouch.width_mm = 1;
    t.ask.preview = true;
    settle();
    ASSERT_TRUE(t.preview) << testing::PrintToString(said_);
    EXPECT_THAT(t.preview->lines, HasSubstr("2.00 mm apart"));
    EXPECT_EQ(t.preview->outside_px, 0);
    EXPECT_THAT(t.no_strokes, HasSubstr("previewed"));
    EXPECT_TRUE(t.layers.empty());
    const auto colour_there = [&] {
        Rgb sum(0);
        painter_
            ->look([&](const Surface& seen, const Canvas&) {
                for (int x = 60; x < 100; ++x) sum += seen.diffuse(x, 80);
            })
            .get();
        return sum;
    };
    painter_->wait();
    const Rgb previewed = colour_there();
    t.ask.drop_preview = true;
    settle();
    EXPECT_NE(colour_there(), previewed) << "seen, then gone";
    t.ask.preview = true;
    settle();
    t.ask.apply = true;
    settle();
    ASSERT_EQ(t.layers.size(), 1u) << testing::PrintToString(said_);
    EXPECT_EQ(colour_there(), previewed) << "what is applied is what was looked at";
    EXPECT_EQ(treatment().log().entries().back().content["parameters"]["mode"], "tratteggio");

    // States: without the retouch, and with it.
    t.state = TreatmentStage::before;
    settle();
    EXPECT_NE(colour_there(), previewed);
    EXPECT_THAT(t.no_strokes, HasSubstr("choose Now"));
    t.state.reset();
    settle();
    EXPECT_EQ(colour_there(), previewed);
    t.right = TreatmentStage::retouched;
    t.ask.compare_states = true;
    settle();
    ASSERT_TRUE(state_.comparing.shows());
    EXPECT_NE(state_.comparing.pair->pictures->photo(80, 80), state_.comparing.pair->pictures->relit(80, 80));
    EXPECT_EQ(state_.comparing.pair->pictures->photo(10, 10), state_.comparing.pair->pictures->relit(10, 10));
    t.distance_m = 5;
    t.ask.see_from = true;
    settle();
    EXPECT_EQ(state_.comparing.pair->right, "from 5.0 m");
}

TEST_F(Controllers, CorrectionsAreKeptWhenTheWindowCloses) {
    begin();
    state_.treatment_state.brush_mm = 12;
    draw(70, 80, 90, 80);
    EXPECT_EQ(state_.treatment_state.edits, 1);
    documents_->keep_now();
    EXPECT_EQ(state_.treatment_state.edits, 0);
    EXPECT_EQ(treatment().mask(DamageClass::loss_to_ground)(80, 80), 1);
    EXPECT_THAT(treatment().check(), testing::IsEmpty());
}

TEST_F(Controllers, AWholeAreaGoesAwayByAClick) {
    begin();
    state_.treatment_state.brush_mm = 6;
    draw(20, 20, 60, 20);
    draw(20, 140, 60, 140);
    const auto click = [&](double x, double y) {
        state_.treatment_state.touches.push_back({MaskTouch::Kind::area, {x, y}, true});
        settle();
    };
    said_.clear();
    click(100.5, 80.5);
    EXPECT_THAT(said_, testing::ElementsAre(HasSubstr("Loss to ground")));
    EXPECT_EQ(state_.treatment_state.edits, 2) << "nothing lies there";
    click(30.5, 139.5);
    EXPECT_EQ(state_.treatment_state.edits, 3);
    state_.treatment_state.ask.keep = true;
    settle();
    const Mask mask = treatment().mask(DamageClass::loss_to_ground);
    EXPECT_EQ(mask(40, 20), 1);
    for (int x = 0; x < 160; ++x)
        for (int y = 120; y < 160; ++y) ASSERT_EQ(mask(x, y), 0) << "no speck is left";
}

TEST(PanelWords, FlagsAreCalledAsThePanelDoes) {
    EXPECT_EQ(in_panel_words("look farther with --search-mm, or choose another --texture"),
              "look farther with search mm, or choose another texture");
    EXPECT_EQ(in_panel_words("-- and a--b stay, and --5"), "-- and a--b stay, and --5");
    EXPECT_EQ(in_panel_words("change it with tangipaint damage --mask"),
              "change it with tangipaint damage --mask");
}

TEST_F(Controllers, AnEditedLogIsSaidAndNothingIsDone) {
    begin();
    state_.treatment_state.brush_mm = 10;
    draw(80, 80, 90, 80);
    state_.treatment_state.ask.keep = true;
    settle();
    write_mask(folder_ / "a.treatment" / "masks" / "loss_to_ground.png", Mask(160, 160, 1.0f));
    state_.treatment_state.ask.check = true;
    settle();
    ASSERT_FALSE(state_.treatment_state.usable);
    EXPECT_THAT(state_.treatment_state.faults.front(), HasSubstr("loss_to_ground.png"));
    EXPECT_THAT(state_.treatment_state.no_strokes, HasSubstr("not as its log says"));
    state_.treatment_state.ask.fill = true;
    settle();
    EXPECT_TRUE(treatment().layers().empty());

    std::string log = read_text_file(folder_ / "a.treatment" / "log.jsonl");
    log[log.find("A. Restorer")] = 'B';
    write_text_file(folder_ / "a.treatment" / "log.jsonl", log);
    show(folder_ / "a.treatment" / "painting.exr");
    settle();
    EXPECT_FALSE(state_.treatment_state.on);
    EXPECT_THAT(said_.back(), HasSubstr("log.jsonl:1: was edited"));
}

}  // namespace
}  // namespace tangi
