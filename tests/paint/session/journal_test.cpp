// journal_test.cpp: journals come back as they were written, whatever happens to the file's end.
#include "paint/session/journal.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "paint/session/journal_file_text.h"
#include "tests/support/paint/journal_text.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<Event> some_events() {
    StrokeEvent stroke;
    stroke.brush = brush_presets().at("filbert");
    stroke.brush.size_mm = 0.1 + 0.2;  // not a short decimal
    stroke.paint = {{"Bone Black", 1}, {"Titanium White", 2.5}};
    stroke.load = 0.7;
    stroke.start = BrushStart::dirty;
    stroke.options.stabiliser_mm = 2;
    stroke.seed = 8000000000000001;
    StrokePoint point;
    point.time_s = 1.0 / 3;
    point.x_mm = -1e-7;
    point.y_mm = 12.345678901234567;
    point.pressure = 0.1;
    point.tilt_y = -0.2;
    point.rotation_deg = 77;
    StrokeEvent mixing = stroke;
    mixing.on = Place::palette;
    mixing.start = BrushStart::same;
    mixing.finish = {.specular = 0.1, .roughness = 1.0 / 3, .medium = 0.25};
    PileEvent pile;
    pile.paint = {{"Bone Black", 0.1}};
    pile.at = {-1.0 / 3, 7};
    pile.finish.roughness = 0.2;
    PileEvent squeezed = pile;
    squeezed.on = Place::painting;
    squeezed.height_mm = 0.1;
    PaletteEvent palette;
    palette.width_mm = 120;
    palette.height_mm = 1e2 / 3;
    palette.paints = {"Bone Black", "Titanium White"};
    PaletteEvent all;
    all.all_paints = true;
    return {stroke,
            PointEvent{point},
            EndEvent{},
            UndoEvent{},
            RedoEvent{},
            DryEvent{"a \"b\"", 0.5},
            DryEvent{"c", 1, CirclePart{{1.0 / 3, -2}, 12}},
            DryEvent{"c", 1, PolygonPart{{{0, 0}, {1, 0.1}, {0, 1e-9}}}},
            LiftEvent{"é"},
            mixing,
            EndEvent{},
            pile,
            squeezed,
            palette,
            all,
            PaletteEvent{},
            WashEvent{},
            PaintsEvent{},
            paints_event({"mine", "", {pigment_of_rgb("Sky", Rgb(0.02f, 0.05f, 0.9f), 0.05f)}})};
}

TEST(Journal, ComesBackBitForBit) {
    const TestDir dir;
    {
        JournalWriter writer(dir / "a.jsonl");
        for (const Event& event : some_events()) writer.append(event);
        writer.sync();
    }
    const Journal journal = read_journal(dir / "a.jsonl");
    ASSERT_EQ(journal.entries.size(), some_events().size());
    for (const JournalWarning& warning : journal.warnings)
        EXPECT_THAT(warning.text, HasSubstr("stroke")) << "they are in no sensible order";
    for (std::size_t i = 0; i < journal.entries.size(); ++i) {
        EXPECT_EQ(journal.entries[i].line, static_cast<int>(i) + 2);
        EXPECT_EQ(to_json(journal.entries[i].event), to_json(some_events()[i]));
    }
    const auto& point = std::get<PointEvent>(journal.entries[1].event).point;
    EXPECT_EQ(point.y_mm, 12.345678901234567);
    EXPECT_EQ(std::get<StrokeEvent>(journal.entries[0].event).seed, 8000000000000001u);
}

TEST(Journal, GoesOnWithAFileAndMendsATornLine) {
    const TestDir dir;
    write_bytes(dir / "a.jsonl", kJournalHeader + "{\"event\": \"undo\"}\n{\"event\": \"re");
    const Journal torn = read_journal(dir / "a.jsonl");
    EXPECT_EQ(torn.entries.size(), 1u);
    ASSERT_EQ(torn.warnings.size(), 1u);
    EXPECT_EQ(torn.warnings[0].line, 3);
    EXPECT_THAT(torn.warnings[0].text, HasSubstr("cut short"));
    {
        JournalWriter writer(dir / "a.jsonl");
        writer.append(RedoEvent{});
    }
    const Journal mended = read_journal(dir / "a.jsonl");
    EXPECT_EQ(mended.entries.size(), 2u);
    EXPECT_TRUE(mended.warnings.empty());
}

// An event counts with or without its line end, for who reads the file and for who goes on with it.
TEST(Journal, AWholeLastLineCountsWithoutItsEnd) {
    const TestDir dir;
    for (const std::string& text :
         {kJournalHeader + "{\"event\": \"undo\"}", kJournalHeader.substr(0, kJournalHeader.size() - 1)}) {
        write_bytes(dir / "a.jsonl", text);
        const Journal before = read_journal(dir / "a.jsonl");
        EXPECT_EQ(before.entries.size(), text.size() > kJournalHeader.size() ? 1u : 0u);
        EXPECT_TRUE(before.warnings.empty());
        JournalWriter(dir / "a.jsonl").append(RedoEvent{});
        EXPECT_EQ(bytes_of(dir / "a.jsonl"), text + "\n{\"event\":\"redo\"}\n");
    }
}

// Else they would have the same streaks.
TEST(Journal, StrokesWithoutASeedHaveTheirNumber) {
    const TestDir dir;
    const std::string stroke = "{\"event\": \"stroke\"}\n", end = "{\"event\": \"end\"}\n",
                      seeded = "{\"event\": \"stroke\", \"seed\": 0}\n";
    write_bytes(dir / "a.jsonl", kJournalHeader + stroke + end + seeded + end + "{\"event\": \"undo\"}\n" +
                                     stroke + end + stroke + end);
    std::vector<std::uint64_t> seeds;
    for (const Journal::Entry& entry : read_journal(dir / "a.jsonl").entries)
        if (const auto* event = std::get_if<StrokeEvent>(&entry.event)) seeds.push_back(event->seed);
    EXPECT_THAT(seeds, ElementsAre(0, 0, 2, 3));
}

