// viewer_painter_test.cpp: what the window sends is painted, shown, recorded, saved; on a thread of its own.
#include "viewer/painter.h"

#include "paint/canvas_file.h"
#include "paint_support.h"
#include "surface/painting_file.h"
#include "surface/painting_parts.h"
#include "viewer_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

class PainterTest : public testing::Test {
protected:
    void open(bool is_new = false) {
        painter_.reset();
        Painter::Setup setup{is_new || !fs::exists(file_) ? flat_canvas(200, 150) : read_canvas(file_),
                             artist_acrylics(), file_, is_new};
        painter_ = std::make_unique<Painter>(std::move(setup), [] {});
        shown_ = std::make_shared<TexelTiles>(painter_->surface(), painter_->range());
        painter_->start(shown_);
    }

    void stroke(double y_mm = 0) {
        StrokeEvent event;
        event.brush = even_brush();
        event.paint = {{"Titanium White", 1}};
        painter_->send(event);
        for (int i = 0; i <= 20; ++i)
            painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = i - 10.0, .y_mm = y_mm}});
        painter_->send(EndEvent{});
    }

    PainterNews settle() {
        painter_->wait();
        return painter_->fetch();
    }

    TestDir folder_;
    fs::path file_ = folder_ / "a.exr";
    std::unique_ptr<Painter> painter_;
    std::shared_ptr<TexelTiles> shown_;
};

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

TEST_F(PainterTest, RecordsBeforeItPaintsAndPutsAwayWhenSaved) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    settle();
    EXPECT_EQ(read_journal(folder_ / "a.unsaved.jsonl").entries.size(), 23u);
    painter_->save();
    const PainterNews news = settle();
    EXPECT_FALSE(news.state.unsaved);
    EXPECT_EQ(news.state.saves, 1);
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("a.exr", "a.strokes.jsonl"));
    stroke(5);
    painter_->save();
    settle();
    EXPECT_EQ(read_journal(folder_ / "a.strokes.jsonl").entries.size(), 46u) << "one sitting after the other";
    painter_.reset();
    EXPECT_FALSE(read_canvas(file_).wet().empty());
}

// A window that closes does not wait for strokes: they are in the journal, and come back.
TEST_F(PainterTest, InAHurryItRecordsAndPaintsNothing) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    std::promise<void> begun, go_on;
    const auto held = painter_->look([&](const Surface&, const Canvas&) {
        begun.set_value();
        go_on.get_future().wait();
    });
    begun.get_future().wait();
    EXPECT_FALSE(painter_->idle());
    for (int i = 0; i < 3; ++i) stroke(2.0 * i);
    painter_->send(UndoEvent{});  // there is nothing to undo
    painter_->save();
    auto changed = painter_->change([](Canvas&) {});
    painter_->hurry(false);
    painter_->hurry(true);  // or it would be painted and saved
    go_on.set_value();
    const PainterNews news = settle();
    EXPECT_TRUE(painter_->idle());
    EXPECT_EQ(news.state.strokes, 3);
    EXPECT_EQ(news.state.saves, 0);
    EXPECT_TRUE(news.state.unsaved);
    EXPECT_THAT(news.messages, testing::ElementsAre(testing::HasSubstr("a.exr was not saved")));
    EXPECT_THROW(changed.get(), Cancelled);
    painter_.reset();
    EXPECT_TRUE(read_canvas(file_).wet().empty());
    auto journal = left_over(sitting_files(file_));
    ASSERT_TRUE(journal);
    EXPECT_EQ(journal->entries.size(), 3 * 23u);
    open();
    painter_->recover(std::move(*journal));
    EXPECT_EQ(settle().state.strokes, 3);
}

TEST_F(PainterTest, ASaveThatIsWaitedForIsNotHurried) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    painter_->save();
    painter_->hurry(false);
    const PainterNews news = settle();
    EXPECT_EQ(news.state.saves, 1);
    EXPECT_FALSE(read_canvas(file_).wet().empty());
}

