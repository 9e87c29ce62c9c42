// fit_steps_test.cpp: a fit in steps has the bits of a fit in one go, whatever the tiles that are fitted
// together, and makes again only what is missing.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "fit/pipeline/painting_fit.h"
#include "fit/steps/fit_tiles.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/output_set.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kTileOfTest = 48;  // [pixels] a side: a multiple of kMarchLanes

// A stack, its plan in files, and folders of tiles.
class SteppedStack {
public:
    explicit SteppedStack(const GeneratorOptions& generator, int width, int height, bool moved = false)
        : moved_(moved) {
        write_stack(photos_.path(), painting(width, height), generator);
        const FitPlan plan = plan_fit(open(), options());
        AtomicFile json(plan_path()), maps(maps_of_plan(plan_path()));
        write_plan(plan, {{"tile_pixels", kTileOfTest}}, json, maps);
        OutputSet set;
        set.add(maps);
        set.add(json);
        set.commit();
    }
    static FitOptions options() { return {.mm_per_pixel = kMmPerPixel, .register_photos = false}; }
    // Of a camera that moved a little from photograph to photograph, where it did.
    Stack open() const {
        Stack stack = open_stack(photos_.path(), {.transfer = Transfer{}});
        for (StackPhoto& photo : stack.photos)
            if (moved_) photo.homography = glm::dmat3(1, 0.001, 0, -0.002, 1, 0, 0.3 * photo.number, -0.7, 1);
        return stack;
    }
    std::filesystem::path plan_path() const { return files_.path() / "plan.json"; }
    PlanFile plan_file() const { return PlanFile(plan_path()); }
    FitPlan plan() const { return plan_file().plan(open()); }
    FittedTiles tiles(const std::string& folder) const { return {files_.path() / folder, plan_file()}; }

    FitTilesReport fit(const FittedTiles& tiles, const std::string& range) const {
        return fit_tiles(plan(), options(), tiles, tiles_named(range, tiles.grid().count()));
    }
    FitResult finish(const FittedTiles& tiles) const {
        FitPlan planned = plan();
        const int photos = static_cast<int>(planned.stack.photos.size());
        return finish_fit(std::move(planned), options(), tiles.all(photos));
    }

private:
    TestDir photos_, files_;
    bool moved_;
};

void expect_same_painting(const FitResult& a, const FitResult& b) {
    EXPECT_EQ(hash_of(a.surface), hash_of(b.surface));
    EXPECT_EQ(a.report.fitted, b.report.fitted);
    EXPECT_EQ(a.report.not_converged, b.report.not_converged);
    EXPECT_EQ(a.report.solvers.compared, b.report.solvers.compared);
    EXPECT_EQ(a.report.solvers.polished, b.report.solvers.polished);
    EXPECT_EQ(a.report.median_rms_residual, b.report.median_rms_residual);
    EXPECT_EQ(a.report.height_choice.carved.lights, b.report.height_choice.carved.lights);
    for (std::size_t i = 0; i < a.errors.slope.size(); ++i) {
        ASSERT_EQ(float(a.errors.slope.pixels()[i]), float(b.errors.slope.pixels()[i]));
        ASSERT_EQ(float(a.errors.height.pixels()[i]), float(b.errors.height.pixels()[i]));
    }
}

TEST(FitSteps, TilesHaveTheBitsOfTheWholeInAnyOrder) {
    const SteppedStack stack({.lights = 10, .held_out = 0, .ambient = 0.02}, 130, 100, true);
    FitPlan plan = plan_fit(stack.open(), SteppedStack::options());
    RefinedPixels all = [&] {
        PartFitter fitter(plan, SteppedStack::options(), {0, 0, plan.stack.width(), 0}, 0);
        return fitter.fit(0, plan.stack.height());
    }();
    const FitResult whole = finish_fit(std::move(plan), SteppedStack::options(), std::move(all));

    const FittedTiles one_by_one = stack.tiles("one"), by_rows = stack.tiles("rows");
    const int count = one_by_one.grid().count();
    EXPECT_EQ(count, 9);
    for (int i = count; i-- > 0;) stack.fit(one_by_one, std::to_string(i));
    stack.fit(by_rows, "1-4");
    stack.fit(by_rows, "all");
    expect_same_painting(stack.finish(one_by_one), whole);
    expect_same_painting(stack.finish(by_rows), whole);
    for (int i = 0; i < count; ++i)
        EXPECT_EQ(read_text_file(one_by_one.file_of(i)), read_text_file(by_rows.file_of(i))) << i;
}

