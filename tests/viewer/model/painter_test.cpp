// painter_test.cpp: what the window sends is painted and shown, on a thread of its own.
#include <gmock/gmock.h>

#include "paint/canvas/appearance.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/support/viewer/painter_support.h"

namespace tangi {
namespace {

TEST_F(PainterTest, ProbesWithTheStandardErrorsOfTheFile) {
    PartToWrite errors;
    errors.info = {"errors", 200, 150, {"diffuse", "height", "specular"}, {}};
    errors.fill = [](int y0, int y1, std::span<float* const> planes) {
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < 200; ++x) {
                planes[0][(y - y0) * 200 + x] = 0.5f;
                planes[1][(y - y0) * 200 + x] = static_cast<float>(x + 1000 * y);
            }
    };
    {
        AtomicFile file(file_);
        write_painting(file, *flat_surface(200, 150), {&errors, 1});
    }
    open();
    painter_->probe(17, 40);
    const PainterNews bare = settle();
    ASSERT_TRUE(bare.probe);
    EXPECT_EQ(bare.probe->errors.height_mm, 40017);
    EXPECT_EQ(bare.probe->errors.diffuse, 0.5f);
    EXPECT_EQ(bare.probe->errors.specular, 0) << "0: not known";
    EXPECT_EQ(bare.probe->errors.slope, 0) << "the file has none";
    stroke();
    painter_->probe(100, 75);
    const PainterNews painted = settle();
    ASSERT_TRUE(painted.probe);
    EXPECT_GT(painted.probe->paint_mm, 0);
    EXPECT_EQ(painted.probe->errors.height_mm, 0) << "paint lies over what was fitted";
}

TEST_F(PainterTest, ShowsStrokesWhereTheyAre) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    const PainterNews news = settle();
    EXPECT_EQ(news.state.strokes, 1);
    EXPECT_TRUE(news.state.unsaved && news.state.can_undo);
    EXPECT_THAT(news.messages, testing::IsEmpty());
    ASSERT_FALSE(news.changed.empty());
    // Texels of the stroke's middle are white paint; its tiles alone changed.
    bool white = false;
    int pixels = 0;
    for (const Region& region : news.changed) {
        const Region all = shown_->region_at(0, region);
        pixels += all.width() * all.height();
        for (int y = all.y0; y < all.y1; ++y)
            for (int x = all.x0; x < all.x1; ++x)
                white |= unpack(shown_->at(x, y), painter_->range()).diffuse.b > 0.8f;
    }
    EXPECT_TRUE(white);
    EXPECT_LT(pixels, 200 * 150 * 4);
}

TEST_F(PainterTest, UndoBringsTheOldTexelsBack) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    settle();
    painter_->send(UndoEvent{});
    const PainterNews news = settle();
    EXPECT_EQ(news.state.undone, 1);
    EXPECT_TRUE(news.state.can_redo);
    for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 200; ++x)
            ASSERT_NEAR(unpack(shown_->at(x, y), painter_->range()).diffuse.r, 0.5f, 0.01f);
}