TEST(Journal, SurvivesItsWritersDeath) {
    const TestDir dir;
    const auto path = dir / "a.jsonl";
    for (int round = 0; round < 10; ++round) {
        int pipe_ends[2];
        ASSERT_EQ(::pipe(pipe_ends), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            JournalWriter writer(path);
            writer.append(StrokeEvent{});
            for (int i = 0;; ++i) {
                writer.append(PointEvent{{i * 1.0, 1, 2, 0.5, 0, 0, 0}});
                if (i == 20 * round && ::write(pipe_ends[1], "x", 1) != 1) ::_exit(1);
            }
        }
        char ready;
        ASSERT_EQ(::read(pipe_ends[0], &ready, 1), 1);
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        ::close(pipe_ends[0]);
        ::close(pipe_ends[1]);
        const Journal journal = read_journal(path);
        EXPECT_GT(journal.entries.size(), static_cast<std::size_t>(20 * round)) << round;
        // A line that is cut short, and that the stroke has no end: it is given one when the next one begins.
        EXPECT_LE(journal.warnings.size(), 2u);
        const auto count = [&](auto is) { return std::ranges::count_if(journal.entries, is); };
        EXPECT_EQ(count([](const auto& e) { return std::holds_alternative<EndEvent>(e.event); }), round);
        EXPECT_EQ(count([](const auto& e) { return std::holds_alternative<StrokeEvent>(e.event); }),
                  round + 1);
    }
}

// A disk that is full for a moment: what could not be written leaves nothing behind, and can be written
// later.
TEST(Journal, AWriteThatBreaksOffLeavesNoPartOfALine) {
    const TestDir dir;
    const auto path = dir / "a.jsonl";
    const Event point = PointEvent{{1.0 / 3, 1, 2, 0.5, 0, 0, 0}};
    const std::string line = to_json(point).dump() + "\n";
    JournalWriter writer(path);
    writer.append(StrokeEvent{});
    const auto before = bytes_of(path);
    {
        const FullDisk disk(before.size() + line.size() + line.size() / 2);
        writer.append(point);
        for (int time = 0; time < 3; ++time) {
            EXPECT_THAT(error_of([&] { writer.append(point); }), HasSubstr("a.jsonl: cannot be written"));
            EXPECT_EQ(bytes_of(path), before + line);
        }
    }
    writer.append(point);
    writer.append(EndEvent{});
    EXPECT_EQ(bytes_of(path), before + line + line + "{\"event\":\"end\"}\n");
    EXPECT_TRUE(read_journal(path).warnings.empty());
}

TEST(Journal, RefusesAtWritingWhatWouldNotReplay) {
    const TestDir dir;
    PileEvent pile;
    pile.paint = {{"Bone Black", 1}};
    const std::vector<Event> between = {UndoEvent{}, RedoEvent{},    DryEvent{"a", 1}, LiftEvent{"a"},
                                        pile,        PaletteEvent{}, StrokeEvent{}};
    JournalWriter writer(dir / "a.jsonl");
    EXPECT_THROW(writer.append(PointEvent{}), ContractError);
    EXPECT_THROW(writer.append(EndEvent{}), ContractError);
    writer.append(StrokeEvent{});
    for (const Event& event : between) EXPECT_THROW(writer.append(event), ContractError) << name_of(event);
    writer.append(PointEvent{});
    writer.append(EndEvent{});
    for (const Event& event : between) writer.append(event);
    EXPECT_EQ(read_journal(dir / "a.jsonl").entries.size(), 3 + between.size());
}

TEST(Journal, WhatCouldNotBeReadAgainIsRefusedBefore) {
    for (const Event& event : some_events()) require_readable(event);
    PointEvent pressed, nowhere;
    pressed.point.pressure = 1.5;
    nowhere.point.x_mm = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(error_of([&] { require_readable(PileEvent{}); }), HasSubstr("a pile needs 'paint'"));
    EXPECT_THAT(error_of([&] { require_readable(pressed); }), HasSubstr("'p'"));
    EXPECT_THAT(error_of([&] { require_readable(nowhere); }), HasSubstr("'x'"));
    EXPECT_THAT(error_of([&] { require_readable(DryEvent{std::string(300, 'x'), 1}); }), HasSubstr("layer"));
}

TEST(Journal, MayHaveTheLineEndsOfAnySystem) {
    const TestDir dir;
    const std::string text = kJournalHeader + "\n{\"event\": \"undo\"}\n{\"event\": \"redo\"}\n";
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string other;
        for (const char c : text) other += c == '\n' ? end : std::string(1, c);
        write_bytes(dir / "a.jsonl", other);
        const Journal journal = read_journal(dir / "a.jsonl");
        ASSERT_EQ(journal.entries.size(), 2u) << end.size();
        EXPECT_EQ(journal.entries[0].line, 3);
        EXPECT_EQ(journal.entries[1].line, 4);
        EXPECT_TRUE(journal.warnings.empty());
    }
    EXPECT_THAT(error_of([&] { JournalWriter(dir / "a.jsonl"); }), HasSubstr("CR alone"));
    EXPECT_EQ(read_journal(dir / "a.jsonl").entries.size(), 2u) << "nothing was cut off";
}

}  // namespace
}  // namespace tangi
