// painter_recovery_test.cpp: strokes that a crash left come back as they were painted, and on their
// own painting.
#include <gmock/gmock.h>

#include "tests/support/viewer/recording_support.h"

namespace tangi {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// A crash left strokes; then another painting came to lie in the place of theirs, newer than they are, with
// a record of its own.
TEST_F(Recording, StrokesOfAnotherPaintingAreNotTakenForItsOwn) {
    open();
    stroke();
    painter_->save();
    stroke(5);
    settle();
    const std::string theirs = bytes_of(files_.unsaved), record = bytes_of(files_.record);
    painter_.reset();
    write_painting(file_, *flat_surface(180, 120));
    open();
    auto journal = left_over(files_);
    ASSERT_TRUE(journal);
    EXPECT_FALSE(is_of(*journal, painter_->saved_hash()));
    stroke(8);
    EXPECT_THAT(settle().messages, ElementsAre(HasSubstr("of another painting")));
    EXPECT_EQ(bytes_of(folder_ / "a.other.jsonl"), theirs);
    painter_->save();
    settle();
    EXPECT_EQ(strokes_in(read_journal(files_.record)), 1);
    EXPECT_EQ(bytes_of(folder_ / "a.other-strokes.jsonl"), record);
    expect_record_makes(file_);
}

Palette box_of(const Rgb& sky) {
    return {"mine", "", {pigment_of_rgb("Sky", sky, 0.05f), pigment_of_rgb("White", Rgb(0.9f), 0.05f)}};
}

// A palette's file may be edited between a crash and the next sitting, and between two sittings: strokes stay
// of the paints that they were painted with.
TEST_F(Recording, StrokesKeepThePaintsThatTheyWerePaintedWith) {
    const auto paint = [&](double y_mm) {
        StrokeEvent event;
        event.brush = even_brush();
        event.paint = {{"Sky", 1}};
        painter_->send(event);
        go_on(y_mm, 0, 10);
        painter_->send(EndEvent{});
    };
    const Palette blue = box_of({0.02f, 0.05f, 0.9f}), red = box_of({0.9f, 0.05f, 0.02f});
    open(false, blue);
    paint(-10);
    painter_->save();
    paint(0);
    settle();
    painter_.reset();
    open(false, red);
    auto journal = left_over(files_);
    ASSERT_TRUE(journal);
    painter_->recover(std::move(*journal));
    EXPECT_THAT(settle().messages, Contains("recovered 1 stroke"));
    EXPECT_EQ(paints_on_it(), 1u) << "as blue as the one before";
    paint(10);
    settle();
    EXPECT_EQ(paints_on_it(), 2u) << "and what is painted now is of the new box";
    painter_->save();
    settle();
    expect_record_makes(file_);
    painter_.reset();
    open();
    stroke(20);
    painter_->save();
    settle();
    expect_record_makes(file_);
}

TEST_F(Recording, WhatIsUndoneIsNotCountedAsRecovered) {
    open();
    stroke(-5);
    stroke(5);
    painter_->send(UndoEvent{});
    settle();
    painter_.reset();
    auto journal = left_over(files_);
    ASSERT_TRUE(journal);
    EXPECT_EQ(strokes_left(journal->entries), 1);
    open();
    painter_->recover(std::move(*journal));
    EXPECT_THAT(settle().messages, Contains("recovered 1 stroke"));
}

TEST_F(Recording, ADamagedJournalIsRecoveredAndIsNotTheRecord) {
    open();
    for (const double y : {-10.0, 0.0, 10.0}) stroke(y);
    settle();
    painter_.reset();
    std::string text = bytes_of(files_.unsaved);
    const std::size_t second = text.find("{\"brush\"", text.find("{\"brush\"") + 1);
    const std::size_t point = text.find('\n', text.find('\n', second) + 1);
    text.replace(point + 20, 10, "{\"event\"");  // in its second point
    write_bytes(files_.unsaved, text);
    auto journal = left_over(files_);
    ASSERT_TRUE(journal);
    open();
    painter_->recover(std::move(*journal));
    EXPECT_THAT(settle().messages, Contains(testing::AllOf(HasSubstr("recovered 3 strokes"),
                                                           HasSubstr("damaged lines could not be"))));
    EXPECT_EQ(bytes_of(folder_ / "a.unread.jsonl"), text) << "kept as it was";
    stroke(5);
    painter_->save();
    settle();
    EXPECT_EQ(strokes_in(read_journal(files_.record)), 4);
    expect_record_makes(file_);
}

TEST_F(Recording, AJournalThatCannotBeReadIsNeverTheRecord) {
    for (const std::string text :
         {"something\nelse\n",
          "{\"format\": \"tangipaint strokes\", \"version\": 2}\n{\"event\": \"end\"}\n"}) {
        fs::remove(files_.record);
        fs::remove(folder_ / "a.unread.jsonl");
        write_bytes(files_.unsaved, text);
        EXPECT_THAT(error_of([&] { left_over(files_); }), HasSubstr("a.unsaved.jsonl"));
        write_painting(file_, *flat_surface(200, 150));
        fs::last_write_time(files_.unsaved, fs::last_write_time(file_) + std::chrono::seconds(1));
        open();
        stroke();
        settle();
        EXPECT_EQ(bytes_of(folder_ / "a.unread.jsonl"), text);
        painter_->save();
        settle();
        EXPECT_EQ(strokes_in(read_journal(files_.record)), 1);
        expect_record_makes(file_);
    }
}

// What was saved before cannot be undone after a crash: the record says what is on the canvas.
TEST_F(Recording, AnUndoThatCannotBeRepeatedIsNotRecorded) {
    open();
    stroke();
    painter_->save();
    painter_->send(UndoEvent{});
    stroke(5);
    settle();
    fs::copy(files_.unsaved, folder_ / "kept");  // as a kill leaves it
    painter_.reset();
    fs::rename(folder_ / "kept", files_.unsaved);
    auto journal = left_over(files_);
    ASSERT_TRUE(journal);
    open();
    painter_->recover(std::move(*journal));
    EXPECT_THAT(settle().messages, Contains(HasSubstr("not repeated: line 2: there is nothing to undo")));
    painter_->save();
    settle();
    EXPECT_EQ(bytes_of(files_.record).find("undo"), std::string::npos);
    expect_record_makes(file_);
}

}  // namespace
}  // namespace tangi
