// canvas_file_test.cpp: painted canvases come back bit for bit; damaged ones say what is wrong.
#include "paint/files/canvas_file.h"

#include <gmock/gmock.h>

#include "paint/canvas/appearance.h"
#include "paint/files/paint_parts.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Canvas painted() {
    Canvas canvas = flat_canvas(150, 100);
    const auto white = add_paint(canvas, "Titanium White"), red = add_paint(canvas, "Pyrrole Red");
    Brush brush(brush_presets().at("flat"), kTestPixel, 1);
    brush.load({{white, 3}, {red, 1}}, 1);
    stroke(canvas, brush, {-15, 0}, {15, 4});
    dry(canvas, "under, \"first\"");
    brush.load({{red, 1}}, 1);
    stroke(canvas, brush, {-15, 4}, {15, -4});
    return canvas;
}

TEST(CanvasFile, PaintComesBackBitForBit) {
    const TestDir dir;
    const Canvas canvas = painted();
    write_canvas(dir / "a.exr", canvas);
    const Canvas again = read_canvas(dir / "a.exr");
    EXPECT_EQ(hash_of(again.dry()), hash_of(canvas.dry()));
    EXPECT_TRUE(identical(again.wet(), canvas.wet()));
    ASSERT_EQ(again.dried().size(), 1u);
    EXPECT_EQ(again.dried()[0].name, "under, \"first\"");
    EXPECT_TRUE(identical(again.dried()[0].paint, canvas.dried()[0].paint));
    ASSERT_EQ(again.ingredients().size(), 2u);
    EXPECT_EQ(again.ingredients()[1].name, "Pyrrole Red");
    EXPECT_EQ(again.ingredients()[1].k, canvas.ingredients()[1].k);
    EXPECT_EQ(again.ingredients()[1].roughness, canvas.ingredients()[1].roughness);
    // And once more, from what was read.
    write_canvas(dir / "b.exr", again);
    EXPECT_EQ(bytes_of(dir / "a.exr"), bytes_of(dir / "b.exr"));
    EXPECT_TRUE(images_identical(read_painted(dir / "a.exr").diffuse, appearance(canvas).diffuse));
}

TEST(CanvasFile, TheDryPartIsStillAPainting) {
    const TestDir dir;
    const Canvas canvas = painted();
    write_canvas(dir / "a.exr", canvas);
    EXPECT_TRUE(is_painting(dir / "a.exr"));
    EXPECT_TRUE(images_identical(read_painting(dir / "a.exr").diffuse, canvas.dry().diffuse));
    // One that was never painted on is as any painting.
    const Canvas bare = flat_canvas(20, 10);
    write_canvas(dir / "b.exr", bare);
    EXPECT_TRUE(painting_parts(dir / "b.exr").empty());
    EXPECT_TRUE(read_canvas(dir / "b.exr").wet().empty());
    EXPECT_TRUE(images_identical(read_painted(dir / "b.exr").diffuse, bare.dry().diffuse));
}

TEST(CanvasFile, RemembersTheScaleThatAPaintingWasGiven) {
    const TestDir dir;
    auto surface = flat_surface(64, 64);
    surface->scale_known = false;
    surface->mm_per_pixel = 1;
    Canvas canvas(surface, 0.1);
    PaintTile tile;
    tile.ingredients = {add_paint(canvas, "Titanium White")};
    tile.thickness_mm.assign(PaintTile::kPixels, 0.05f);
    canvas.writable_wet().set_tile({0, 0}, std::make_shared<PaintTile>(tile));
    write_canvas(dir / "a.exr", canvas);
    const Canvas again = read_canvas(dir / "a.exr");
    EXPECT_EQ(again.mm_per_pixel(), 0.1);
    EXPECT_FALSE(again.dry().scale_known);
    EXPECT_NEAR(read_painted(dir / "a.exr").height_mm(9, 9), 0.5f, 1e-6);  // in pixels, like the dry part
    EXPECT_THAT(error_of([&] { read_canvas(dir / "a.exr", {}, 0.2); }),
                AllOf(HasSubstr("a.exr"), HasSubstr("0.1 mm")));
}

TEST(CanvasFile, AFullDiskLeavesWhatWasThere) {
    const TestDir dir;
    write_bytes(dir / "a.exr", "old");
    const Canvas canvas = painted();
    {
        const FullDisk full(20000);
        EXPECT_THAT(error_of([&] { write_canvas(dir / "a.exr", canvas); }), HasSubstr("a.exr"));
    }
    EXPECT_EQ(bytes_of(dir / "a.exr"), "old");
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"a.exr"});
}

// A painting with a part as it should not be.
std::string error_of_part(const TestDir& dir, PartInfo info, float value) {
    const auto surface = flat_surface(20, 10);
    PartToWrite part;
    part.info = std::move(info);
    part.fill = [&](int, int, std::span<float* const> planes) { planes[0][23] = value; };
    AtomicFile file(dir / "bad.exr");
    write_painting(file, *surface, std::span(&part, 1));
    return error_of([&] { read_canvas(dir / "bad.exr"); });
}

