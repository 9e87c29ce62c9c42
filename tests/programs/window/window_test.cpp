// window_test.cpp: the real window, driven by a pointer and a keyboard: tilt, light, paint, undo,
// save, compare, open.
#include <gmock/gmock.h>

#include "paint/files/canvas_file.h"
#include "paint/session/journal.h"
#include "surface/base/json_reading.h"
#include "surface/render/relight.h"
#include "tests/programs/support/painting_window.h"

namespace tangi {
namespace {

TEST_F(Window, TiltsLightsPaintsUndoesAndSaves) {
    start();
    const auto upright = screen_->settled();
    screen_->drag(3, {kMiddleX, kMiddleY}, {kMiddleX + 90, kMiddleY + 40});
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.02)) << "tilted";
    screen_->settled();
    screen_->key("r");
    EXPECT_TRUE(screen_->becomes_alike(upright, kCanvas, 0.004)) << "straightened";
    screen_->key("l");
    screen_->drag(1, {kMiddleX, kMiddleY}, {kMiddleX + 300, kMiddleY + 20});
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.02)) << "lit from elsewhere";
    const auto raking = screen_->settled();

    const Region stroke{kMiddleX - 60, kMiddleY, kMiddleX + 60, kMiddleY + 30}, elsewhere{320, 500, 700, 600};
    paint_a_stroke();
    EXPECT_TRUE(screen_->becomes_different(raking, stroke, 0.08)) << "painted";
    const auto painted = screen_->settled();
    EXPECT_LT(Screen::difference(raking, painted, elsewhere), 0.01);
    screen_->key("ctrl+z");
    EXPECT_TRUE(screen_->becomes_alike(raking, stroke, 0.02)) << "undone";
    screen_->key("ctrl+y");
    EXPECT_TRUE(screen_->becomes_alike(painted, stroke, 0.02)) << "redone";

    screen_->key("ctrl+s");
    screen_->settled();
    const Finished done = close();
    EXPECT_EQ(done.code, 0) << done.err;
    const auto json = done.json();
    EXPECT_EQ(json["strokes"], 1);
    EXPECT_EQ(json["saves"], 1);
    EXPECT_EQ(json["unsaved"], false);
    EXPECT_GT(json["light_deg"][1], 0);
    EXPECT_LT(json["light_deg"][1], 45) << "the light was moved down";
    const Canvas canvas = read_canvas(painting_);
    EXPECT_FALSE(canvas.wet().empty());
    EXPECT_EQ(hash_of(canvas.dry()), hash_of(small_painting())) << "the dry layer never changes";
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("small.exr", "small.strokes.jsonl"));
    EXPECT_GT(read_journal(folder_ / "small.strokes.jsonl").entries.size(), 5u);
}

