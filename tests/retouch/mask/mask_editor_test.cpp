// mask_editor_test.cpp: masks that are drawn by hand: brush, areas, wand, undo; steps that are shared.
#include "retouch/mask/mask_editor.h"

#include <gmock/gmock.h>

#include <cmath>

#include "retouch/treatment/treatment_steps.h"
#include "surface/base/error.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/retouch/damage_truth.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(MaskDraft, TheBrushCoversItsAreaOnceHoweverItIsDrawn) {
    MaskDraft draft(Mask(200, 150));
    draft.begin();
    const Corner a{40, 60}, b{120, 90};
    const Region changed = draft.draw(a, b, 10, MaskEdit::add);
    draft.draw(b, a, 10, MaskEdit::add);
    draft.end();
    const double length = std::hypot(80, 30), area = 20 * length + M_PI * 100;
    EXPECT_NEAR(sum(draft.mask()), area, 0.01 * area);
    double within = 0;
    for (int y = changed.y0; y < changed.y1; ++y)
        for (int x = changed.x0; x < changed.x1; ++x) within += static_cast<double>(draft.mask()(x, y));
    EXPECT_EQ(within, sum(draft.mask())) << "nothing changes outside of what was said";
    draft.begin();
    draft.draw(a, b, 12, MaskEdit::remove);
    draft.end();
    EXPECT_EQ(sum(draft.mask()), 0) << "a wider brush erases all of it";
}

TEST(MaskDraft, BeyondThePictureNothingHappens) {
    MaskDraft draft(Mask(50, 40));
    draft.begin();
    EXPECT_TRUE(draft.draw({-90, 20}, {-60, 20}, 10, MaskEdit::add).empty());
    draft.draw({-5, 20}, {20, 20}, 8, MaskEdit::add);
    draft.end();
    EXPECT_GT(sum(draft.mask()), 0);
    EXPECT_EQ(draft.actions(), 1);
}

TEST(MaskDraft, UndoAndRedoBringBackTheBits) {
    Random random(3);
    Mask start(150, 130);
    for (float& v : start.pixels()) v = static_cast<float>(random.real(0, 1));
    MaskDraft draft(start);
    std::vector<Mask> states = {start};
    for (int i = 0; i < 12; ++i) {
        draft.begin();
        draft.draw({random.real(0, 150), random.real(0, 130)}, {random.real(0, 150), random.real(0, 130)},
                   random.real(1, 30), i % 3 ? MaskEdit::add : MaskEdit::remove);
        draft.end();
        // What changes nothing is no action.
        if (static_cast<std::size_t>(draft.actions()) == states.size()) states.push_back(draft.mask());
    }
    ASSERT_GT(states.size(), 8u);
    for (std::size_t i = states.size() - 1; i-- > 0;) {
        draft.undo();
        ASSERT_TRUE(images_near(draft.mask(), states[i], 0)) << i;
    }
    EXPECT_FALSE(draft.can_undo());
    for (std::size_t i = 1; i < states.size(); ++i) {
        draft.redo();
        ASSERT_TRUE(images_near(draft.mask(), states[i], 0)) << i;
    }
    EXPECT_FALSE(draft.can_redo());
    draft.undo();
    draft.begin();
    draft.draw({10, 10}, {10, 10}, 5, MaskEdit::remove);
    draft.end();
    EXPECT_FALSE(draft.can_redo()) << "what was undone is gone once something else is drawn";
    const int actions = draft.actions();
    draft.begin();
    draft.combine(Mask(150, 130), MaskEdit::add);
    draft.end();
    EXPECT_EQ(draft.actions(), actions) << "nothing changed: there is nothing to undo";
}

TEST(Wand, GoesByColourHeightOrGloss) {
    Surface s = *flat_surface(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            if (x >= 10) s.diffuse(x, y) = {0.6f, 0.1f, 0.1f};
            if (y >= 12) s.height_mm(x, y) = -0.2f;
            if (x >= 30) s.roughness(x, y) = 3 * s.roughness(0, 0);
        }
    s.diffuse(39, 29) = s.diffuse(0, 0);  // alike, but not connected
    EXPECT_EQ(sum(wand(s, 2, 2, WandBy::colour, 5)), 10 * 30);
    EXPECT_EQ(sum(wand(s, 2, 2, WandBy::height, 0.1)), 40 * 12);
    EXPECT_EQ(sum(wand(s, 2, 2, WandBy::gloss, 0.5)), 30 * 30);
    EXPECT_EQ(sum(wand(s, 2, 2, WandBy::gloss, 2)), 40 * 30) << "tolerant enough for all of it";
    EXPECT_THAT([&] { wand(s, 40, 3, WandBy::height, 1); }, ThrowsMessage<Error>(HasSubstr("(40, 3)")));
}

