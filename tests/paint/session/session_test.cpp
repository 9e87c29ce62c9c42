// session_test.cpp: events become paint; journals replay to the same bits.
#include "paint/session/session.h"

#include <gmock/gmock.h>

#include "surface/base/parallel.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<Event> a_little_picture() {
    std::vector<Event> events;
    const auto line = [&](StrokeEvent stroke, double y, double slope) {
        events.push_back(std::move(stroke));
        for (int i = 0; i <= 10; ++i) events.push_back(point(i * 0.02, 2.0 * i - 10, y + slope * i));
        events.push_back(EndEvent{});
    };
    line(tool_stroke("flat", "Titanium White", 1), 5, 0);
    line(tool_stroke("round", "Ultramarine Blue", 2), -5, 1);
    events.push_back(UndoEvent{});
    events.push_back(RedoEvent{});
    events.push_back(DryEvent{"under", 0.5});
    line(tool_stroke("filbert", "Pyrrole Red", 3), 0, 0.2);
    StrokeEvent dirty = tool_stroke("filbert", "Titanium White", 4);
    dirty.start = BrushStart::dirty;
    line(dirty, 3, -0.5);
    line(tool_stroke("smudge", "", 5), 0, 0);
    return events;
}

TEST(Session, AJournalReplaysToTheSameBitsOnAnyNumberOfThreads) {
    const TestDir dir;
    Session live(flat_surface(128, 96), artist_acrylics());
    {
        JournalWriter writer(dir / "a.jsonl");
        for (const Event& event : a_little_picture()) {
            live.apply(event);
            writer.append(event);
        }
        live.finish();
    }
    EXPECT_EQ(live.totals().strokes, 5);
    for (const int threads : {1, 3}) {
        set_thread_count(threads);
        Session again(flat_surface(128, 96), artist_acrylics());
        replay(again, read_journal(dir / "a.jsonl"));
        EXPECT_TRUE(identical(live.canvas().wet(), again.canvas().wet())) << threads;
        ASSERT_EQ(again.canvas().dried().size(), 1u);
        EXPECT_TRUE(identical(live.canvas().dried()[0].paint, again.canvas().dried()[0].paint));
    }
    set_thread_count(0);
}

TEST(Session, BrushesStopAtTheMask) {
    // The same strokes on a canvas that is painted already, with and without a mask: beside the mask, nothing
    // changes, not even by paint that is pushed or flows, and nothing is lost.
    const auto width = 128, height = 96;
    auto mask = std::make_shared<Image<float>>(width, height);
    for (int y = 30; y < 60; ++y)
        for (int x = 50; x < 80; ++x) (*mask)(x, y) = 1;
    Session session(flat_surface(width, height), artist_acrylics());
    for (const Event& event : a_little_picture()) session.apply(event);
    session.finish();
    const PaintLayer before = session.canvas().wet();
    const double volume_before = session.canvas().volumes_mm3()[0];
    session.canvas().confine(mask);
    StrokeEvent wide = tool_stroke("flat", "Bone Black", 9);
    wide.brush.size_mm = 12;
    for (StrokeEvent stroke : {wide, tool_stroke("smudge", "", 10), tool_stroke("knife", "Bone Black", 11)}) {
        session.apply(stroke);
        for (int i = 0; i <= 10; ++i) session.apply(point(i * 0.02, 3.0 * i - 15, 1.0 * i - 5));
        session.apply(EndEvent{});
    }
    const PaintLayer& after = session.canvas().wet();
    int changed = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool same = before.thickness_mm(x, y) == after.thickness_mm(x, y);
            ASSERT_TRUE(same || (*mask)(x, y) > 0) << x << " " << y;
            changed += same ? 0 : 1;
        }
    EXPECT_GT(changed, 500);
    EXPECT_GT(volume_before, 0);
    EXPECT_THROW(session.canvas().confine(std::make_shared<Image<float>>(3, 3)), ContractError);
    EXPECT_THAT([&] { session.canvas().confine(std::make_shared<Image<float>>(width, height, 2.0f)); },
                testing::ThrowsMessage<Error>(HasSubstr("a mask holds 2")));
}

TEST(Session, UndoneStrokesLeaveNothing) {
    Session session(flat_surface(128, 96), artist_acrylics());
    session.apply(tool_stroke("round", "Bone Black", 1));
    session.apply(point(0, -5, 0));
    session.apply(point(0.1, 5, 0));
    session.apply(UndoEvent{});  // ends the stroke first
    EXPECT_TRUE(session.canvas().wet().empty());
    session.apply(RedoEvent{});
    EXPECT_FALSE(session.canvas().wet().empty());
}

