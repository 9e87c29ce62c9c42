// treatment_test.cpp: the folder of a treatment: its layers, and that nothing is lost.
#include "retouch/treatment/treatment.h"

#include <gmock/gmock.h>

#include "paint/files/canvas_file.h"
#include "retouch/report/treatment_report.h"
#include "retouch/treatment/removed_layers.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_folder.h"
#include "retouch/treatment/treatment_steps.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/retouch/treatment_folder.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

TEST_F(TreatmentFolder, KeepsTheDryLayerThroughAllOfIt) {
    Treatment treatment = begin();
    const std::string file = sha256_of_file(dir_ / "p.exr");
    add(treatment, LayerRole::fill, 10);
    add(treatment, LayerRole::isolating_varnish, 10, 20);
    add(treatment, LayerRole::retouch, 10);
    add(treatment, LayerRole::fill, 70);
    EXPECT_EQ(hash_of(read_painting(treatment.painting())), hash_of(read_painting(dir_ / "p.exr")));
    EXPECT_EQ(sha256_of_file(dir_ / "p.exr"), file);
    const Treatment again = Treatment::open(folder());
    ASSERT_EQ(again.layers().size(), 4u);
    EXPECT_EQ(again.layers()[1].name, "isolating varnish 1");
    EXPECT_EQ(again.layers()[3].name, "fill 2");
    EXPECT_THAT(again.check(), IsEmpty());

    // One taken off, then all: the original, bit for bit.
    treatment = again;
    Canvas canvas = treatment.read_canvas();
    lift_off(canvas, "retouch 1");
    treatment.record({.action = "remove", .canvas = &canvas}, kAuthor);
    EXPECT_EQ(treatment.layers().size(), 3u);
    EXPECT_EQ(treatment.new_layer_name(LayerRole::retouch), "retouch 2");
    canvas = treatment.read_canvas();
    while (!canvas.dried().empty()) lift_off(canvas, canvas.dried().back().name);
    treatment.record({.action = "remove", .canvas = &canvas}, kAuthor);
    EXPECT_EQ(sha256_of(read_painted(treatment.painting())), sha256_of(read_painting(dir_ / "p.exr")));
}

TEST_F(TreatmentFolder, StatesShowTheLayersUpToTheirs) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    add(treatment, LayerRole::isolating_varnish, 10);
    add(treatment, LayerRole::retouch, 10);
    add(treatment, LayerRole::varnish, 10);
    const Canvas canvas = treatment.read_canvas();
    const auto count = [&](TreatmentStage state) {
        return in_state(canvas, treatment.layers(), state).dried().size();
    };
    EXPECT_EQ(count(TreatmentStage::before), 0u);
    EXPECT_EQ(count(TreatmentStage::cleaned), 0u);
    EXPECT_EQ(count(TreatmentStage::filled), 1u);
    EXPECT_EQ(count(TreatmentStage::retouched), 3u);
    EXPECT_EQ(count(TreatmentStage::varnished), 4u);
}

TEST_F(TreatmentFolder, ARetouchOnVarnishIsShownOnIt) {
    Treatment treatment = begin();
    add(treatment, LayerRole::varnish, 10, 20);
    add(treatment, LayerRole::retouch, 10);
    add(treatment, LayerRole::varnish, 10, 20);
    const Canvas shown = in_state(treatment.read_canvas(), treatment.layers(), TreatmentStage::retouched);
    ASSERT_EQ(shown.dried().size(), 2u);
    EXPECT_EQ(shown.dried()[0].name, "varnish 1");
    EXPECT_EQ(shown.dried()[1].name, "retouch 1");
}

TEST_F(TreatmentFolder, ALawOfReflectanceThatWasChangedIsNoticed) {
    const Treatment treatment = begin();
    EXPECT_THAT(treatment.check(), IsEmpty());
    Surface surface = read_painting(treatment.painting());
    surface.reflectance_model.second_lobe_weight = 0.6;
    write_painting(treatment.painting(), surface);
    EXPECT_THAT(treatment.check(), ElementsAre(HasSubstr("reflectance model")));
}

TEST_F(TreatmentFolder, AnEarlierStateThatWasChangedIsNotShown) {
    Treatment treatment = begin();
    treatment.keep_earlier(dir_ / "p.exr", kAuthor);
    Surface surface = read_painting(dir_ / "p.exr");
    surface.diffuse(5, 5) = Rgb(1, 0, 0);
    write_painting(folder() / "earlier.exr", surface);
    EXPECT_THAT([&] { treatment.read_earlier(); }, ThrowsMessage<Error>(HasSubstr("line 2 of the log")));
}

