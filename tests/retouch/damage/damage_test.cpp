// damage_test.cpp: what is suggested on paintings whose damage is known.
#include <gmock/gmock.h>

#include <limits>

#include "retouch/damage/area_suggestion.h"
#include "retouch/mask/mask_editor.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "tests/support/long_test.h"
#include "tests/support/retouch/damage_truth.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

const PaintingTruth& painting() {
    static const PaintingTruth truth = square_painting(320, 0.3);
    return truth;
}

TEST(DamageSuggestion, FindsTheLosses) {
    const Surface surface = surface_of(painting());
    const DamageSuggestion loss = suggest_loss(surface, painting().mm_per_pixel);
    EXPECT_GT(intersection_over_union(loss.mask, mask_of(painting().loss)), 0.8);
    // Sure where it suggests, and everywhere within 0..1.
    for (std::size_t i = 0; i < loss.mask.size(); ++i) {
        const float confidence = loss.confidence.pixels()[i];
        ASSERT_TRUE(confidence >= 0 && confidence <= 1);
        ASSERT_TRUE(loss.mask.pixels()[i] == 0 || confidence >= 0.5f);
    }
}

TEST(DamageSuggestion, FindsNoLossInAPaintingWithoutAny) {
    PaintingOptions options;
    options.seed = 5;
    options.width = options.height = 320;
    options.mm_per_pixel = 0.3;
    options.losses = false;
    options.craquelure = 0;
    const Surface surface = surface_of(procedural_painting(options));
    EXPECT_LT(area_of(suggest_loss(surface, 0.3).mask, 0.3).percent, 0.5);
    EXPECT_LT(suggest_craquelure(surface, 0.3).measure.length_mm, 150);
}

TEST(DamageSuggestion, FindsTheCraquelure) {
    const CraquelureSuggestion cracks = suggest_craquelure(surface_of(painting()), painting().mm_per_pixel);
    EXPECT_GT(f1(cracks.mask, mask_of(painting().craquelure), 2), 0.6);
    const CraquelureMeasure truth = measure_lines(mask_of(painting().craquelure), painting().mm_per_pixel);
    EXPECT_NEAR(cracks.measure.length_mm, truth.length_mm, 0.3 * truth.length_mm);
    EXPECT_NEAR(cracks.measure.width_mm, truth.width_mm, 0.5 * truth.width_mm);
}

TP_LONG TEST(DamageSuggestion, TellsVarnishAndRetouchApartByGloss) {
    const GlossSuggestion gloss = suggest_gloss(surface_of(painting()), painting().mm_per_pixel);
    const Mask varnish = mask_of(painting().varnish), retouch = mask_of(painting().retouch);
    EXPECT_GT(intersection_over_union(gloss.glossier.mask, varnish), 0.8);
    EXPECT_GT(sum(intersected(gloss.matter.mask, retouch)), 0.8 * sum(retouch));
    EXPECT_LT(sum(intersected(gloss.matter.mask, varnish)), 0.05 * sum(varnish));
    EXPECT_LT(sum(intersected(gloss.glossier.mask, retouch)), 0.05 * sum(retouch));
}

TP_LONG TEST(DamageSuggestion, DoesNotDependOnThreadsOrOnTheUnitOfHeight) {
    Surface surface = surface_of(painting());
    const double mm = painting().mm_per_pixel;
    const Mask cracks = suggest_craquelure(surface, mm).mask, loss = suggest_loss(surface, mm).mask;
    set_thread_count(1);
    EXPECT_EQ(intersection_over_union(suggest_craquelure(surface, mm).mask, cracks), 1);
    EXPECT_EQ(intersection_over_union(suggest_loss(surface, mm).mask, loss), 1);
    set_thread_count(0);
    // The same painting in pixels, whose size is told.
    for (float& height : surface.height_mm.pixels()) height /= static_cast<float>(mm);
    surface.mm_per_pixel = 1;
    EXPECT_GT(intersection_over_union(suggest_loss(surface, mm).mask, loss), 0.99);
}

// Paintings by other seeds than those that the suggestions were made with (1 to 8).
PaintingOptions worn(std::uint64_t seed, bool damaged) {
    PaintingOptions options;
    options.seed = seed;
    options.width = 400;
    options.height = 360;
    options.mm_per_pixel = 0.3;
    options.impasto = 0.55;
    options.abrasion = options.flaking = options.stain = options.old_fill = options.overpaint = damaged;
    return options;
}

