// journal_recovery_test.cpp: what can be read of a damaged journal is read, and events keep their order.
#include "paint/session/journal.h"

#include <gmock/gmock.h>

#include "paint/session/event_order.h"
#include "paint/session/session.h"
#include "tests/support/paint/journal_text.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

std::string stroke_of(int points) {
    std::string text = "{\"event\": \"stroke\"}\n";
    for (int i = 0; i < points; ++i)
        text += fmt::format("{{\"event\": \"point\", \"x\": {}, \"y\": 1}}\n", i);
    return text + "{\"event\": \"end\"}\n";
}

std::string in_short(const Journal& journal) {
    std::string names;
    for (const auto& entry : journal.entries) names += name_of(entry.event)[0];
    return names;
}

TEST(RecoveredJournal, OneBadLineCondemnsNoOther) {
    const TestDir dir;
    const std::string bad = "{\"event\": \"po{\"event\": \"end\"}\n", undo = "{\"event\": \"undo\"}\n",
                      redo = "{\"event\": \"redo\"}\n", stroke = stroke_of(2);
    const auto recovered = [&](const std::string& events) {
        write_bytes(dir / "a.jsonl", kJournalHeader + events);
        return recovered_journal(dir / "a.jsonl");
    };
    Journal journal = recovered(stroke + bad + stroke);
    EXPECT_EQ(in_short(journal), "sppesppe");
    EXPECT_EQ(journal.lines_lost, 1);
    ASSERT_EQ(journal.warnings.size(), 1u);
    EXPECT_EQ(journal.warnings[0].line, 6);
    EXPECT_THAT(journal.warnings[0].text, HasSubstr("cannot be read"));
    EXPECT_THAT(error_of([&] { read_journal(dir / "a.jsonl"); }), HasSubstr("a.jsonl:6: is not JSON"));

    // In a stroke: it ends there, and its other points are left out.
    journal = recovered(stroke.substr(0, stroke.rfind("{\"event\": \"point")) + bad +
                        stroke.substr(stroke.find('\n') + 1) + stroke);
    EXPECT_EQ(in_short(journal), "spesppe");
    EXPECT_EQ(journal.lines_lost, 3);
    // The line that begins a stroke: nothing is painted of it.
    journal = recovered(stroke + "\xff\xfe\n" + stroke.substr(stroke.find('\n') + 1) + stroke);
    EXPECT_EQ(in_short(journal), "sppesppe");
    // Undo and redo of what came after the line are meant; those of what came before may be of the lost one.
    journal = recovered(stroke + bad + undo + stroke + undo + redo + undo + undo + redo + redo);
    EXPECT_EQ(in_short(journal), "sppesppeurur");
    EXPECT_EQ(journal.lines_lost, 4);
    // What is JSON and no event is lost likewise.
    EXPECT_EQ(in_short(recovered("[]\n{\"event\": \"jump\"}\n" + stroke + "{\"event\": \"en")), "sppe");
    require_in_order(journal);
}

TEST(RecoveredJournal, NeedsNoFirstLine) {
    const TestDir dir;
    const auto recovered = [&](const std::string& text) {
        write_bytes(dir / "a.jsonl", text);
        return recovered_journal(dir / "a.jsonl");
    };
    EXPECT_EQ(in_short(recovered("{\"form\n" + stroke_of(1))), "spe");
    for (const std::string& nothing_yet : {std::string(), kJournalHeader, kJournalHeader.substr(0, 20)}) {
        EXPECT_TRUE(recovered(nothing_yet).entries.empty());
        EXPECT_EQ(recovered(nothing_yet).lines_lost, 0);
        JournalWriter(dir / "a.jsonl").append(UndoEvent{});  // goes on with it
        EXPECT_EQ(read_journal(dir / "a.jsonl").entries.size(), 1u);
    }
    EXPECT_THAT(error_of([&] { recovered("something\nelse\n"); }), HasSubstr("nothing in it"));
    EXPECT_THAT(
        error_of([&] { recovered("{\"format\": \"tangipaint strokes\", \"version\": 2}\n" + stroke_of(1)); }),
        HasSubstr("version 2"))
        << "it is another program's";
}

TEST(EventOrder, IsThatOfTheSession) {
    Session session(flat_canvas(20, 20), artist_acrylics());
    EventOrder order;
    Random random(3);
    const std::vector<Event> all = {StrokeEvent{}, PointEvent{}, PointEvent{},   EndEvent{},
                                    UndoEvent{},   PileEvent{},  PaletteEvent{}, RedoEvent{}};
    for (int i = 0; i < 400; ++i) {
        const Event& event = all[static_cast<std::size_t>(random.below(static_cast<int>(all.size())))];
        const bool point = std::holds_alternative<PointEvent>(event);
        bool refused = false;
        try {
            session.apply(event);
        } catch (const Error&) {  // of undo and redo: there may be nothing
            refused = point;
        }
        EXPECT_EQ(refused, point && order.fit(event) == EventOrder::Fit::nowhere) << i;
        order.take(event);
        EXPECT_EQ(session.in_stroke(), order.in_stroke()) << i << ", " << name_of(event);
    }
}

}  // namespace
}  // namespace tangi