TEST(Session, ADirtyBrushCarriesTheLastPaint) {
    const auto black_on_canvas = [](BrushStart start) {
        Session session(flat_surface(128, 96), artist_acrylics());
        session.apply(tool_stroke("round", "Bone Black", 1));
        session.apply(point(0, -12, 8));
        session.apply(point(0.1, 12, 8));
        session.apply(EndEvent{});
        const double before = session.canvas().volumes_mm3()[0];
        StrokeEvent white = tool_stroke("round", "Titanium White", 2);
        white.start = start;
        session.apply(white);
        session.apply(point(0, -12, -8));
        session.apply(point(0.1, 12, -8));
        session.finish();
        return session.canvas().volumes_mm3()[0] - before;
    };
    EXPECT_NEAR(black_on_canvas(BrushStart::clean), 0, 1e-6);
    EXPECT_GT(black_on_canvas(BrushStart::dirty), 0.01);
}

TEST(Session, ABrushWithoutALoadGoesOnWithThePaintOfTheOneBefore) {
    for (const std::string next : {"smudge", "rag", "scrape", "eraser", "height eraser", "fan"})
        for (const double size_mm : {6.0, 1.0}) {
            Session session(flat_surface(128, 96), artist_acrylics());
            const auto line = [&](const StrokeEvent& stroke, double y) {
                draw_line(session, stroke, y);
                return on_both(session.canvas(), *session.brush())[0];
            };
            const double before = line(tool_stroke("flat", "Titanium White", 1), 4);
            StrokeEvent same = tool_stroke(next, "", 2);
            same.brush.size_mm = size_mm;
            same.start = BrushStart::same;
            EXPECT_NEAR(line(same, -4) / before, 1, 1e-5) << next << " of " << size_mm << " mm";
        }
}

// The brush in the hand has nothing to do with it, so no stroke lays again what was erased.
TEST(Session, WhatIsErasedIsGone) {
    for (const std::string tool : {"eraser", "height eraser"})
        for (const BrushStart start : {BrushStart::same, BrushStart::dirty, BrushStart::clean}) {
            Session session(flat_surface(128, 96), artist_acrylics());
            draw_line(session, tool_stroke("flat", "Titanium White", 1), 4);
            const BrushLoad held = session.brush()->bristles();
            const double laid = session.canvas().volumes_mm3()[0];
            StrokeEvent erase = tool_stroke(tool, "", 2);
            erase.start = start;
            draw_line(session, erase, 4);
            EXPECT_LT(session.canvas().volumes_mm3()[0], 0.6 * laid) << tool;
            EXPECT_EQ(session.brush()->bristles().mm, held.mm) << tool;
            EXPECT_EQ(session.brush()->settings().shape, BrushShape::flat);
            EXPECT_EQ(session.take_warning(), "");
            const double left = on_both(session.canvas(), *session.brush())[0];
            StrokeEvent next = tool_stroke("flat", "", 3);
            next.start = BrushStart::same;
            draw_line(session, next, -4);
            EXPECT_NEAR(on_both(session.canvas(), *session.brush())[0] / left, 1, 1e-5) << tool;
        }
}

// Each pigment is on the painting or on the brush, whatever is undone: with the stroke goes what it took up.
TEST(Session, UndoGivesBackWhatWasOnTheBrush) {
    for (const std::size_t budget : {std::size_t(1) << 30, std::size_t(0)}) {  // in memory, and on disk
        Session session(flat_surface(160, 120), artist_acrylics(), budget);
        PileEvent pile;
        pile.on = Place::painting;
        pile.size_mm = 20;
        std::vector<std::vector<double>> sums;
        std::vector<std::vector<std::vector<float>>> loads;
        const auto note = [&] {
            sums.push_back(on_both(session.canvas(), *session.brush()));
            loads.push_back(session.brush()->bristles().mm);
        };
        for (const std::string paint : {"Titanium White", "Pyrrole Red"}) {
            pile.paint = {{paint, 1}};
            pile.at.x = paint == "Pyrrole Red" ? 6 : -6;
            session.apply(pile);
        }
        const std::string tools[] = {"flat", "flat", "smudge", "eraser", "rag", "round", "flat"};
        StrokeEvent first = tool_stroke("flat", "", 1);  // bare, on the palette, which has nothing to give
        session.apply(first);
        session.apply(point(0, 18, 14));
        session.apply(EndEvent{});
        note();
        for (int i = 0; i < 7; ++i) {
            StrokeEvent stroke = tool_stroke(tools[i], "", static_cast<std::uint64_t>(i));
            stroke.start = BrushStart::same;
            session.apply(stroke);
            session.apply(point(0, -12, i - 3));
            session.apply(point(0.1, 12, 3 - i));
            session.apply(EndEvent{});
            note();
        }
        ASSERT_GT(session.brush()->volumes_mm3(2)[0], 1);
        for (std::size_t i = loads.size() - 1; i-- > 0;) {
            session.apply(UndoEvent{});
            EXPECT_EQ(session.brush()->bristles().mm, loads[i]) << i;
            const std::vector<double> now = on_both(session.canvas(), *session.brush());
            for (std::size_t k = 0; k < now.size(); ++k) EXPECT_EQ(now[k], sums[i][k]) << i;
        }
        for (std::size_t i = 1; i < loads.size(); ++i) {
            session.apply(RedoEvent{});
            EXPECT_EQ(session.brush()->bristles().mm, loads[i]) << i;
            EXPECT_EQ(on_both(session.canvas(), *session.brush()), sums[i]) << i;
        }
        EXPECT_EQ(session.history().bytes_on_disk() > 0, budget == 0);
        // Before the first stroke there was no brush.
        for (std::size_t i = 0; i < loads.size(); ++i) session.apply(UndoEvent{});
        EXPECT_EQ(session.brush(), nullptr);
    }
}