TEST_F(Window, GoesThroughKindsOfLight) {
    Surface red = small_painting();
    for (Rgb& colour : red.diffuse.pixels()) colour *= Rgb(1, 0.2f, 0.1f);
    write_painting(painting_, red);
    start();
    const auto daylight = screen_->settled();
    for (int i = 0; i < 3; ++i) screen_->key("j");
    EXPECT_TRUE(screen_->becomes_different(daylight, kCanvas, 0.004)) << "fluorescent";
    const auto fluorescent = screen_->settled();
    screen_->key("j");
    screen_->key("j");
    EXPECT_TRUE(screen_->becomes_alike(daylight, kCanvas, 0.001)) << "and daylight again";
    paint_a_stroke();
    screen_->settled();
    screen_->key("ctrl+z");
    for (int i = 0; i < 3; ++i) screen_->key("j");
    EXPECT_TRUE(screen_->becomes_alike(fluorescent, kCanvas, 0.001));
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, TellsOfThePixelUnderThePointerAndOfNoOther) {
    start();
    screen_->x({"search", "--name", "TangiPaint", "windowsize", "900", "650", "mousemove", "20", "640"});
    const auto bare = screen_->settled();
    constexpr Region kTold{760, 12, 890, 60};
    const auto point_at = [&](int x, int y) {
        screen_->x({"mousemove", std::to_string(x), std::to_string(y)});
    };
    for (const auto& beside : {std::pair(600, 30), std::pair(100, 300), std::pair(960, 680)}) {
        point_at(kMiddleX, kMiddleY);
        EXPECT_TRUE(screen_->becomes_different(bare, kTold, 0.05));
        point_at(beside.first, beside.second);
        EXPECT_TRUE(screen_->becomes_alike(bare, kTold, 0.005))
            << "beside the painting, over the panels, out of the window: " << beside.first;
    }
    // What was painted under a pointer that rests there is told, too.
    screen_->key("b");
    screen_->drag(1, {kMiddleX - 120, kMiddleY}, {kMiddleX, kMiddleY});
    constexpr Region kWetPaint{780, 142, 890, 156};
    EXPECT_TRUE(screen_->becomes_different(bare, kWetPaint, 0.05));
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, EveryKeyAndStepOfASlowFrameCounts) {
    Surface other = small_painting();
    for (Rgb& c : other.diffuse.pixels()) c = {0.1f, 0.2f, 0.7f};
    write_painting(folder_ / "blue.exr", other);
    start();
    const auto bare = screen_->settled();
    screen_->key("b");
    for (int i = 0; i < 3; ++i)
        screen_->drag(1, {kMiddleX - 100, kMiddleY - 120 + 100 * i},
                      {kMiddleX + 100, kMiddleY - 120 + 100 * i});
    const Region above{kMiddleX - 60, kMiddleY - 130, kMiddleX + 60, kMiddleY - 110};
    const Region below{kMiddleX - 60, kMiddleY - 30, kMiddleX + 60, kMiddleY + 90};
    const auto painted = screen_->settled();
    ASSERT_GT(Screen::difference(bare, painted, above), 0.05);
    ASSERT_GT(Screen::difference(bare, painted, below), 0.02);
    in_one_frame({"key", "ctrl+z", "key", "ctrl+z"});
    EXPECT_TRUE(screen_->becomes_alike(bare, below, 0.01)) << "two are undone";
    EXPECT_TRUE(screen_->becomes_alike(painted, above, 0.01)) << "and one is not";
    in_one_frame({"key", "ctrl+y", "key", "ctrl+y"});
    EXPECT_TRUE(screen_->becomes_alike(painted, kCanvas, 0.01));
    in_one_frame({"key", "ctrl+z", "key", "ctrl+z", "key", "ctrl+z", "key", "ctrl+z"});  // one too many
    EXPECT_TRUE(screen_->becomes_alike(bare, above, 0.01));

    screen_->x({"mousemove", std::to_string(kMiddleX), std::to_string(kMiddleY)});
    in_one_frame({"click", "4", "click", "4", "click", "4", "click", "5", "click", "5", "click", "5"});
    EXPECT_TRUE(screen_->becomes_alike(bare, kCanvas, 0.01)) << "as far back as there";
    in_one_frame({"key", "ctrl+o", "type", "--delay", "1", (folder_ / "blue.exrr").string()});
    in_one_frame({"key", "BackSpace", "key", "Return"});
    screen_->settled();
    screen_->key("Return");  // what was painted and undone is saved
    EXPECT_TRUE(Screen::until([&] {
        const Rgb c = screen_->picture()(kMiddleX, kMiddleY - 100);  // beside the pointer
        return c.b > 1.5f * c.r;
    })) << "the name was typed, mended and entered";
    EXPECT_EQ(close().json()["painting"], (folder_ / "blue.exr").string());
}

// Photographs of a painting, as it would be relit, with a lights file; the second one is damaged.
fs::path photographs_of(Surface& painting, const fs::path& folder) {
    fs::create_directory(folder);
    Photography& photography = painting.photography;
    photography.transfer = {Transfer::Kind::srgb};
    std::string lights = "4\n";
    for (int i = 0; i < 4; ++i) {
        const Light light = distant_light({i - 1.5f, 0.5f, 1}, fmt::format("{}.png", i));
        photography.photos.push_back({.light = light, .fitted = i != 3});
        const Image<Rgb> picture = relight(painting, {&light, 1}, {.cast_shadows = true});
        write_picture(folder / light.name, picture, photography.transfer);
        lights +=
            fmt::format("{} {} {} {}\n", light.name, light.direction.x, light.direction.y, light.direction.z);
    }
    write_bytes(folder / "lights.lp", lights);
    const std::string whole = bytes_of(folder / "1.png");
    write_bytes(folder / "1.png", whole.substr(0, whole.size() / 2));
    return folder;
}