TEST_F(PainterTest, RecoversBitForBit) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    stroke(6);
    settle();
    painter_.reset();  // without saving
    auto journal = left_over(sitting_files(file_));
    ASSERT_TRUE(journal);
    open();
    painter_->recover(std::move(*journal));
    EXPECT_EQ(settle().state.strokes, 2);
    painter_->save();
    settle();
    painter_.reset();

    Session once(Canvas(flat_surface(200, 150)), artist_acrylics());
    replay(once, read_journal(folder_ / "a.strokes.jsonl"));
    EXPECT_TRUE(identical(read_canvas(file_).wet(), once.canvas().wet()));
    EXPECT_FALSE(left_over(sitting_files(file_)));
}

TEST_F(PainterTest, ANewCanvasIsWrittenBeforeItsFirstStroke) {
    open(true);
    settle();
    EXPECT_FALSE(fs::exists(file_));
    stroke();
    settle();
    EXPECT_TRUE(read_canvas(file_).wet().empty());
    EXPECT_TRUE(left_over(sitting_files(file_)));
}

TEST_F(PainterTest, AFullDiskLosesNothing) {
    write_painting(file_, *flat_surface(200, 150));
    const std::string before = bytes_of(file_);
    open();
    stroke();
    settle();
    {
        const FullDisk disk(2000);
        painter_->save();
        const PainterNews news = settle();
        EXPECT_THAT(news.messages, testing::ElementsAre(testing::HasSubstr("a.exr")));
        EXPECT_TRUE(news.state.unsaved);
        EXPECT_EQ(news.state.saves, 0);
    }
    EXPECT_TRUE(bytes_of(file_) == before);
    EXPECT_TRUE(fs::exists(folder_ / "a.unsaved.jsonl"));
    painter_->save();
    EXPECT_FALSE(settle().state.unsaved);
    EXPECT_TRUE(bytes_of(file_) != before);
}

TEST_F(PainterTest, WhereNothingCanBeRecordedOneIsTold) {
    fs::create_directory(folder_ / "b.unsaved.jsonl");
    file_ = folder_ / "b.exr";
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    const PainterNews news = settle();
    EXPECT_THAT(news.messages, testing::ElementsAre(testing::HasSubstr("strokes are not recorded")));
    EXPECT_EQ(news.state.strokes, 1) << "painting goes on";
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

TEST_F(PainterTest, WhatMakesNoSenseIsSaidAndNothingElse) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    painter_->send(UndoEvent{});
    const PainterNews news = settle();
    EXPECT_THAT(news.messages, testing::ElementsAre("there is nothing to undo"));
    EXPECT_FALSE(fs::exists(folder_ / "a.unsaved.jsonl")) << "a replay would stumble over it";
}

TEST_F(PainterTest, SavingKeepsWhatOtherModulesHaveInTheFile) {
    const auto surface = flat_surface(200, 150);
    PartToWrite part{{"errors", 200, 150, {"a", "b"}, {{"note", "of the fit"}}, false},
                     [](int y0, int y1, std::span<float* const> planes) {
                         for (int y = y0; y < y1; ++y)
                             for (int x = 0; x < 200; ++x)
                                 planes[1][static_cast<std::size_t>((y - y0) * 200 + x)] =
                                     static_cast<float>(1000 * y + x);
                     }};
    {
        AtomicFile file(file_);
        write_painting(file, *surface, {&part, 1});
    }
    open();
    for (int time = 0; time < 2; ++time) {
        stroke();
        painter_->save();
        settle();
        const auto parts = painting_parts(file_);
        const auto kept =
            std::find_if(parts.begin(), parts.end(), [](const auto& p) { return p.name == "errors"; });
        ASSERT_NE(kept, parts.end());
        EXPECT_EQ(kept->attributes.at("note"), "of the fit");
        int wrong = 0;
        read_painting_part(file_, *kept, [&](int y0, int y1, std::span<const float* const> planes) {
            for (int y = y0; y < y1; ++y)
                for (int x = 0; x < 200; ++x) {
                    const auto at = static_cast<std::size_t>((y - y0) * 200 + x);
                    wrong += planes[0][at] != 0 || planes[1][at] != static_cast<float>(1000 * y + x);
                }
        });
        EXPECT_EQ(wrong, 0);
    }
}