TEST(Session, IsWatchedWhileBrushesAreOnThePainting) {
    Session session(flat_surface(128, 96), artist_acrylics());
    std::vector<double> seen;
    session.watch(1, [&](double at_s) {
        seen.push_back(at_s);
        return at_s + 1;
    });
    for (const Place place : {Place::painting, Place::palette, Place::painting}) {
        StrokeEvent stroke = tool_stroke("round", "Bone Black", 1);
        stroke.on = place;
        session.apply(stroke);
        session.apply(point(0, -5, 0));
        session.apply(point(2.25, 5, 0));
    }
    session.finish();
    EXPECT_EQ(seen, (std::vector<double>{1, 2, 3, 4}));  // of 4.5 s
}

TEST(Session, MistakesNameTheLine) {
    const TestDir dir;
    const auto error = [&](const std::string& events) {
        write_bytes(dir / "a.jsonl", "{\"format\": \"tangipaint strokes\", \"version\": 1}\n" + events);
        Session session(flat_surface(32, 32), artist_acrylics());
        return error_of([&] { replay(session, read_journal(dir / "a.jsonl")); });
    };
    EXPECT_THAT(error("{\"event\": \"point\", \"x\": 1, \"y\": 1}\n"),
                AllOf(HasSubstr("a.jsonl:2"), HasSubstr("stroke")));
    const std::string begun = "{\"event\": \"stroke\"}\n{\"event\": \"point\", \"x\": 1, \"y\": 1}\n",
                      further = "{\"event\": \"point\", \"x\": 2, \"y\": 1}\n";
    for (const std::string event : {"undo", "dry"})
        EXPECT_THAT(error(begun + "{\"event\": \"" + event +
                          (event == "dry" ? "\", \"layer\": \"a\"}\n" : "\"}\n") + further),
                    AllOf(HasSubstr("a.jsonl:5"), HasSubstr("'" + event + "' before it has ended"),
                          HasSubstr("after the stroke's 'end'")));
    EXPECT_THAT(error(begun + "{\"event\": \"end\"}\n" + further),
                AllOf(HasSubstr("a.jsonl:5"), HasSubstr("outside of a stroke")));
    EXPECT_THAT(error("{\"event\": \"undo\"}\n"),
                AllOf(HasSubstr("a.jsonl:2"), HasSubstr("nothing to undo")));
    EXPECT_THAT(error("{\"event\": \"redo\"}\n"), HasSubstr("nothing to redo"));
    EXPECT_THAT(error("{\"event\": \"lift\", \"layer\": \"x\"}\n"), HasSubstr("'x'"));
    EXPECT_THAT(error("\n{\"event\": \"stroke\", \"paint\": {\"Vantablack\": 1}}\n"),
                AllOf(HasSubstr("a.jsonl:3"), HasSubstr("Vantablack"), HasSubstr("Bone Black")));
}

TEST(Session, ReplayCanBeStopped) {
    Session session(flat_surface(32, 32), artist_acrylics());
    Journal journal;
    journal.entries = {{2, tool_stroke("round", "Bone Black", 1)}, {3, point(0, 0, 0)}};
    EXPECT_THROW(replay(session, journal, [](std::string_view, double) { return false; }), Cancelled);
}

}  // namespace
}  // namespace tangi