TEST(AreaSuggestion, FindsOldFillsAndOverpaintAmongOtherDamage) {
    const PaintingTruth truth = procedural_painting(worn(101, true));
    const Surface surface = surface_of(truth);
    const AreaSuggestion fill = suggest_areas(surface, 0.3, DamageClass::old_fill);
    EXPECT_GT(intersection_over_union(fill.mask, mask_of(truth.old_fill)), 0.6);
    const AreaSuggestion over = suggest_areas(surface, 0.3, DamageClass::overpaint);
    EXPECT_GT(intersection_over_union(over.mask, mask_of(truth.overpaint)), 0.6);
    for (const AreaSuggestion* s : {&fill, &over}) {
        ASSERT_FALSE(s->areas.empty());
        EXPECT_GE(s->areas.front().confidence, s->areas.back().confidence);
        for (const SuggestedArea& area : s->areas) {
            EXPECT_GE(area.confidence, 0.5);
            EXPECT_FALSE(area.cues.empty());
        }
        for (std::size_t i = 0; i < s->mask.size(); ++i)
            ASSERT_TRUE(s->mask.pixels()[i] == 0 || s->confidence.pixels()[i] >= 0.5f);
    }
}

TP_LONG TEST(AreaSuggestion, FindsNothingToSpeakOfInSoundPaint) {
    const Surface surface = surface_of(procedural_painting(worn(114, false)));
    for (const DamageClass damage : kAreaClasses)
        EXPECT_LT(area_of(suggest_areas(surface, 0.3, damage).mask, 0.3).percent, 0.5) << name_of(damage);
}

TEST(AreaSuggestion, FindsAStainOnAPlainGroundButNotWhatChangesMoreThanColour) {
    PaintingOptions options = worn(203, true);
    options.coverage = 0;
    options.varnish = options.retouch = false;
    const PaintingTruth truth = procedural_painting(options);
    const Mask stain = mask_of(truth.stain);
    Surface surface = surface_of(truth);
    const Mask found = suggest_areas(surface, 0.3, DamageClass::stain).mask;
    EXPECT_GT(intersection_over_union(found, stain), 0.7);
    EXPECT_GT(sum(intersected(found, stain)), 0.9 * sum(found));
    // The same colours, as paint: with a gloss of their own, and on top.
    for (std::size_t i = 0; i < stain.size(); ++i)
        if (stain.pixels()[i] > 0) {
            surface.roughness.pixels()[i] *= 0.6f;
            surface.height_mm.pixels()[i] += 0.1f;
        }
    EXPECT_EQ(sum(suggest_areas(surface, 0.3, DamageClass::stain).mask), 0);
    EXPECT_GT(intersection_over_union(suggest_areas(surface, 0.3, DamageClass::overpaint).mask, stain), 0.7);
}

TEST(AreaSuggestion, FindsPlatesWhoseEdgesComeUpButNotCraquelure) {
    PaintingTruth truth = procedural_painting(worn(102, true));
    Surface surface = surface_of(truth);
    const AreaSuggestion found = suggest_areas(surface, 0.3, DamageClass::flaking);
    EXPECT_GT(intersection_over_union(found.mask, mask_of(truth.flaking)), 0.5);
    ASSERT_FALSE(found.areas.empty());
    EXPECT_THAT(found.areas.front().cues, testing::HasSubstr("stand open"));
    // The same cracks in paint that lies flat: its edges pressed down to the plates behind them.
    for (std::size_t i = 0; i < surface.height_mm.size(); ++i)
        if (truth.flaking.pixels()[i])
            surface.height_mm.pixels()[i] = std::min(surface.height_mm.pixels()[i], 0.3f);
    EXPECT_LT(sum(suggest_areas(surface, 0.3, DamageClass::flaking).mask), 0.3 * sum(found.mask));
}

TEST(AreaSuggestion, FindsAStainThatGoesOnOverStrokes) {
    const PaintingTruth truth = procedural_painting(worn(105, true));
    const Mask stain = mask_of(truth.stain);
    Surface surface = surface_of(truth);
    EXPECT_GT(intersection_over_union(suggest_areas(surface, 0.3, DamageClass::stain).mask, stain), 0.7);
    // What absorbs alike at all wavelengths is a shadow, soot or black paint.
    for (std::size_t i = 0; i < stain.size(); ++i)
        if (stain.pixels()[i] > 0) {
            Rgb& rho = surface.diffuse.pixels()[i];
            rho.r *= 0.8f, rho.g *= 0.9f;
        }
    EXPECT_EQ(sum(intersected(suggest_areas(surface, 0.3, DamageClass::stain).mask, stain)), 0);
}

