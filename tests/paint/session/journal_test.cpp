// journal_test.cpp: journals come back as they were written, whatever happens to the file's end.
#include "paint/session/journal.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "paint/session/journal_file_text.h"
#include "paint/session/session.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHeader = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n";

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
    write_bytes(dir / "a.jsonl", kHeader + "{\"event\": \"undo\"}\n{\"event\": \"re");
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
         {kHeader + "{\"event\": \"undo\"}", kHeader.substr(0, kHeader.size() - 1)}) {
        write_bytes(dir / "a.jsonl", text);
        const Journal before = read_journal(dir / "a.jsonl");
        EXPECT_EQ(before.entries.size(), text.size() > kHeader.size() ? 1u : 0u);
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
    write_bytes(dir / "a.jsonl", kHeader + stroke + end + seeded + end + "{\"event\": \"undo\"}\n" + stroke +
                                     end + stroke + end);
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
        write_bytes(dir / "a.jsonl", kHeader + events);
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
    for (const std::string& nothing_yet : {std::string(), kHeader, kHeader.substr(0, 20)}) {
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

TEST(Journal, ErrorsNameFileAndLine) {
    const TestDir dir;
    const auto error = [&](const std::string& text) {
        write_bytes(dir / "bad.jsonl", text);
        return error_of([&] { read_journal(dir / "bad.jsonl"); });
    };
    EXPECT_THAT(error(""), AllOf(HasSubstr("bad.jsonl"), HasSubstr("empty")));
    EXPECT_THAT(error("\n"), AllOf(HasSubstr("bad.jsonl"), HasSubstr("empty")));
    EXPECT_THAT(error("\nhello"), HasSubstr("not a journal"));
    EXPECT_THAT(error("hello\n"), AllOf(HasSubstr("bad.jsonl:1"), HasSubstr("not a journal")));
    EXPECT_THAT(error("{\"format\": \"tangipaint strokes\", \"version\": 2}\n"), HasSubstr("version 2"));
    EXPECT_THAT(error(kHeader + "\n{\"event\": }\n"), AllOf(HasSubstr("bad.jsonl:3"), HasSubstr("not JSON")));
    EXPECT_THAT(error(kHeader + "[]\n"), AllOf(HasSubstr("bad.jsonl:2"), HasSubstr("object")));
    EXPECT_THAT(error(kHeader + "{\"event\": \"jump\"}\n"),
                AllOf(HasSubstr("\"jump\""), HasSubstr("stroke")));
    EXPECT_THAT(error(kHeader + "{\"event\": \"point\", \"x\": 1}\n"),
                AllOf(HasSubstr(":2"), HasSubstr("'y'")));
    EXPECT_THAT(error(kHeader + "{\"event\": \"point\", \"x\": 1, \"y\": 1, \"p\": 2}\n"),
                HasSubstr("'p' = 2"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"point\", \"x\": 1, \"y\": \"a\"}\n"),
                HasSubstr("not a number"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"end\", \"now\": 1}\n"), HasSubstr("'now'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"paint\": {\"a\": 0}}\n"), HasSubstr("parts of a"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"point\", \"t\": 0, \"x\": 0, \"y\": 0, \"p\": NaN}\n"),
                AllOf(HasSubstr(":2: is not JSON"), HasSubstr("column 49: JSON has no NaN")));
    EXPECT_THAT(error(kHeader + "{\"event\": \"dry\", \"layer\": \"\xff\"}\n"),
                HasSubstr(":2: is not JSON: column 28: the byte 0xff is no UTF-8"));
    EXPECT_THAT(error(kHeader + std::string(3, '\0') + "\n"),
                HasSubstr(":2: is not JSON: column 1: a byte 0x00"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"po\n"), HasSubstr("is not JSON: it ends before"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"paint\": {\"a\": 1e7}}\n"),
                HasSubstr("above 0, 1000000 at most"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"start\": \"wet\"}\n"), HasSubstr("'start'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"brush\": {\"sise\": 1}}\n"), HasSubstr("'sise'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"dry\"}\n"), HasSubstr(":2: has no 'layer'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"dry\", \"layer\": \"\"}\n"), HasSubstr("that is not empty"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"dry\", \"layer\": \"" + std::string(201, 'x') + "\"}\n"),
                HasSubstr("'layer' is a name of 201 bytes; 200 at most"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"dry\", \"layer\": \"a\\nb\"}\n"), HasSubstr("one line"));
    const auto dry = [&](const std::string& part) {
        return error(kHeader + "{\"event\": \"dry\", \"layer\": \"a\", " + part + "}\n");
    };
    EXPECT_THAT(dry("\"circle\": {\"x\": 1, \"y\": 2}"), AllOf(HasSubstr(":2"), HasSubstr("'radius_mm'")));
    EXPECT_THAT(dry("\"circle\": {\"x\": 1, \"y\": 2, \"radius_mm\": 3, \"z\": 1}"), HasSubstr("'z'"));
    EXPECT_THAT(dry("\"polygon\": [[0, 0], [1, 1]]"), HasSubstr("3 to 10000"));
    EXPECT_THAT(dry("\"polygon\": [[0, 0], [1, 1], [2]]"), HasSubstr("[2]"));
    EXPECT_THAT(dry("\"circle\": {}, \"polygon\": []"), HasSubstr("both"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"on\": \"wall\"}\n"),
                HasSubstr("'on' is \"wall\""));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"roughness\": 3}\n"), HasSubstr("'roughness' = 3"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"pile\", \"x\": 1, \"y\": 1}\n"), HasSubstr("'paint'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"palette\", \"width_mm\": 10}\n"), HasSubstr("'height_mm'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"palette\", \"paints\": [1]}\n"), HasSubstr("'paints'"));
    EXPECT_THAT(error_of([&] { read_journal(dir / "none.jsonl"); }), HasSubstr("none.jsonl"));
    write_bytes(dir / "bad.jsonl", "something else\n");
    EXPECT_THAT(error_of([&] { JournalWriter(dir / "bad.jsonl"); }), HasSubstr("not a journal"));
    EXPECT_EQ(bytes_of(dir / "bad.jsonl"), "something else\n");
}