TEST_F(TreatmentFolder, InputsOfOneNameAreBothLogged) {
    Treatment treatment = begin();
    for (const char* sub : {"a", "b"}) {
        std::filesystem::create_directory(dir_ / sub);
        write_text_file(dir_ / sub / "m.txt", sub);
    }
    treatment.record({.action = "test", .inputs = {dir_ / "a/m.txt", dir_ / "b/m.txt"}}, kAuthor);
    EXPECT_EQ(treatment.log().entries().back().content["inputs"].size(), 2u);
}

TEST_F(TreatmentFolder, AnIsolatingVarnishOverARetouchIsWarnedOf) {
    Treatment treatment = begin();
    add(treatment, LayerRole::retouch, 10);
    Canvas canvas = treatment.read_canvas();
    const nlohmann::json result = varnish_step(treatment, canvas, {.isolating = true}, kAuthor, {});
    EXPECT_THAT(result["warnings"].dump(), HasSubstr("lies over 'retouch 1'"));
}

TEST_F(TreatmentFolder, MasksComeBackAndChangedOnesAreNamed) {
    Treatment treatment = begin();
    const Mask loss = mask_of_polygons({{{10, 10}, {30, 10}, {30, 30}, {10, 30}}}, 100, 70);
    treatment.record({.action = "draw", .masks = {{"loss_to_ground", loss}}}, kAuthor);
    EXPECT_TRUE(treatment.has_mask(DamageClass::loss_to_ground));
    EXPECT_FALSE(treatment.has_mask(DamageClass::stain));
    const nlohmann::json table = damage_table(treatment);
    ASSERT_EQ(table.size(), 1u);
    EXPECT_EQ(table[0]["count"], 1);
    EXPECT_DOUBLE_EQ(table[0]["area_cm2"], 400 * kTestPixel * kTestPixel / 100);
    EXPECT_EQ(area_of(treatment.mask(DamageClass::stain), 1).mm2, 0);

    write_mask(folder() / "masks/loss_to_ground.png", Mask(100, 70));
    EXPECT_THAT([&] { treatment.mask(DamageClass::loss_to_ground); },
                ThrowsMessage<Error>(HasSubstr("is not the mask that line 2 of the log wrote")));
    EXPECT_THAT(treatment.check(), ElementsAre(HasSubstr("loss_to_ground.png is not what line 2")));
}

TEST_F(TreatmentFolder, APaintingThatWasChangedIsNoticed) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    Canvas canvas = treatment.read_canvas();
    canvas.writable_dried()[0].paint.writable({0, 0}).writable_plane(0)[700] += 0.01f;
    write_canvas(treatment.painting(), canvas);
    EXPECT_THAT([&] { treatment.read_canvas(); },
                ThrowsMessage<Error>(HasSubstr("layer 'fill 1' is not the one that was logged")));
    canvas.writable_dried().clear();
    write_canvas(treatment.painting(), canvas);
    EXPECT_THAT([&] { treatment.read_canvas(); },
                ThrowsMessage<Error>(HasSubstr("layer 'fill 1' is missing")));
    auto other = flat_surface(100, 70);
    other->height_mm(3, 3) = 1;
    write_painting(treatment.painting(), *other);
    EXPECT_THAT([&] { treatment.read_canvas(); }, ThrowsMessage<Error>(HasSubstr("dry layer is not")));
    EXPECT_THAT(treatment.check(), ElementsAre(HasSubstr("dry layer is not")));
    const Canvas wrong(other);
    EXPECT_THAT([&] { treatment.record({.action = "fill", .canvas = &wrong}, kAuthor); },
                ThrowsMessage<Error>(HasSubstr("the dry layer would change")));
}