TEST(AreaSuggestion, FindsPaintThatWasRubbedOffTheThreads) {
    const PaintingTruth truth = procedural_painting(worn(102, true));
    const Mask abrasion = mask_of(truth.abrasion);
    Surface surface = surface_of(truth);
    const AreaSuggestion found = suggest_areas(surface, 0.3, DamageClass::abrasion);
    EXPECT_GT(intersection_over_union(found.mask, abrasion), 0.6);
    ASSERT_FALSE(found.areas.empty());
    EXPECT_THAT(found.areas.front().cues, testing::HasSubstr("times the colours for its relief"));
    // As matt and low, but of one colour: thin paint.
    const Mask wide = dilated(abrasion, 4);
    for (std::size_t i = 0; i < abrasion.size(); ++i)
        if (wide.pixels()[i] > 0) surface.diffuse.pixels()[i] = Rgb(0.3f, 0.25f, 0.2f);
    EXPECT_EQ(sum(intersected(suggest_areas(surface, 0.3, DamageClass::abrasion).mask, abrasion)), 0);
}

TP_LONG TEST(AreaSuggestion, DoesNotDependOnThreadsOrOnTheUnitOfHeightAndBearsNumbersThatAreNone) {
    Surface surface = surface_of(procedural_painting(worn(104, true)));
    const Mask before = suggest_areas(surface, 0.3, DamageClass::old_fill).mask;
    set_thread_count(1);
    EXPECT_EQ(intersection_over_union(suggest_areas(surface, 0.3, DamageClass::old_fill).mask, before), 1);
    set_thread_count(0);
    for (float& height : surface.height_mm.pixels()) height /= 0.3f;
    surface.mm_per_pixel = 1;
    EXPECT_GT(intersection_over_union(suggest_areas(surface, 0.3, DamageClass::old_fill).mask, before), 0.99);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x)
            surface.height_mm(x, y) = surface.roughness(x, y) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_GT(intersection_over_union(suggest_areas(surface, 0.3, DamageClass::old_fill).mask, before), 0.95);
    EXPECT_THROW(suggest_areas(surface, 0.3, DamageClass::craquelure), ContractError);
}

TEST(DamageSuggestion, SmallAndFlatPicturesHaveNone) {
    for (const int size : {4, 40}) {
        Surface flat(size, size);
        for (float& confidence : flat.confidence.pixels()) confidence = 1;
        for (Rgb& colour : flat.diffuse.pixels()) colour = Rgb(0.5f);
        EXPECT_EQ(sum(suggest_loss(flat, 1).mask), 0);
        EXPECT_EQ(sum(suggest_craquelure(flat, 1).mask), 0);
        EXPECT_TRUE(suggest_gloss(flat, 1).patches.empty());
        for (const DamageClass damage : kAreaClasses)
            EXPECT_TRUE(suggest_areas(flat, 1, damage).areas.empty()) << name_of(damage);
    }
    LossOptions wrong;
    wrong.depth_mm = -1;
    EXPECT_THROW(suggest_loss(Surface(40, 40), 1, wrong), Error);
}

TEST(MeasureLines, OfACrossAreKnown) {
    // Two lines of 100 px, 3 px wide, at right angles; pixels of 0.1 mm.
    Mask cross(128, 128);
    for (int i = 14; i < 114; ++i)
        for (int w = 63; w < 66; ++w) cross(i, w) = cross(w, i) = 1;
    const CraquelureMeasure measure = measure_lines(cross, 0.1);
    EXPECT_NEAR(measure.length_mm, 20, 0.8);
    EXPECT_NEAR(measure.width_mm, 0.3, 0.02);
    EXPECT_EQ(measure.pieces, 1);
    EXPECT_NEAR(measure.density_per_cm, measure.length_mm / 10 / 1.6384, 1e-9);
    // A diagonal is as long as it is.
    Mask diagonal(100, 100);
    for (int i = 10; i < 90; ++i) diagonal(i, i) = 1;
    EXPECT_NEAR(measure_lines(diagonal, 1).length_mm, 79 * std::sqrt(2.0), 1e-6);
    EXPECT_EQ(measure_lines(Mask(20, 20), 1).length_mm, 0);
}

TEST(Wand, TakesWhatIsConnectedAndOfOneColour) {
    Surface surface(40, 40);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x)
            surface.diffuse(x, y) = x < 10 || x > 29 ? Rgb(0.5f, 0.1f, 0.1f) : Rgb(0.1f, 0.1f, 0.5f);
    EXPECT_EQ(sum(wand(surface, 3, 3, WandBy::colour, 5)), 400);
    EXPECT_EQ(sum(wand(surface, 20, 3, WandBy::colour, 5)), 800);
    EXPECT_EQ(sum(wand(surface, 3, 3, WandBy::colour, 200)), 1600);
    EXPECT_THROW(wand(surface, 40, 3, WandBy::colour, 5), Error);
}

}  // namespace
}  // namespace tangi