TEST(FitSteps, MakesAgainOnlyWhatIsMissingOrDamaged) {
    const SteppedStack stack({.lights = 8, .held_out = 0}, 100, 90);
    const FittedTiles tiles = stack.tiles("tiles");
    EXPECT_EQ(stack.fit(tiles, "all").fitted, 6);
    const FitResult whole = stack.finish(tiles);
    std::filesystem::remove(tiles.file_of(2));
    std::string flipped = read_text_file(tiles.file_of(4));
    flipped[flipped.size() / 2] ^= 1;
    std::ofstream(tiles.file_of(4), std::ios::binary) << flipped;
    EXPECT_THAT(tiles.missing(tiles_named("all", 6)), ElementsAre(2, 4));
    try {
        stack.finish(tiles);
        FAIL() << "tiles are missing";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("2 of 6 tiles are missing, damaged or of another plan: 2, 4"));
    }
    const FitTilesReport again = stack.fit(tiles, "all");
    EXPECT_EQ(again.there, 4);
    EXPECT_EQ(again.fitted, 2);
    expect_same_painting(stack.finish(tiles), whole);
}

TEST(FitSteps, NameTilesThatThereAre) {
    EXPECT_THAT(tiles_named("all", 3), ElementsAre(0, 1, 2));
    EXPECT_THAT(tiles_named("4,0-1", 6), ElementsAre(0, 1, 4));
    for (const std::string wrong : {"", "6", "-1", "2-1", "1,,2", "a", "0-6", "1-"})
        EXPECT_THROW(tiles_named(wrong, 6), Error) << wrong;
}

TEST(FitSteps, APlanIsOfItsPhotographsAndMaps) {
    const SteppedStack stack({.lights = 6, .held_out = 0}, 40, 30);
    Stack fewer = stack.open();
    fewer.photos.pop_back();
    EXPECT_THROW(stack.plan_file().plan(fewer), Error);
    Stack cropped = stack.open();
    cropped.crop.x1 -= 4;
    EXPECT_THROW(stack.plan_file().plan(cropped), Error);
    const std::string maps = read_text_file(maps_of_plan(stack.plan_path()));
    std::ofstream(maps_of_plan(stack.plan_path()), std::ios::binary) << maps.substr(0, maps.size() / 2);
    EXPECT_THROW(stack.plan(), Error);
    write_text_file(stack.plan_path(), "{\"format\": \"something else\"}");
    EXPECT_THROW(stack.plan_file(), Error);
}

// Where the reduced photographs suffice, the fit in one go takes these steps.
TP_LONG TEST(FitSteps, HaveTheBitsOfAFitInOneGo) {
    const TestDir folder;
    const PaintingTruth truth =
        procedural_painting({.seed = 7, .width = 1100, .height = 950, .impasto = 0.3});
    write_stack(folder.path(), truth, {.lights = 8, .held_out = 0, .ambient = 0.02});
    const FitOptions options{.mm_per_pixel = truth.mm_per_pixel};
    const FitResult whole = fit_painting(open_stack(folder.path()), options);
    FitPlan plan = plan_fit(open_stack(folder.path()), options);
    PartFitter fitter(plan, options, {0, 0, 1100, 0}, 0);
    RefinedPixels pixels = fitter.fit(0, 950);
    const FitResult steps = finish_fit(plan, options, std::move(pixels));
    expect_same_painting(steps, whole);
    EXPECT_EQ(steps.report.warnings, whole.report.warnings);
}

}  // namespace
}  // namespace tangi
