// painter_files_test.cpp: strokes are recorded, saved and recovered, in one window at a time.
#include <gmock/gmock.h>

#include "surface/painting_file/painting_parts.h"
#include "tests/support/viewer/painter_support.h"

namespace tangi {
namespace {

TEST_F(PainterTest, RecordsBeforeItPaintsAndPutsAwayWhenSaved) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    settle();
    constexpr std::size_t events = 24;  // which paints; stroke, 21 points, end
    EXPECT_EQ(read_journal(folder_ / "a.unsaved.jsonl").entries.size(), events);
    painter_->save();
    const PainterNews news = settle();
    EXPECT_FALSE(news.state.unsaved);
    EXPECT_EQ(news.state.saves, 1);
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("a.exr", "a.strokes.jsonl"));
    stroke(5);
    painter_->save();
    settle();
    EXPECT_EQ(read_journal(folder_ / "a.strokes.jsonl").entries.size(), 2 * events)
        << "one sitting after the other";
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
    auto journal = left_over(recovery_files(file_));
    ASSERT_TRUE(journal);
    EXPECT_EQ(journal->entries.size(), 1 + 3 * 23u) << "which paints, and three strokes";
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
    auto journal = left_over(recovery_files(file_));
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
    EXPECT_FALSE(left_over(recovery_files(file_)));
}

TEST_F(PainterTest, ANewCanvasIsWrittenBeforeItsFirstStroke) {
    open(true);
    settle();
    EXPECT_FALSE(fs::exists(file_));
    stroke();
    settle();
    EXPECT_TRUE(read_canvas(file_).wet().empty());
    EXPECT_TRUE(left_over(recovery_files(file_)));
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

// As a step of a treatment from the command line does.
TEST_F(PainterTest, ItStaysInOneWindowThoughAnotherProgramWritesItAnew) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    std::unique_ptr<Painter> first = std::move(painter_);
    write_painting(file_, *flat_surface(200, 150));
    open();
    EXPECT_TRUE(settle().state.elsewhere);
    fs::create_directory_symlink(folder_.path(), folder_ / "linked");
    file_ = folder_ / "linked" / "a.exr";
    open();
    EXPECT_TRUE(settle().state.elsewhere) << "by another way to it";
    first.reset();
    open();
    EXPECT_FALSE(settle().state.elsewhere) << "nobody's by now";
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

TEST_F(PainterTest, WhatIsAllUndoneIsSaved) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    painter_->save();
    stroke(5);
    stroke(-5);
    EXPECT_TRUE(settle().state.unsaved);
    painter_->send(UndoEvent{});
    EXPECT_TRUE(settle().state.unsaved) << "one is left";
    painter_->send(UndoEvent{});
    EXPECT_FALSE(settle().state.unsaved) << "as it was saved";
    painter_->send(UndoEvent{});
    EXPECT_TRUE(settle().state.unsaved) << "a stroke of the file is missing";
    painter_->send(RedoEvent{});
    EXPECT_FALSE(settle().state.unsaved);
    painter_.reset();
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("a.exr", "a.strokes.jsonl"))
        << "nothing to be recovered";
    // The record is still what makes the painting.
    Session again(read_canvas(file_).dry_shared(), artist_acrylics());
    replay(again, read_journal(folder_ / "a.strokes.jsonl"));
    EXPECT_EQ(again.canvas().volumes_mm3(), read_canvas(file_).volumes_mm3());
}

TEST_F(PainterTest, DryingThatIsUndoneIsSavedToo) {
    write_painting(file_, *flat_surface(200, 150));
    open();
    stroke();
    painter_->save();
    painter_->send(DryEvent{"first", 1});
    EXPECT_TRUE(settle().state.unsaved);
    painter_->send(UndoEvent{});
    EXPECT_FALSE(settle().state.unsaved);
}

}  // namespace
}  // namespace tangi