TEST(Journal, SaysWhichEventsAreNotWhereTheyBelong) {
    const TestDir dir;
    const std::string stroke = "{\"event\": \"stroke\"}\n",
                      point = "{\"event\": \"point\", \"x\": 1, \"y\": 1}\n", end = "{\"event\": \"end\"}\n",
                      undo = "{\"event\": \"undo\"}\n", dry = "{\"event\": \"dry\", \"layer\": \"a\"}\n";
    const auto warnings = [&](const std::string& events) {
        write_bytes(dir / "a.jsonl", kHeader + events);
        std::vector<std::string> texts;
        for (const JournalWarning& warning : read_journal(dir / "a.jsonl").warnings)
            texts.push_back(fmt::format("{}: {}", warning.line, warning.text));
        return texts;
    };
    EXPECT_THAT(warnings(stroke + point + end + undo + stroke + point + point + end + dry),
                testing::IsEmpty());
    EXPECT_THAT(warnings(end), ElementsAre("2: an 'end' without a stroke: it ends nothing"));
    EXPECT_THAT(warnings(stroke + end), ElementsAre("2: the stroke has no points: it paints nothing"));
    EXPECT_THAT(warnings(stroke + point + stroke + point),
                ElementsAre("2: the stroke has no 'end' before that of line 4 begins; it ends there",
                            "4: the stroke has no 'end'; it ends with the journal"));
    EXPECT_THAT(warnings(stroke + point + undo + end),
                ElementsAre("4: 'undo' comes before the 'end' of the stroke of line 2, which it ends",
                            "5: an 'end' without a stroke: it ends nothing"));
    EXPECT_THAT(warnings(stroke + dry),
                ElementsAre("2: the stroke has no points: it paints nothing",
                            "3: 'dry' comes before the 'end' of the stroke of line 2, which it ends"));
}

TEST(Journal, MayHaveTheLineEndsOfAnySystem) {
    const TestDir dir;
    const std::string text = kHeader + "\n{\"event\": \"undo\"}\n{\"event\": \"redo\"}\n";
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

TEST(Journal, ErrorsAreShortAndSayWhatIsMissing) {
    const TestDir dir;
    const auto error = [&](const std::string& text) {
        write_bytes(dir / "bad.jsonl", text);
        return error_of([&] { read_journal(dir / "bad.jsonl"); });
    };
    const std::string long_text(2000000, 'x');
    for (const std::string& event :
         {"\"" + long_text + "\"", "{\"event\": \"" + long_text + "\"}",
          "{\"event\": \"end\", \"" + long_text + "\": 1}",
          "{\"event\": \"stroke\", \"start\": \"" + long_text + "\"}",
          "{\"event\": \"stroke\", \"brush\": {\"" + long_text + "\": 1}}",
          "{\"event\": \"stroke\", \"brush\": {\"preset\": \"" + long_text + "\"}}",
          "{\"event\": \"stroke\", \"paint\": {\"" + long_text + "\": 0}}"}) {
        const std::string words = error(kHeader + event + "\n");
        EXPECT_LT(words.size(), 500u) << event.substr(0, 60);
        EXPECT_THAT(words, HasSubstr("bad.jsonl:2"));
    }
    EXPECT_THAT(error(kHeader + "{\"x\": 1}\n"), HasSubstr("bad.jsonl:2: has no 'event'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"seed\": 1.5}\n"),
                HasSubstr("'seed' is 1.5, not a whole"));
    EXPECT_THAT(error("{\"format\": \"tangipaint strokes\"}\n"), HasSubstr("has no 'version'"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"point\", \"x\": 1, \"y\": 2, \"x\": 3}\n"),
                HasSubstr("bad.jsonl:2: has the field 'x' twice"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"brush\": {\"size_mm\": -0.3}}\n"),
                HasSubstr("'size_mm' is -0.3, outside [0.01, 1000] mm"));
    EXPECT_THAT(error(kHeader + "{\"event\": \"stroke\", \"brush\": {\"grain\": 3}}\n"),
                testing::EndsWith("'grain' is 3, outside [0, 1]"));
}

}  // namespace
}  // namespace tangi
