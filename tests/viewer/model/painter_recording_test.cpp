// painter_recording_test.cpp: journals of a painter whose disk fails, whose keys come in mid-stroke,
// and whose painting is replaced: no stroke is lost, and every journal replays to what was saved.
#include <gmock/gmock.h>

#include "tests/programs/support/small_disk.h"
#include "tests/support/viewer/recording_support.h"

namespace tangi {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST_F(Recording, ADiskThatIsFullForAMomentLosesNoStroke) {
    open();
    stroke(-10);
    stroke(-6);
    EXPECT_THAT(settle().messages, testing::IsEmpty());
    {
        const FullDisk disk(fs::file_size(files_.unsaved) + 700);
        stroke(-2);
        stroke(2);
        EXPECT_THAT(settle().messages,
                    ElementsAre(testing::AllOf(HasSubstr("a.unsaved.jsonl: cannot be written"),
                                               HasSubstr("strokes are not recorded"))))
            << "once, not for each point";
        const auto journal = left_over(files_);  // were the program killed now
        ASSERT_TRUE(journal);
        EXPECT_EQ(strokes_in(*journal), 3);
        EXPECT_EQ(journal->lines_lost, 0);
        EXPECT_TRUE(bytes_of(files_.unsaved).ends_with('\n')) << "no part of a line";
    }
    for (const double y : {6.0, 10.0, 14.0}) stroke(y);
    EXPECT_THAT(settle().messages, ElementsAre(HasSubstr("recorded again")));
    painter_.reset();  // without saving
    auto journal = left_over(files_);
    ASSERT_TRUE(journal);
    EXPECT_EQ(strokes_in(*journal), 7);
    open();
    painter_->recover(std::move(*journal));
    EXPECT_THAT(settle().messages, ElementsAre("recovered 7 strokes"));
    painter_->save();
    settle();
    EXPECT_EQ(strokes_in(read_journal(files_.record)), 7);
    expect_record_makes(file_);
}

// Once a second, though no further stroke comes.
TEST_F(Recording, WhatWaitsIsWrittenWhenThereIsRoom) {
    open();
    stroke();
    settle();
    const auto before = fs::file_size(files_.unsaved);
    {
        const FullDisk disk(before);
        stroke(5);
        settle();
        EXPECT_EQ(fs::file_size(files_.unsaved), before);
    }
    for (int tries = 0; tries < 100 && fs::file_size(files_.unsaved) == before; ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(strokes_in(read_journal(files_.unsaved)), 2);
}

TEST_F(Recording, SavedWhileStrokesWaitTheRecordHasThemToo) {
    open();
    stroke();
    settle();
    {
        const FullDisk disk(fs::file_size(files_.unsaved) + 100);
        stroke(5);
        settle();
    }
    painter_->save();
    settle();
    EXPECT_EQ(strokes_in(read_journal(files_.record)), 2);
    expect_record_makes(file_);
    EXPECT_FALSE(fs::exists(files_.unsaved));
}

TEST_F(Recording, WhereTheRecordCannotBeWrittenNothingIsSaved) {
    open();
    stroke();
    settle();
    const std::string before = bytes_of(file_), journal = bytes_of(files_.unsaved);
    fs::create_directory(files_.record);
    painter_->save();
    PainterNews news = settle();
    EXPECT_THAT(news.messages, ElementsAre(HasSubstr("a.strokes.jsonl: is a folder")));
    EXPECT_TRUE(news.state.unsaved);
    EXPECT_TRUE(bytes_of(file_) == before);
    EXPECT_EQ(bytes_of(files_.unsaved), journal);
    fs::remove(files_.record);
    painter_->save();
    settle();
    expect_record_makes(file_);
    EXPECT_FALSE(fs::exists(files_.unsaved));
}

// The journal of strokes was removed by a hand that tidied up: the record has them all the same.
TEST_F(Recording, AJournalThatWasRemovedMeanwhileIsInTheRecord) {
    open();
    stroke();
    settle();
    fs::remove(files_.unsaved);
    stroke(5);
    EXPECT_THAT(settle().messages, ElementsAre(HasSubstr("was removed by another program")));
    painter_->save();
    settle();
    EXPECT_EQ(strokes_in(read_journal(files_.record)), 2);
    expect_record_makes(file_);
}

TEST_F(Recording, ThatMemoryRanOutIsToldInWords) {
    open();
    painter_->keep_by([](Canvas&, const Painter::ToKeep&) -> Painter::Kept { throw std::bad_alloc(); });
    painter_->save();
    EXPECT_THAT(settle().messages, ElementsAre("not enough memory"));
}

// Whatever comes while the brush is down: the stroke ends first, the rest of it is none, and all is recorded
// as it was painted.
TEST_F(Recording, WhatComesInMidStrokeEndsTheStroke) {
    PileEvent pile;
    pile.paint = {{"Bone Black", 1}};
    PaletteEvent piles;
    piles.paints = {"Bone Black"};
    const std::vector<std::pair<std::string, std::function<void()>>> all = {
        {"undo", [&] { painter_->send(UndoEvent{}); }},
        {"redo", [&] { painter_->send(RedoEvent{}); }},
        {"dry",
         [&] {
             painter_->send(DryEvent{"layer", 1});
         }},
        {"lift", [&] { painter_->send(LiftEvent{"first"}); }},
        {"lift of none", [&] { painter_->send(LiftEvent{"none"}); }},
        {"pile", [&] { painter_->send(pile); }},
        {"squeeze", [&] { painter_->squeeze(pile); }},
        {"palette", [&] { painter_->send(piles); }},
        {"stroke", [&] { begin_stroke(8, 3); }},
        {"save", [&] { painter_->save(); }},
        {"look", [&] { painter_->look([](const Surface&, const Canvas&) {}).get(); }},
        {"show", [&] { painter_->show_as({}); }},
        {"confine", [&] { painter_->confine({}, {}); }},
        {"change", [&] { painter_->change([](Canvas&) {}).get(); }},
        {"probe", [&] { painter_->probe(3, 3); }}};
    for (const auto& [name, comes] : all) {
        for (const char* file : {"a.exr", "a.unsaved.jsonl", "a.strokes.jsonl"}) fs::remove(folder_ / file);
        write_painting(file_, *flat_surface(200, 150));
        open();
        stroke(-10);
        painter_->send(DryEvent{"first", 1});
        begin_stroke();
        comes();
        go_on(0, 10, 8);
        painter_->send(EndEvent{});
        stroke(10);
        const PainterNews news = settle();
        EXPECT_THAT(news.messages, Not(Contains(HasSubstr("stroke")))) << name;
        EXPECT_FALSE(news.state.stroking) << name;
        painter_->save();
        settle();
        SCOPED_TRACE(name);
        expect_record_makes(file_);
    }
}

TEST_F(Recording, APaintingThatWasReplacedIsNotOverwritten) {
    const std::vector<std::pair<std::string, std::function<void()>>> ways = {
        {"mv",
         [&] {
             write_painting(folder_ / "other.exr", *flat_surface(100, 80));
             fs::rename(folder_ / "other.exr", file_);
         }},
        {"cp",
         [&] {
             write_painting(folder_ / "other.exr", *flat_surface(100, 80));
             write_bytes(file_, bytes_of(folder_ / "other.exr"));
         }},
        {"another program's paint on the same ground", [&] {
             Session other(read_canvas(file_), artist_acrylics());
             PileEvent pile;
             pile.on = Place::painting;
             pile.paint = {{"Bone Black", 1}};
             other.apply(pile);
             write_canvas(file_, other.canvas());
         }}};
    for (const auto& [name, replace] : ways) {
        SCOPED_TRACE(name);
        for (const char* file : {"a.exr", "b.exr", "a.unsaved.jsonl", "a.strokes.jsonl"})
            fs::remove(folder_ / file);
        write_painting(file_, *flat_surface(200, 150));
        open();
        stroke();
        painter_->save();
        EXPECT_EQ(settle().state.saves, 1) << "by ourselves: that is no replacing";
        stroke(5);
        settle();
        replace();
        const std::string theirs = bytes_of(file_);
        painter_->save();
        PainterNews news = settle();
        EXPECT_THAT(news.messages,
                    ElementsAre(HasSubstr("a.exr: was replaced or changed by another program")));
        EXPECT_TRUE(news.needs_name);
        EXPECT_TRUE(news.state.unsaved);
        EXPECT_TRUE(bytes_of(file_) == theirs);
        EXPECT_THROW(painter_->change([](Canvas&) {}).get(), Error);
        painter_->save_as(folder_ / "b.exr");
        news = settle();
        EXPECT_FALSE(news.state.unsaved);
        EXPECT_TRUE(bytes_of(file_) == theirs);
        expect_record_makes(folder_ / "b.exr");
    }
}

TEST_F(Recording, ReplacedByItselfItIsStillTheSame) {
    open();
    stroke();
    const auto time = fs::last_write_time(file_);
    fs::copy(file_, folder_ / "copy");
    fs::rename(folder_ / "copy", file_);  // another inode
    fs::last_write_time(file_, time);
    painter_->save();
    EXPECT_EQ(settle().state.saves, 1);
    fs::remove(file_);
    stroke(5);
    painter_->save();
    EXPECT_EQ(settle().state.saves, 2) << "nothing is overwritten where there is nothing";
    // Who chooses its name as a new one means to overwrite what is there.
    write_painting(file_, *flat_surface(100, 80));
    painter_->save_as(file_);
    EXPECT_EQ(settle().state.saves, 3);
    expect_record_makes(file_);
}

// A stick that is write-protected, a share without the right to write.
TEST_F(Recording, SavedAsOutOfAReadOnlyPlaceItHasItsNameAndRecord) {
    const SmallDisk disk(8);
    if (!disk.is_there()) GTEST_SKIP() << "no disk can be mounted here";
    const fs::path there = disk / "c.exr", here = folder_ / "d.exr";
    write_painting(there, *flat_surface(200, 150));
    disk.make_read_only();
    file_ = there;
    open();
    stroke();
    stroke(5);
    EXPECT_THAT(settle().messages, ElementsAre(HasSubstr("strokes are not recorded")));
    painter_->save();
    EXPECT_THAT(settle().messages, ElementsAre(HasSubstr("c.exr: cannot be written")));
    painter_->save_as(here);
    PainterNews news = settle();
    EXPECT_THAT(news.messages, ElementsAre("saved d.exr", HasSubstr("recorded again")));
    EXPECT_FALSE(news.state.unsaved);
    EXPECT_EQ(painter_->file(), here);
    EXPECT_EQ(strokes_in(read_journal(folder_ / "d.strokes.jsonl")), 2);
    expect_record_makes(here);
    stroke(8);
    EXPECT_THAT(settle().messages, testing::IsEmpty());
    EXPECT_TRUE(fs::exists(folder_ / "d.unsaved.jsonl"));
    painter_->save();
    settle();
    expect_record_makes(here);
}

}  // namespace
}  // namespace tangi
