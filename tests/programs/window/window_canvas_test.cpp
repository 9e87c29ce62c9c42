// window_canvas_test.cpp: in the real window: a new canvas is chosen, and what is on it exported.
#include <gmock/gmock.h>

#include "paint/files/canvas_file.h"
#include "paint/substrate/substrate.h"
#include "surface/base/json_reading.h"
#include "surface/file/output_set.h"
#include "surface/painting_file/painting_output.h"
#include "tests/programs/support/painting_window.h"

namespace tangi {
namespace {

// Places of the panels.
constexpr std::pair<int, int> kExport{41, 106}, kOpenRaster{150, 121}, kGround{420, 79}, kBurlap{372, 143},
    kPaintOnIt{385, 501};
constexpr Region kPreview{350, 290, 640, 415};

TEST_F(Window, ANewCanvasIsChosenAndPaintedOn) {
    start();
    const auto before = screen_->settled();
    screen_->key("ctrl+n");
    EXPECT_TRUE(screen_->becomes_different(before, kPreview, 0.1));
    const auto canvas = screen_->settled();
    click(kGround);
    click(kBurlap);
    EXPECT_TRUE(screen_->becomes_different(canvas, kPreview, 0.1)) << "the preview is of burlap";
    screen_->key("Escape");
    EXPECT_TRUE(screen_->becomes_alike(before, kPreview, 0.01)) << "given up";
    screen_->key("ctrl+n");
    EXPECT_TRUE(screen_->becomes_different(canvas, kPreview, 0.1)) << "what was chosen is still chosen";
    screen_->settled();
    click(kPaintOnIt);
    EXPECT_TRUE(screen_->becomes_different(before, kCanvas, 0.1));
    EXPECT_FALSE(fs::exists(folder_ / "untitled-1.exr")) << "not before it is painted on";
    const auto bare = screen_->settled();
    paint_a_stroke();
    EXPECT_TRUE(
        screen_->becomes_different(bare, {kMiddleX - 60, kMiddleY, kMiddleX + 60, kMiddleY + 30}, 0.05));
    screen_->settled();
    screen_->key("ctrl+s");
    screen_->settled();
    const auto json = close().json();
    EXPECT_EQ(json["painting"], (folder_ / "untitled-1.exr").string());
    EXPECT_EQ(json["saves"], 1);
    const Canvas painted = read_canvas(folder_ / "untitled-1.exr");
    EXPECT_FALSE(painted.wet().empty());
    EXPECT_EQ(hash_of(painted.dry()), hash_of(make_substrate(SubstrateKind::burlap, {})));
}

TEST_F(Window, ANameThatIsTooLongIsNoCanvas) {
    start();
    screen_->key("ctrl+n");
    screen_->settled();
    screen_->x({"mousemove", "420", "457", "click", "1", "key", "ctrl+a"});
    screen_->x({"type", "--delay", "1", std::string(300, 'x')});
    click(kPaintOnIt);
    EXPECT_TRUE(program_->running()) << program_->wait().err;
    screen_->key("Escape");
    EXPECT_EQ(close().json()["painting"], painting_.string());
}

// A wrong file of keys is put aside before it is written.
TEST_F(Window, AKeyIsGivenToAnActionWhereKeysAreShown) {
    const fs::path keys = screen_->settings() / "keys.json";
    fs::create_directories(keys.parent_path());
    write_bytes(keys, R"({"shadows": "Shift+S", "bogus": "Q"})");
    start();
    screen_->key("F1");
    screen_->settled();
    click(345, 95);         // Pan
    screen_->key("space");  // has a use of its own
    screen_->settled();
    EXPECT_THAT(bytes_of(keys), testing::HasSubstr("bogus"));
    click(345, 95);
    screen_->key("j");
    EXPECT_TRUE(Screen::until([&] { return bytes_of(keys).find("tool-pan") != std::string::npos; }));
    EXPECT_THAT(bytes_of(keys.parent_path() / "keys.wrong.json"), testing::HasSubstr("bogus"));
    EXPECT_EQ(read_json(bytes_of(keys), "JSON")["tool-pan"][0], "J");
    EXPECT_EQ(close().code, 0);
}

// Dear ImGui would undo what was typed into the field before, beyond the end of what is in it now.
TEST_F(Window, UndoInAFieldThatIsUsedAgainKeepsToItsText) {
    start();
    for (int i = 0; i < 2; ++i) {
        screen_->key("ctrl+o");
        screen_->settled();
        if (i == 0) screen_->x({"type", "--delay", "5", std::string(60, 'a')});
        screen_->x({"key", "ctrl+z", "ctrl+z", "ctrl+z", "ctrl+y"});
        screen_->settled();
        ASSERT_TRUE(program_->running()) << program_->wait().err;
        if (i == 0) screen_->x({"type", "--delay", "5", std::string(60, 'b')});
        screen_->key("Escape");
        screen_->settled();
    }
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, EscapeFoldsAListAndNothingElse) {
    constexpr Region kList{350, 95, 500, 180};
    start();
    const auto before = screen_->settled();
    screen_->key("ctrl+n");
    EXPECT_TRUE(screen_->becomes_different(before, kPreview, 0.1));
    screen_->x({"mousemove", "420", "70"});
    const auto panel = screen_->settled();
    click(kGround);
    EXPECT_TRUE(screen_->becomes_different(panel, kList, 0.02));
    screen_->key("Escape");
    EXPECT_TRUE(screen_->becomes_alike(panel, kList, 0.01));
    EXPECT_TRUE(screen_->becomes_different(before, kPreview, 0.1)) << "the panel is still there";
    screen_->key("Escape");
    EXPECT_TRUE(screen_->becomes_alike(before, kPreview, 0.01));
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, ExportsWhatWasNotSavedYet) {
    start();
    paint_a_stroke();
    screen_->settled();
    click(kExport);
    click(kOpenRaster);
    screen_->key("Return");
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "small.ora"); }));
    screen_->settled();
    EXPECT_THAT(bytes_of(folder_ / "small.ora"), testing::HasSubstr("data/layer1.png"))
        << "the stroke's layer";
    EXPECT_TRUE(read_canvas(painting_).wet().empty()) << "and nothing was saved";
    screen_->key("ctrl+z");
    screen_->settled();
    EXPECT_EQ(close().code, 0) << "all is undone: nothing is asked";
    EXPECT_FALSE(fs::exists(folder_ / "small.unsaved.jsonl"));
}