TEST(CanvasFile, ALargeOneHasAnOverviewOfItsPaint) {
    const TestDir dir;
    const auto dry = flat_surface(2100, 2000);
    std::ranges::fill(dry->roughness.pixels(), 0.2f);
    Canvas canvas(dry);
    const IngredientId black = canvas.add(artist_acrylics().at("Bone Black"));
    const auto paint_over = [&](TileIndex at) {
        std::ranges::fill(canvas.writable_wet().writable(at).writable_plane(black), 0.3f);
    };
    paint_over({0, 0});
    write_canvas(dir / "a.exr", canvas);
    const auto overview = read_overview(dir / "a.exr");
    ASSERT_TRUE(overview);
    EXPECT_EQ(overview->width, 2100);
    EXPECT_LT(overview->surface.diffuse(5, 5).g, 0.3f * overview->surface.diffuse(500, 500).g);
    // What another part wrote of an earlier state is not kept beside it.
    paint_over({20, 20});
    AtomicFile file(dir / "b.exr");
    write_canvas(file, canvas, {}, parts_beside_paint(dir / "a.exr"));
    const int at = (20 * 64 + 32) / 3;
    EXPECT_LT(read_overview(dir / "b.exr")->surface.diffuse(at, at).g, 0.3f);
}

TEST(CanvasFile, ErrorsNameFileAndPart) {
    const TestDir dir;
    Canvas canvas = flat_canvas(20, 10);
    add_paint(canvas, "Pyrrole Red");
    write_canvas(dir / "good.exr", canvas);
    const std::string good = painting_parts(dir / "good.exr").at(0).attributes.at("ingredients");
    const PartInfo fine{"wet", 20, 10, {"volume.00000"}, {{"ingredients", good}}};

    EXPECT_THAT(error_of_part(dir, fine, -0.5f),
                AllOf(HasSubstr("bad.exr"), HasSubstr("'wet'"), HasSubstr("(3, 1)")));
    EXPECT_THAT(error_of_part(dir, fine, NAN), HasSubstr("nan"));
    EXPECT_THAT(
        error_of_part(dir, fine, 1e30f),
        HasSubstr("bad.exr: part 'wet' holds 1e+30 mm of paint at pixel (3, 1); there are never more"));
    EXPECT_GT(kMostPaint_mm, 1e6) << "what is painted can be read";
    PartInfo info = fine;
    info.attributes["ingredients"] = "[{\"name\": \"x\"}]";
    EXPECT_THAT(error_of_part(dir, info, 0), AllOf(HasSubstr("bad.exr"), HasSubstr("ingredients")));
    info.attributes.clear();
    EXPECT_THAT(error_of_part(dir, info, 0), HasSubstr("missing"));
    info = fine;
    info.channels = {"volume.00007"};
    EXPECT_THAT(error_of_part(dir, info, 0), HasSubstr("volume.00007"));
    info.channels = {"R"};
    EXPECT_THAT(error_of_part(dir, info, 0), HasSubstr("'R'"));
    EXPECT_THAT(error_of([&] { read_canvas(dir / "none.exr"); }), HasSubstr("none.exr"));
    const std::string bytes = bytes_of(dir / "good.exr");
    write_bytes(dir / "cut.exr", bytes.substr(0, bytes.size() - 30));
    EXPECT_THAT(error_of([&] { read_canvas(dir / "cut.exr"); }), HasSubstr("cut.exr"));
}

// Other programs copy some parts of a file and not others.
TEST(CanvasFile, APartThatIsMissingIsMissed) {
    const TestDir dir;
    Canvas canvas = painted();
    dry(canvas, "above");
    write_canvas(dir / "good.exr", canvas);
    const auto error_without = [&](const std::string& missing) {
        std::vector<PartToWrite> kept = parts_beside_paint(dir / "good.exr");
        for (PartToWrite part : {part_of("wet", canvas.wet()), part_of("dried.0", canvas.dried()[0].paint),
                                 part_of("dried.1", canvas.dried()[1].paint)}) {
            if (part.info.name == "wet") add_ingredients(part.info, canvas.ingredients());
            if (part.info.name != missing) kept.push_back(std::move(part));
        }
        AtomicFile file(dir / "bad.exr");
        fill_painting(file, canvas.dry(), kept, {});
        file.commit();
        return error_of([&] { read_canvas(dir / "bad.exr"); });
    };
    EXPECT_THAT(
        error_without("wet"),
        AllOf(HasSubstr("bad.exr: has 2 layers of dried paint, but no part 'wet'"), HasSubstr("copy")));
    EXPECT_THAT(error_without("dried.0"),
                AllOf(HasSubstr("bad.exr: has a layer of dried paint, but no part 'dried.0'")));
    write_canvas(dir / "bad.exr", canvas);
    EXPECT_EQ(read_canvas(dir / "bad.exr").dried().size(), 2u);
}

// A pixel of unknown size counts as one mm: what was painted so is not made another size later.
TEST(CanvasFile, AScaleThatWasTakenStays) {
    const TestDir dir;
    auto surface = flat_surface(20, 10);
    surface->scale_known = false;
    surface->mm_per_pixel = 1;
    Canvas canvas{std::shared_ptr<const Surface>(surface)};
    add_paint(canvas, "Titanium White");
    write_canvas(dir / "a.exr", canvas);
    EXPECT_EQ(read_canvas(dir / "a.exr").mm_per_pixel(), 1);
    EXPECT_EQ(read_canvas(dir / "a.exr", {}, 1).mm_per_pixel(), 1);
    EXPECT_THAT(error_of([&] { read_canvas(dir / "a.exr", {}, 0.5); }),
                AllOf(HasSubstr("a.exr"), HasSubstr("of 1 mm, not 0.5 mm"), HasSubstr("--mm-per-pixel")));
}

TEST(CanvasFile, KeepsThePartThatIsMedium) {
    const TestDir dir;
    Canvas canvas = flat_canvas(20, 10);
    canvas.add(finished(artist_acrylics().at("Ultramarine Blue"), {.medium = 0.9}));
    write_canvas(dir / "a.exr", canvas);
    EXPECT_NEAR(read_canvas(dir / "a.exr").ingredients().at(0).medium, 0.9, 1e-6);
}

}  // namespace
}  // namespace tangi