TEST_F(TreatmentFolder, LayersInAnotherOrderAreAFaultAndWhatTheLogDoesNotKnowIsTold) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    add(treatment, LayerRole::retouch, 10);
    Canvas canvas = treatment.read_canvas();
    EXPECT_THAT(treatment.unlogged(canvas), IsEmpty());
    lay(canvas, "Monday", 40, 8);
    write_canvas(treatment.painting(), canvas);
    EXPECT_THAT(treatment.check(), IsEmpty()) << "work in progress is no fault";
    EXPECT_THAT(treatment.unlogged(treatment.read_canvas()), ElementsAre(HasSubstr("'Monday'")));
    EXPECT_THAT([&] { write_treatment_report(treatment, dir_ / "r.html", "test"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("'Monday'"), HasSubstr("treatment retouch"))));
    std::swap(canvas.writable_dried()[0], canvas.writable_dried()[2]);
    write_canvas(treatment.painting(), canvas);
    EXPECT_THAT(treatment.check(), ElementsAre(HasSubstr("does not lie where the log has it")));
}

TEST_F(TreatmentFolder, KnowsWhichFilesAreItsOwn) {
    begin();
    for (const char* own : {"painting.exr", "log.jsonl", "log.head.json", "earlier.exr", "earlier.7.exr",
                            "masks/new.png", "quality", "strokes/a/b.jsonl"})
        EXPECT_EQ(treatment_that_keeps(folder() / own), std::filesystem::weakly_canonical(folder())) << own;
    for (const std::filesystem::path& other : {folder() / "report.html", dir_ / "painting.exr", folder()})
        EXPECT_EQ(treatment_that_keeps(other), std::nullopt) << other;
    // Links are followed when they are written to, also where no file is there yet.
    for (const char* own : {"painting.exr", "masks/new.png"}) {
        const std::filesystem::path link = dir_ / "link";
        std::filesystem::create_symlink(folder() / own, link);
        EXPECT_EQ(treatment_that_keeps(link), std::filesystem::weakly_canonical(folder())) << own;
        std::filesystem::remove(link);
    }
}

TEST_F(TreatmentFolder, PaintOnTheOriginalIsCounted) {
    Canvas canvas(flat_surface(100, 70));
    lay(canvas, "retouch 1", 10, 8);
    const PaintLayer& layer = canvas.dried()[0].paint;
    const Mask half = mask_of_polygons({{{0, 0}, {14.5, 0}, {14.5, 70}, {0, 70}}}, 100, 70);
    const OnOriginal beside = on_original(layer, half, kTestPixel);
    EXPECT_EQ(beside.pixels, 4 * 8);  // columns 14, in half, to 17
    EXPECT_EQ(beside.whole_pixels, 3 * 8);
    EXPECT_NEAR(beside.area_mm2, 3.5 * 8 * kTestPixel * kTestPixel, 1e-6);
    EXPECT_NEAR(beside.volume_mm3, 0.1 * beside.area_mm2, 1e-6);
    EXPECT_EQ(on_original(layer, Mask(100, 70, 1.0f), kTestPixel).pixels, 0);
    EXPECT_EQ(area_of(additions(canvas), 1).mm2, 64);
}

TEST_F(TreatmentFolder, UndoTakesBackAnEarlierStateBeforeWhatWasLaidBeforeIt) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    const auto earlier = [&](float diffuse) {
        auto surface = flat_surface(100, 70);
        surface->diffuse(0, 0) = Rgb(diffuse);
        write_painting(dir_ / "dirty.exr", *surface);
        treatment.keep_earlier(dir_ / "dirty.exr", kAuthor);
    };
    earlier(0.1f);
    earlier(0.2f);
    Canvas canvas = treatment.read_canvas();
    const auto undo = [&] { return undo_step(treatment, canvas, kAuthor); };
    EXPECT_EQ(undo()["earlier_state"], "the one before");
    EXPECT_EQ(treatment.read_earlier().diffuse(0, 0), Rgb(0.1f));
    EXPECT_EQ(treatment.layers().size(), 1u);
    EXPECT_THAT(treatment.check(), IsEmpty());
    EXPECT_EQ(undo()["earlier_state"], "none");
    EXPECT_FALSE(treatment.has_earlier());
    EXPECT_FALSE(std::filesystem::exists(folder() / "earlier.exr"));
    EXPECT_EQ(treatment.layers().size(), 1u);
    EXPECT_THAT(treatment.check(), IsEmpty());
    EXPECT_FALSE(Treatment::open(folder()).has_earlier());
    EXPECT_THAT(undo()["removed"], ElementsAre("fill 1"));
    EXPECT_THAT([&] { undo(); }, ThrowsMessage<Error>(HasSubstr("there is no step to undo")));

    earlier(0.3f);
    earlier(0.4f);
    const std::string kept =
        treatment.log().entries().back().content["kept"]["earlier.exr"].get<std::string>();
    write_text_file(folder() / kept, "edited");
    EXPECT_THAT([&] { undo(); }, ThrowsMessage<Error>(HasSubstr(kept + ": is not what line")));
    EXPECT_EQ(treatment.read_earlier().diffuse(0, 0), Rgb(0.4f));
}