// What a step is told to cover may lie on original, and what is damaged reaches beyond it.
TEST(TreatmentSteps, OnOriginalIsWhatLiesOutsideOfAllMappedDamage) {
    const TestDir dir;
    auto surface = flat_surface(96, 64);
    for (int x = 20; x < 60; ++x)
        for (int y = 20; y < 40; ++y) surface->height_mm(x, y) = -0.3f;
    write_painting(dir / "a.exr", *surface);
    const Author who{"A. Restorer", "test"};
    Treatment treatment = Treatment::begin(dir / "a.treatment", dir / "a.exr", who);
    const auto box = [](int x0, int x1) {
        Mask mask(96, 64);
        for (int y = 20; y < 40; ++y)
            for (int x = x0; x < x1; ++x) mask(x, y) = 1;
        return mask;
    };
    draw_step(treatment, {DamageClass::loss_to_ground, box(20, 30), {{"edit", "by hand"}}}, who);
    draw_step(treatment, {DamageClass::stain, box(30, 40), {{"edit", "by hand"}}}, who);
    const auto fill = [&](int x0, int x1) {
        Canvas canvas = treatment.read_canvas();
        return fill_step(treatment, canvas, {box(x0, x1)}, {FillTexture::smooth, Rgb(0.8f)}, who);
    };
    const auto within = fill(25, 38), beyond = fill(38, 50);
    EXPECT_EQ(within["on_original"]["pixels"], 0);
    EXPECT_FALSE(within.contains("warnings"));
    EXPECT_EQ(beyond["on_original"]["pixels"], 10 * 20);
    EXPECT_EQ(beyond["outside_area"]["pixels"], 0);
    EXPECT_THAT(beyond["warnings"][0].get<std::string>(), HasSubstr("200 pixels of it lie on original"));
}

TEST(TreatmentSteps, WhatIsPaintedBesideTheAreaIsCountedAndLogged) {
    const TestDir dir;
    write_painting(dir / "a.exr", *flat_surface(96, 64));
    const Author who{"A. Restorer", "test"};
    Treatment treatment = Treatment::begin(dir / "a.treatment", dir / "a.exr", who);
    Mask loss(96, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 48; ++x) loss(x, y) = 1;
    draw_step(treatment, {DamageClass::loss_to_ground, loss, {{"edit", "by hand"}}}, who);
    const StepArea area = area_of_classes(treatment, {DamageClass::loss_to_ground});
    EXPECT_EQ(sum(area.mask), 48 * 64);
    EXPECT_THAT(
        [&] {
            Canvas bare = treatment.read_canvas();
            retouch_step(treatment, bare, {area, {}, "the canvas"}, who);
        },
        ThrowsMessage<Error>(HasSubstr("the canvas: nothing was painted")));
    Canvas canvas = treatment.read_canvas();
    Brush brush(even_brush(3), canvas.mm_per_pixel(), 1);
    brush.load({{{add_paint(canvas, "Titanium White"), 1.0}}}, 1, false);
    stroke(canvas, brush, {-8, 0}, {8, 0});
    const auto result = retouch_step(treatment, canvas, {area, {}, "the canvas"}, who);
    EXPECT_GT(result["retouches"][0]["on_original"]["pixels"].get<int>(), 100);
    EXPECT_EQ(result["retouches"][0]["on_original"], result["retouches"][0]["outside_area"]);
    ASSERT_EQ(result["warnings"].size(), 1u);
    EXPECT_THAT(result["warnings"][0].get<std::string>(), HasSubstr("on original"));
    const Treatment again = Treatment::open(dir / "a.treatment");
    ASSERT_EQ(again.layers().size(), 1u);
    EXPECT_EQ(again.log().entries().back().content["results"], result);
    EXPECT_TRUE(again.check().empty());
    Canvas painted = treatment.read_canvas();
    EXPECT_THAT([&] { remove_step(treatment, painted, {}, who); },
                ThrowsMessage<Error>(HasSubstr("no layer to take off")));
    remove_step(treatment, painted, {again.layers().front().name}, who);
    EXPECT_TRUE(treatment.layers().empty());
}

TEST(TreatmentSteps, AMaskThatWasDrawnIsUndoneToWhatItWasBefore) {
    const TestDir dir;
    write_painting(dir / "a.exr", *flat_surface(96, 64));
    const Author who{"A. Restorer", "test"};
    Treatment treatment = Treatment::begin(dir / "a.treatment", dir / "a.exr", who);
    const auto band = [](int rows) {
        Mask mask(96, 64);
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < 96; ++x) mask(x, y) = 1;
        return mask;
    };
    for (const int rows : {10, 20, 30}) draw_step(treatment, {DamageClass::stain, band(rows), {}}, who);
    draw_step(treatment, {DamageClass::abrasion, band(5), {}}, who);
    Canvas canvas = treatment.read_canvas();
    const auto undo = [&] { return undo_step(treatment, canvas, who); };
    EXPECT_EQ(undo()["restored"], nlohmann::json({"abrasion"}));
    EXPECT_EQ(sum(treatment.mask(DamageClass::abrasion)), 0);
    for (const int rows : {20, 10}) {
        EXPECT_EQ(undo()["restored"], nlohmann::json({"stain"}));
        EXPECT_EQ(sum(treatment.mask(DamageClass::stain)), rows * 96);
    }
    draw_step(treatment, {DamageClass::stain, band(40), {}}, who);  // after undoing
    undo();
    EXPECT_EQ(sum(treatment.mask(DamageClass::stain)), 10 * 96) << "as the undoing left it";
    EXPECT_EQ(undo()["undone"]["line"], 2);
    EXPECT_EQ(sum(treatment.mask(DamageClass::stain)), 0);
    EXPECT_THAT([&] { undo(); }, ThrowsMessage<Error>(HasSubstr("no step to undo")));
    EXPECT_TRUE(Treatment::open(dir / "a.treatment").check().empty()) << "what was kept is in the log";

    // What was kept is believed only as it was logged.
    draw_step(treatment, {DamageClass::stain, band(3), {}}, who);
    const auto kept = treatment.log().entries().back().content["kept"]["stain"].get<std::string>();
    write_mask(treatment.folder() / kept, band(50));
    EXPECT_THAT([&] { undo(); }, ThrowsMessage<Error>(HasSubstr("is not the mask that line")));
    EXPECT_FALSE(treatment.check().empty());
}

}  // namespace
}  // namespace tangi