// Cadmium red over a blue ground, by an incandescent light: as appearance() has it, also what is painted
// then, and daylight brings the texels of before back. Measures and files stay in daylight.
TEST_F(PainterTest, ShowsTheColoursOfAnotherLight) {
    const auto ground = flat_surface(200, 600);
    ground->diffuse = Image<Rgb>(200, 600, Rgb(0.1f, 0.15f, 0.5f));
    write_painting(file_, *ground);
    open();
    stroke();
    PaletteEvent lay_out;
    lay_out.paints = {"Cadmium Red Light", "Ultramarine Blue"};
    painter_->send(lay_out);
    const PainterNews daylight = settle();
    const auto texels = [&] {
        std::vector<Texel> all;
        for (int level = 0; level < shown_->levels(); ++level) {
            const LevelSize size = level_size(200, 600, level);
            for (int y = 0; y < size.height; ++y)
                for (int x = 0; x < size.width; ++x) all.push_back(shown_->at(x, y, level));
        }
        return all;
    };
    const auto expected = [&](Illuminant light) {
        std::optional<Surface> seen;
        painter_->look([&](const Surface&, const Canvas& c) { seen = appearance(c, {.illuminant = light}); });
        settle();
        return TexelTiles(*seen, painter_->range());
    };
    const auto expect_shown = [&](const TexelTiles& as) {
        for (int y = 0; y < 600; ++y)
            for (int x = 0; x < 200; ++x) ASSERT_EQ(shown_->at(x, y), as.at(x, y)) << x << " " << y;
        EXPECT_EQ(shown_->at(0, 0, 4), as.at(0, 0, 4));
    };
    const std::vector<Texel> before = texels();
    painter_->show_in(Illuminant::a);
    PainterNews news = settle();
    int rows = 0;
    for (const Region& region : news.changed) rows += region.width() == 200 ? region.height() : 0;
    EXPECT_EQ(rows, 600) << "all of it is to be uploaded";
    ASSERT_EQ(news.board.size(), 1u) << "the palette too, as a whole";
    EXPECT_NE(news.board[0].srgb, daylight.board[0].srgb);
    expect_shown(expected(Illuminant::a));
    EXPECT_NE(texels(), before);

    stroke(3);
    settle();
    expect_shown(expected(Illuminant::a));
    painter_->probe(100, 20);
    news = settle();
    ASSERT_TRUE(news.probe);
    EXPECT_NEAR(news.probe->material.diffuse.b, 0.5f, 1e-6) << "in daylight";

    painter_->send(UndoEvent{});
    painter_->show_in(Illuminant::f11);
    painter_->show_in(Illuminant::d65);
    settle();
    EXPECT_EQ(texels(), before);
}

TEST_F(PainterTest, ProbesAndPicks) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    painter_->pick(100, 75, 2);
    painter_->probe(5, 6);
    painter_->probe(-1, 600);
    const PainterNews news = settle();
    ASSERT_TRUE(news.picked && news.probe);
    ASSERT_EQ(news.picked->recipe.size(), 1u);
    EXPECT_EQ(news.picked->recipe[0].first, "Titanium White");
    EXPECT_GT(news.picked->paint_mm, 0);
    EXPECT_EQ(news.probe->x, 5);
    EXPECT_NEAR(news.probe->material.diffuse.g, 0.4f, 1e-6f);
    EXPECT_EQ(news.probe->paint_mm, 0);
}

// What is probed is what is seen.
TEST_F(PainterTest, ProbesTheStateThatIsShown) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    painter_->show_as([](const Canvas& canvas) { return Canvas(canvas.dry_shared()); });
    painter_->probe(100, 75);
    const PainterNews before = settle();
    ASSERT_TRUE(before.probe);
    EXPECT_EQ(before.probe->paint_mm, 0);
    EXPECT_TRUE(before.probe->recipe.empty());
    painter_->show_as({});
    painter_->probe(100, 75);
    const PainterNews now = settle();
    EXPECT_GT(now.probe->paint_mm, 0);
}

// Who mixed paint on the palette goes on with it, whatever comes between; who washed the brush, does not.
TEST_F(PainterTest, WhatIsOnTheBrushIsThereWhenItIsOpenedAgain) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    EXPECT_EQ(settle().brush_goes_on, false);
    stroke();
    PileEvent pile;
    pile.paint = {{"Cadmium Red Light", 1}};
    painter_->send(pile);
    const auto dip = [&] {
        StrokeEvent event;
        event.brush = even_brush();
        event.on = Place::palette;
        painter_->send(event);
        for (int i = 0; i <= 20; ++i)
            painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = i - 10.0, .y_mm = 0}});
        painter_->send(EndEvent{});
    };
    dip();
    const PainterState dipped = settle().state;
    ASSERT_GT(dipped.on_brush.fill, 0);
    painter_->save();
    settle();
    open();
    PainterNews again = settle();
    EXPECT_EQ(again.brush_goes_on, true);
    EXPECT_EQ(again.state.on_brush, dipped.on_brush);
    stroke();
    settle();
    dip();
    settle();
    painter_.reset();
    open();
    EXPECT_EQ(settle().brush_goes_on, true) << "as in the file";
    painter_->recover(std::move(*left_over(recovery_files(file_))));
    EXPECT_EQ(settle().brush_goes_on, true);
    painter_->send(WashEvent{});
    again = settle();
    EXPECT_EQ(again.state.on_brush, OnBrush());
    painter_->save();
    settle();
    EXPECT_TRUE(recorded_as_saved(file_));
    open();
    EXPECT_EQ(settle().brush_goes_on, false);
}