TEST_F(TreatmentFolder, UndoBringsBackWhatWasTakenOff) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    add(treatment, LayerRole::isolating_varnish, 10, 20);
    add(treatment, LayerRole::retouch, 10);
    add(treatment, LayerRole::fill, 60);  // over a border of tiles
    const std::vector<TreatmentLayer> whole = treatment.layers();
    const auto is_whole = [&] {
        const std::vector<TreatmentLayer> now = Treatment::open(folder()).layers();
        ASSERT_EQ(now.size(), whole.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            EXPECT_EQ(now[i].name, whole[i].name);
            EXPECT_EQ(now[i].role, whole[i].role);
            EXPECT_EQ(now[i].sha256, whole[i].sha256);
        }
        EXPECT_THAT(Treatment::open(folder()).check(), IsEmpty());
    };
    const auto remove = [&](const std::vector<std::string>& names) {
        Canvas canvas = treatment.read_canvas();
        remove_step(treatment, canvas, names, kAuthor);
        EXPECT_THAT(treatment.check(), IsEmpty());
    };
    const auto undo = [&] {
        Canvas canvas = treatment.read_canvas();
        return undo_step(treatment, canvas, kAuthor);
    };
    // One from the middle, the lowest, two at once, all: each comes back to its place.
    const std::vector<std::string> all = {"fill 1", "isolating varnish 1", "retouch 1", "fill 2"};
    for (const std::vector<std::string>& names :
         {std::vector<std::string>{"retouch 1"}, {"fill 1"}, {"retouch 1", "fill 1"}, all}) {
        remove(names);
        EXPECT_EQ(treatment.layers().size(), whole.size() - names.size());
        EXPECT_THAT(next_undo(treatment).step, HasSubstr("take off "));
        EXPECT_EQ(undo()["brought_back"].size(), names.size());
        is_whole();
    }
    // One after the other, and back the other way round; steps between them are undone in their turn.
    remove({"isolating varnish 1"});
    remove({"fill 1"});
    add(treatment, LayerRole::varnish, 10, 20);
    EXPECT_EQ(next_undo(treatment).step, "lay varnish 1");
    EXPECT_THAT(undo()["removed"], ElementsAre("varnish 1"));
    EXPECT_THAT(undo()["brought_back"], ElementsAre("fill 1"));
    EXPECT_THAT(undo()["brought_back"], ElementsAre("isolating varnish 1"));
    is_whole();
    // Beyond them, steps that laid something.
    EXPECT_EQ(next_undo(treatment).step, "lay fill 2");
    EXPECT_THAT(undo()["removed"], ElementsAre("fill 2"));
    EXPECT_THAT(undo()["removed"], ElementsAre("retouch 1"));
}

TEST_F(TreatmentFolder, WhatATakenOffLayerIsKeptInIsCheckedAndSmall) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    Canvas canvas = treatment.read_canvas();
    remove_step(treatment, canvas, {"fill 1"}, kAuthor);
    const LogEntry line = treatment.log().entries().back();
    const std::string kept = line.content["kept"]["layers"].get<std::string>();
    EXPECT_EQ(kept, fmt::format("removed/{}.exr", line.line));
    EXPECT_TRUE(line.content["outputs"].contains(kept));
    EXPECT_LT(std::filesystem::file_size(folder() / kept),
              std::filesystem::file_size(folder() / "painting.exr"));
    EXPECT_EQ(treatment_that_keeps(folder() / kept), std::filesystem::weakly_canonical(folder()));
    write_text_file(folder() / kept, "edited");
    EXPECT_THAT(treatment.check(), ElementsAre(HasSubstr(kept)));
    EXPECT_THAT([&] { undo_step(treatment, canvas, kAuthor); },
                ThrowsMessage<Error>(AllOf(HasSubstr(kept), HasSubstr("backup"))));
    EXPECT_TRUE(Treatment::open(folder()).layers().empty());
}