TEST_F(Window, HoldsPhotographsAgainstThePainting) {
    Surface painting = small_painting();
    const fs::path photos = photographs_of(painting, folder_ / "photos");
    write_painting(painting_, painting);
    start({"--photos", photos.string()});
    const auto wiped = screen_->settled();
    // Both halves are the painting under the photograph's light: their difference is grey, and no colour.
    screen_->x({"key", "v", "key", "v"});  // blink, difference
    EXPECT_TRUE(screen_->becomes_different(wiped, kCanvas, 0.05));
    const auto difference = screen_->settled();
    const Rgb none = difference(kMiddleX, kMiddleY);
    EXPECT_NEAR(none.r, none.g, 0.03);
    EXPECT_NEAR(none.g, none.b, 0.03);
    EXPECT_GT(none.g, 0.8) << "the diverging scale's middle";
    screen_->x({"key", "v", "key", "v", "key", "v"});  // colour difference, side by side, wipe
    EXPECT_TRUE(screen_->becomes_alike(wiped, kCanvas, 0.01));
    screen_->key("Next");  // past the damaged one
    EXPECT_TRUE(screen_->becomes_different(wiped, kCanvas, 0.01)) << "another photograph";
    screen_->x({"key", "g"});
    screen_->drag(1, {kMiddleX - 100, kMiddleY - 50}, {kMiddleX, kMiddleY + 50});
    screen_->settled();
    screen_->key("ctrl+r");
    screen_->settled();
    screen_->enter((folder_ / "report").string());  // not there yet
    const fs::path page = folder_ / "report" / "compare.html";
    EXPECT_TRUE(Screen::until([&] { return fs::exists(page); }));
    const auto report = read_json(bytes_of(folder_ / "report" / "compare.json"), "JSON");
    ASSERT_EQ(report["photos"].size(), 3u) << "the damaged one is left out";
    for (const auto& photo : report["photos"]) EXPECT_GT(photo["psnr_db"], 40.0) << photo["name"];

    screen_->key("ctrl+shift+s");
    screen_->settled();
    screen_->x({"key", "ctrl+a"});
    screen_->enter((folder_ / "copy.exr").string());
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "copy.exr"); }));
    screen_->settled();
    EXPECT_EQ(close().json()["painting"], (folder_ / "copy.exr").string()) << "it has that name from then on";
    EXPECT_EQ(hash_of(read_painting(folder_ / "copy.exr")), hash_of(painting));
}

TEST_F(Window, PhotographsStayWhenATreatmentOfThePaintingBegins) {
    Surface painting = small_painting();
    painting.scale_known = true;
    const fs::path photos = photographs_of(painting, folder_ / "photos");
    write_painting(painting_, painting);
    start({"--photos", photos.string()});
    screen_->key("ctrl+t");
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "small.treatment" / "log.jsonl"); }));
    screen_->settled();
    screen_->key("ctrl+r");
    screen_->settled();
    screen_->enter((folder_ / "report").string());
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "report" / "compare.html"); }));
    screen_->settled();
    EXPECT_EQ(close().json()["painting"], (folder_ / "small.treatment" / "painting.exr").string());
}