TEST_F(PainterTest, WhatMakesNoSenseIsSaidAndNothingElse) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    painter_->send(UndoEvent{});
    const PainterNews news = settle();
    EXPECT_THAT(news.messages, testing::ElementsAre("there is nothing to undo"));
    EXPECT_FALSE(fs::exists(folder_ / "a.unsaved.jsonl")) << "a replay would stumble over it";
}

TEST_F(PainterTest, ThePaletteIsShownWhereItChanges) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    EXPECT_FALSE(settle().state.has_board);
    PaletteEvent lay_out;
    lay_out.paints = {"Titanium White", "Ultramarine Blue"};
    painter_->send(lay_out);
    PainterNews news = settle();
    EXPECT_THAT(news.messages, testing::IsEmpty());
    ASSERT_TRUE(news.state.has_board);
    ASSERT_EQ(news.board.size(), 1u) << "the whole of it, first";
    EXPECT_EQ(news.board[0].region, (Region{0, 0, news.board[0].width, news.board[0].height}));
    const auto blue = std::count_if(news.board[0].srgb.begin(), news.board[0].srgb.end(),
                                    [](const auto& c) { return c.b > c.r + 40; });
    EXPECT_GT(blue, 100) << "the pile is seen";
    const std::size_t whole = news.board[0].srgb.size();
    StrokeEvent event;
    event.brush = even_brush();
    event.paint = {{"Ultramarine Blue", 1}};
    event.on = Place::palette;
    painter_->send(event);
    for (int i = 0; i <= 5; ++i) painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = i - 3.0, .y_mm = 0}});
    painter_->send(EndEvent{});
    news = settle();
    EXPECT_THAT(news.messages, testing::IsEmpty());
    EXPECT_THAT(news.changed, testing::IsEmpty()) << "the painting has not changed";
    std::size_t changed = 0;
    for (const BoardPatch& patch : news.board) changed += patch.srgb.size();
    EXPECT_LT(changed, whole);
}

TEST_F(PainterTest, TellsWhatIsOnTheBrush) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    EXPECT_EQ(settle().state.on_brush, OnBrush());
    StrokeEvent event;
    event.brush = even_brush();
    event.paint = {{"Titanium White", 1}, {"Ultramarine Blue", 3}};
    painter_->send(event);
    painter_->send(PointEvent{{.x_mm = -10}});
    const PainterState began = settle().state;
    EXPECT_TRUE(began.stroking);
    EXPECT_GT(began.on_brush.fill, 0.8);
    EXPECT_LE(began.on_brush.fill, 1.001);
    for (int i = 1; i <= 80; ++i)
        painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = 10 * std::cos(0.2 * i), .y_mm = 0.1 * i}});
    painter_->send(EndEvent{});
    const PainterState ended = settle().state;
    EXPECT_FALSE(ended.stroking);
    EXPECT_LT(ended.on_brush.fill, 0.9 * began.on_brush.fill) << "what is painted is gone from it";
    ASSERT_EQ(ended.on_brush.recipe.size(), 2u);
    EXPECT_EQ(ended.on_brush.recipe.front().first, "Ultramarine Blue");
    EXPECT_NEAR(ended.on_brush.recipe.front().second, 0.75, 0.02);
    EXPECT_GT(ended.on_brush.colour.b, ended.on_brush.colour.r);
}

TEST_F(PainterTest, ThePalettesPilesLieBesideEachOther) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    const auto painted_tiles = [&] {
        std::vector<Region> tiles;
        for (const BoardPatch& patch : settle().board) tiles.push_back(patch.region);
        return tiles;
    };
    PileEvent pile;
    pile.paint = {{"Titanium White", 1}};
    painter_->squeeze(pile);
    painted_tiles();
    pile.paint = {{"Bone Black", 1}};
    painter_->squeeze(pile);
    painted_tiles();
    painter_->save();
    settle();
    std::vector<PointMm> at;
    for (const Journal::Entry& entry : read_journal(folder_ / "a.strokes.jsonl").entries)
        if (const auto* squeezed = std::get_if<PileEvent>(&entry.event)) at.push_back(squeezed->at);
    ASSERT_EQ(at.size(), 2u);
    EXPECT_GT(std::hypot(at[0].x - at[1].x, at[0].y - at[1].y), 0.9 * pile.size_mm);
}

}  // namespace
}  // namespace tangi