// Of an earlier version, that kept nothing.
TEST_F(TreatmentFolder, ATakingOffThatKeptNothingIsNotUndoneNorWhatIsBeforeIt) {
    Treatment treatment = begin();
    add(treatment, LayerRole::fill, 10);
    add(treatment, LayerRole::retouch, 10);
    Canvas canvas = treatment.read_canvas();
    lift_off(canvas, "retouch 1");
    treatment.record({.action = "remove", .parameters = {{"layers", {"retouch 1"}}}, .canvas = &canvas},
                     kAuthor);
    EXPECT_THAT(next_undo(treatment).refused, HasSubstr("kept nothing"));
    EXPECT_THAT([&] { undo_step(treatment, canvas, kAuthor); },
                ThrowsMessage<Error>(
                    AllOf(HasSubstr("line 4 of the log took off retouch 1"), HasSubstr("cannot be undone"))));
    EXPECT_EQ(Treatment::open(folder()).layers().size(), 1u) << "the next layer stays";
}

// Paints of a layer that comes back have numbers of their own.
TEST_F(TreatmentFolder, ALayerComesBackOnACanvasWithOtherPaints) {
    Canvas from(flat_surface(100, 70)), onto(flat_surface(100, 70));
    add_paint(from, "Bone Black");
    lay(from, "fill 1", 60, 12);
    for (const char* other : {"Pyrrole Red", "Hansa Yellow Opaque"}) add_paint(onto, other);
    AtomicFile file(dir_ / "kept.exr");
    write_removed(file, from, from.dried());
    onto.writable_dried() = read_removed(dir_ / "kept.exr", onto);
    ASSERT_EQ(onto.dried().size(), 1u);
    EXPECT_EQ(sha256_of(onto, onto.dried()[0].paint), sha256_of(from, from.dried()[0].paint));
    Canvas other(flat_surface(90, 70));
    EXPECT_THAT([&] { read_removed(dir_ / "kept.exr", other); }, ThrowsMessage<Error>(HasSubstr("100 x 70")));
}

TEST_F(TreatmentFolder, WithoutAScaleNoAreaIsStated) {
    auto surface = flat_surface(60, 40);
    surface->scale_known = false, surface->mm_per_pixel = 1;
    write_painting(dir_ / "unscaled.exr", *surface);
    Treatment treatment = Treatment::begin(dir_ / "unscaled", dir_ / "unscaled.exr", kAuthor);
    Mask stain(60, 40);
    for (int x = 10; x < 30; ++x) stain(x, 20) = 1;
    const nlohmann::json drawn = draw_step(treatment, {DamageClass::stain, stain, {}}, kAuthor);
    EXPECT_EQ(drawn["stain"], (nlohmann::json{{"area_px", 20.0}}));
    const nlohmann::json row = damage_table(treatment)[0];
    EXPECT_FALSE(row.contains("area_cm2"));
    EXPECT_EQ(row["area_px"], 20);
    EXPECT_EQ(area_in_words(row), "20 pixels");
}

TEST_F(TreatmentFolder, AFillThatHasNothingToFillIsNone) {
    Treatment treatment = begin();
    Canvas canvas = treatment.read_canvas();
    StepArea area{Mask(100, 70), {}};
    for (int y = 30; y < 40; ++y)
        for (int x = 30; x < 40; ++x) area.mask(x, y) = 1;
    EXPECT_THAT(
        [&] {
            fill_step(treatment, canvas, area, {FillTexture::smooth, Rgb(0.8f), {.offset_mm = -1}}, kAuthor);
        },
        ThrowsMessage<Error>(AllOf(HasSubstr("nothing to fill"), HasSubstr("--offset-mm"))));
    EXPECT_TRUE(Treatment::open(folder()).layers().empty());
    // In part: said, and done.
    Surface half = canvas.dry();
    for (int y = 30; y < 40; ++y)
        for (int x = 30; x < 35; ++x) half.height_mm(x, y) = -0.5f;
    for (int y = 30; y < 40; ++y)
        for (int x = 35; x < 40; ++x) half.height_mm(x, y) = 0.5f;
    write_painting(dir_ / "half.exr", half);
    Treatment other = Treatment::begin(dir_ / "half", dir_ / "half.exr", kAuthor);
    Canvas lower = other.read_canvas();
    const nlohmann::json filled = fill_step(other, lower, area, {FillTexture::smooth, Rgb(0.8f)}, kAuthor);
    EXPECT_THAT(filled["warnings"][0].get<std::string>(), HasSubstr("lies above the fill's level already"));
}

}  // namespace
}  // namespace tangi