TEST_F(Window, OpensAnotherPainting) {
    Surface other = small_painting();
    for (Rgb& c : other.diffuse.pixels()) c = {0.1f, 0.2f, 0.7f};
    write_painting(folder_ / "blue.exr", other);
    start();
    paint_a_stroke();
    screen_->settled();
    screen_->key("ctrl+o");
    screen_->settled();
    screen_->enter((folder_ / "blue.exr").string());
    screen_->settled();
    EXPECT_EQ(read_canvas(painting_).wet().empty(), true);
    screen_->key("Return");  // save what is not saved, and open
    EXPECT_TRUE(Screen::until([&] {
        const Rgb c = screen_->picture()(kMiddleX, kMiddleY - 100);
        return c.b > 1.5f * c.r;
    })) << "the blue one is shown";
    EXPECT_FALSE(read_canvas(painting_).wet().empty()) << "and the first was saved";
    paint_a_stroke();
    screen_->settled();
    screen_->key("ctrl+s");
    screen_->settled();
    const auto json = close().json();
    EXPECT_EQ(json["painting"], (folder_ / "blue.exr").string());
    EXPECT_EQ(json["strokes"], 2);
    EXPECT_EQ(json["saves"], 2);
    EXPECT_FALSE(read_canvas(folder_ / "blue.exr").wet().empty());
}

TEST_F(Window, AKeyAfterTheOneThatClosesADialogCounts) {
    start();
    const auto bare = screen_->settled();
    paint_a_stroke();
    const Region across{kMiddleX - 60, kMiddleY - 10, kMiddleX + 60, kMiddleY + 50};
    ASSERT_TRUE(screen_->becomes_different(bare, across, 0.02));
    screen_->key("ctrl+o");
    screen_->settled();
    in_one_frame({"key", "Escape", "key", "ctrl+z"});
    EXPECT_TRUE(screen_->becomes_alike(bare, across, 0.01)) << "undone";
    screen_->key("ctrl+s");
    screen_->settled();
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, AStrokeBesideThePaintingIsNone) {
    start();
    screen_->key("b");
    for (int i = 0; i < 10; ++i) screen_->key("bracketleft");  // 3 mm
    screen_->drag(1, {400, 40}, {900, 30});
    screen_->settled();
    EXPECT_FALSE(fs::exists(folder_ / "small.unsaved.jsonl"));
    screen_->drag(1, {400, 40}, {kMiddleX, kMiddleY});  // comes in from there
    screen_->key("ctrl+s");
    screen_->settled();
    const auto json = close().json();
    EXPECT_EQ(json["strokes"], 1);
    EXPECT_FALSE(read_canvas(painting_).wet().empty());
}

// Beside the painting, whose right border is at 95 % of the canvas; as it was, it would be larger than that.
TEST_F(Window, AFittedPaintingIsFittedWhenTheWindowChanges) {
    start();
    const auto resize = [&](const char* width, const char* height) {
        screen_->x({"search", "--name", "TangiPaint", "windowsize", width, height});
    };
    const auto is_bright = [&](int x, int y) { return glm::length(screen_->picture()(x, y)) > 0.4f; };
    resize("800", "560");
    EXPECT_TRUE(Screen::until([&] { return is_bright(540, 280) && !is_bright(796, 280); }));
    screen_->x({"mousemove", "540", "280", "click", "4"});  // not fitted any more
    EXPECT_TRUE(Screen::until([&] { return is_bright(796, 280); }));
    resize("1000", "700");
    screen_->settled();
    EXPECT_FALSE(is_bright(990, kMiddleY));
    resize("700", "560");
    screen_->settled();
    EXPECT_TRUE(is_bright(696, 280)) << "what one has moved stays as large as it is";
    EXPECT_EQ(close().code, 0);
}

TEST_F(Window, ResizedToNothingGoesOn) {
    start();
    screen_->x({"search", "--name", "TangiPaint", "windowsize", "1", "1"});
    EXPECT_TRUE(Screen::until([&] { return glm::length(screen_->picture()(kMiddleX, kMiddleY)) < 0.05f; }))
        << "gone";
    screen_->x({"search", "--name", "TangiPaint", "windowsize", "1000", "700"});
    EXPECT_TRUE(Screen::until([&] { return glm::length(screen_->picture()(kMiddleX, kMiddleY)) > 0.1f; }))
        << "back";
    EXPECT_EQ(close().code, 0);
}

}  // namespace
}  // namespace tangi