// Another window has the painting: here it is looked at, and neither its journal nor its file is touched.
TEST_F(PainterTest, APaintingIsPaintedInOneWindow) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke(0);
    EXPECT_FALSE(settle().state.elsewhere);
    const std::string before = bytes_of(file_), journal = bytes_of(folder_ / "a.unsaved.jsonl");
    const std::unique_ptr<Painter> first = std::move(painter_);
    open();
    EXPECT_TRUE(settle().state.elsewhere);
    stroke(5);
    painter_->save();
    PainterNews news = settle();
    EXPECT_FALSE(news.state.unsaved);
    ASSERT_FALSE(news.messages.empty());
    EXPECT_THAT(news.messages, testing::Each("a.exr is open in another window: paint there, or save it under "
                                             "another name here"));
    EXPECT_THROW(painter_->change([](Canvas&) {}).get(), Error);
    EXPECT_EQ(bytes_of(file_), before);
    EXPECT_EQ(bytes_of(folder_ / "a.unsaved.jsonl"), journal);

    // Under a name of its own it is painted on; the other's journal stays.
    painter_->save_as(folder_ / "b.exr");
    EXPECT_FALSE(settle().state.elsewhere);
    stroke(5);
    EXPECT_TRUE(settle().state.unsaved);
    EXPECT_TRUE(fs::exists(folder_ / "b.unsaved.jsonl"));
    EXPECT_EQ(bytes_of(folder_ / "a.unsaved.jsonl"), journal);

    // The first one keeps what it has, though saving makes a new file of it, and does not write over the
    // other's.
    first->save();
    first->wait();
    painter_->save_as(file_);
    EXPECT_THAT(settle().messages, testing::Contains("a.exr is open in another window: choose another name"));
    first->save_as(folder_ / "d.exr");
    first->wait();
    painter_->save_as(file_);
    EXPECT_EQ(settle().state.saves, 2) << "nobody's by now";
}

TEST_F(PainterTest, ItsOwnNameSpelledOtherwiseIsItsOwn) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke(0);
    painter_->save_as(folder_.path() / "." / "a.exr");
    EXPECT_EQ(settle().state.saves, 1);
    EXPECT_EQ(painter_->file(), file_);
    EXPECT_TRUE(fs::exists(folder_ / "a.strokes.jsonl"));
    EXPECT_FALSE(fs::exists(folder_ / "a.discarded.jsonl"));
}

TEST_F(PainterTest, SavedUnderAnotherNameTheRecordGoesAlong) {
    write_painting(file_, *flat_surface(200, 150));
    const std::string before = bytes_of(file_);
    open();
    stroke(0);
    const fs::path other = folder_ / "b.exr";
    write_bytes(folder_ / "b.unsaved.jsonl", "of another painting of this name");
    painter_->save_as(other);
    stroke(5);
    const PainterNews news = settle();
    EXPECT_EQ(painter_->file(), other);
    EXPECT_TRUE(news.state.unsaved);
    EXPECT_EQ(bytes_of(file_), before) << "the first file stays as it was";
    EXPECT_FALSE(fs::exists(folder_ / "a.unsaved.jsonl"));
    EXPECT_EQ(bytes_of(folder_ / "b.discarded.jsonl"), "of another painting of this name");
    const auto strokes = [&](const char* file) {
        const auto entries = read_journal(folder_ / file).entries;
        return std::count_if(entries.begin(), entries.end(), [](const auto& entry) {
            return std::holds_alternative<StrokeEvent>(entry.event);
        });
    };
    EXPECT_EQ(strokes("b.strokes.jsonl"), 1);
    EXPECT_EQ(strokes("b.unsaved.jsonl"), 1);
    painter_->save();
    settle();
    EXPECT_EQ(strokes("b.strokes.jsonl"), 2);
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

}  // namespace
}  // namespace tangi
