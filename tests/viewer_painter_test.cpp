// viewer_painter_test.cpp: what the window sends is painted, shown, recorded, saved; on a thread of its own.
#include "viewer/painter.h"

#include "paint/canvas_file.h"
#include "paint_support.h"
#include "surface/painting_file.h"
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
        TexelTiles tiles(painter_->surface(), painter_->range(), 7);
        shown_ = tiles;
        painter_->start(std::move(tiles));
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
    TexelTiles shown_;
};

TEST_F(PainterTest, ShowsStrokesWhereTheyAre) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    const PainterNews news = settle();
    EXPECT_EQ(news.state.strokes, 1);
    EXPECT_TRUE(news.state.unsaved && news.state.can_undo);
    EXPECT_THAT(news.messages, testing::IsEmpty());
    ASSERT_FALSE(news.patches.empty());
    // Texels of the stroke's middle are white paint; its tiles alone were sent.
    bool white = false;
    std::size_t texels = 0;
    for (const TexelPatch& patch : news.patches) {
        ASSERT_EQ(patch.texels.size(), static_cast<std::size_t>(patch.region.width()) *
                                           static_cast<std::size_t>(patch.region.height()));
        texels += patch.texels.size();
        if (patch.level == 0)
            for (const Texel& texel : patch.texels)
                white |= unpack(texel, painter_->range()).diffuse.b > 0.8f;
    }
    EXPECT_TRUE(white);
    EXPECT_LT(texels, 400u * 150 * 4);
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
    for (const TexelPatch& patch : news.patches) {
        if (patch.level > 0) continue;
        for (const Texel& texel : patch.texels)
            ASSERT_NEAR(unpack(texel, painter_->range()).diffuse.r, 0.5f, 0.01f);
    }
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

TEST(Sitting, SavedJournalsAreNotRecoveredTwice) {
    TestDir folder;
    const SittingFiles files = sitting_files(folder / "a.exr");
    EXPECT_FALSE(left_over(files));
    SittingRecord record(files);
    record.append(UndoEvent{});
    EXPECT_TRUE(left_over(files)) << "a painting that is not there";
    write_bytes(files.painting, "saved later");
    fs::last_write_time(files.unsaved, fs::last_write_time(files.painting) - std::chrono::seconds(1));
    EXPECT_FALSE(left_over(files));
    fs::last_write_time(files.unsaved, fs::last_write_time(files.painting) + std::chrono::seconds(1));
    EXPECT_TRUE(left_over(files));
    record.discard();
    EXPECT_FALSE(left_over(files));
    EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.discarded.jsonl", "a.exr"));
}

}  // namespace
}  // namespace tangi