// The brush and the palette with it: as if it had been saved and exported by the command, byte for byte.
TEST_F(Window, ExportsToOpenRasterWhatSavingWouldWrite) {
    start();
    paint_a_stroke();
    screen_->key("ctrl+s");
    screen_->settled();
    screen_->drag(1, {kMiddleX - 100, kMiddleY - 100}, {kMiddleX + 100, kMiddleY - 90});  // since then
    screen_->settled();
    click(kExport);
    click(kOpenRaster);
    screen_->key("Return");
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "small.ora"); }));
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().code, 0);
    const std::string by_command = (folder_ / "command.ora").string();
    ASSERT_EQ(tangipaint({"export", painting_.string(), "--to", "ora", "--out", by_command}).code, 0);
    EXPECT_THAT(bytes_of(by_command), testing::HasSubstr("rotation_rad")) << "of the brush";
    EXPECT_TRUE(bytes_of(folder_ / "small.ora") == bytes_of(by_command));
}

// Of a folder of tiles only those are written again that were painted on.
TEST_F(Window, APaintingInTilesIsPaintedOnAndSaved) {
    Surface wide = painted_surface(1300, 900);
    wide.mm_per_pixel = 0.1;
    painting_ = folder_ / "wide.tangi";
    PaintingOutput output(painting_);
    output.fill(wide, {});
    OutputSet set;
    output.add_to(set);
    set.commit();
    fs::remove(folder_ / "small.exr");
    const fs::path beside = painting_ / "0" / "1_0.exr";
    const auto written = fs::last_write_time(beside);
    start();
    paint_a_stroke();  // in the middle: within the first tile
    screen_->key("ctrl+s");
    EXPECT_TRUE(Screen::until([&] { return !painting_parts(painting_).empty(); }));
    screen_->settled();
    const Finished closed = close();
    EXPECT_EQ(closed.code, 0) << closed.err;
    EXPECT_EQ(closed.json()["saves"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
    EXPECT_EQ(fs::last_write_time(beside), written);
    EXPECT_TRUE(images_identical(read_painting(painting_).diffuse, wide.diffuse));
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("wide.tangi", "wide.tangi.strokes.jsonl"));
}

}  // namespace
}  // namespace tangi
