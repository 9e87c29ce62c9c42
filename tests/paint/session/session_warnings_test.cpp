// session_warnings_test.cpp: what had no effect is told, and why.
#include "paint/session/session.h"

#include <gmock/gmock.h>

#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(SessionWarnings, SaysWhatIsNotUsedOfPaintThatIsNotLoaded) {
    Session session(flat_surface(128, 96), artist_acrylics());
    const auto warning_of = [&](StrokeEvent stroke) {
        draw_line(session, stroke, 0);
        std::string all;
        for (std::string text; !(text = session.take_warning()).empty();) all += text;
        return all;
    };
    StrokeEvent loaded = tool_stroke("flat", "Titanium White", 1);
    loaded.finish.specular = 0.3;
    loaded.load = 0.5;
    EXPECT_EQ(warning_of(loaded), "");
    StrokeEvent same = tool_stroke("flat", "", 2);
    same.start = BrushStart::same;
    EXPECT_EQ(warning_of(same), "");
    same.finish.medium = 0.3;
    EXPECT_THAT(warning_of(same), AllOf(HasSubstr("'medium' is not used"), HasSubstr("\"same\"")));
    StrokeEvent bare = tool_stroke("smudge", "", 3);
    bare.finish.specular = 0.2;
    bare.finish.roughness = 0.2;
    EXPECT_THAT(warning_of(bare),
                AllOf(HasSubstr("'specular', 'roughness' are not used"), HasSubstr("'paint' is missing")));
}

TEST(SessionWarnings, SaysThatPaintsOfManyFinishesAreManyPaints) {
    Session session(flat_surface(128, 96), artist_acrylics());
    int told = 0;
    for (int i = 0; i < 60; ++i) {
        StrokeEvent stroke = tool_stroke("flat", "Titanium White", 1);
        stroke.finish.specular = 0.001 * (i + 1);
        session.apply(stroke);
        session.apply(point(0, i * 0.1 - 3, 0));
        session.apply(EndEvent{});
        if (const std::string text = session.take_warning(); !text.empty()) {
            EXPECT_THAT(text, HasSubstr("50 paints"));
            ++told;
        }
    }
    EXPECT_EQ(told, 1);
}

TEST(SessionWarnings, SaysWhatHasNoEffectAndWhichNameALayerGot) {
    const TestDir dir;
    write_bytes(dir / "a.jsonl", R"({"format": "tangipaint strokes", "version": 1}
{"event": "dry", "layer": "ground"}
{"event": "stroke", "start": "same", "paint": {"Bone Black": 1}}
{"event": "point", "x": 0, "y": 0}
{"event": "stroke", "paint": {"Bone Black": 1}}
{"event": "point", "x": 0, "y": 0}
{"event": "dry", "layer": "retouch"}
{"event": "stroke", "paint": {"Bone Black": 1}}
{"event": "point", "x": 0, "y": 0, "p": 0}
{"event": "point", "x": 3, "y": 0, "p": 0}
{"event": "stroke", "paint": {"Titanium White": 1}}
{"event": "point", "x": 0, "y": 0}
{"event": "dry", "layer": "retouch"}
{"event": "lift", "layer": "retouch"}
{"event": "stroke", "brush": {"preset": "smudge"}, "paint": {"Bone Black": 1}}
)");
    Session session(flat_surface(128, 96), artist_acrylics());
    const std::string file = (dir / "a.jsonl").string();
    Journal journal = read_journal(dir / "a.jsonl");
    journal.warnings.clear();  // of strokes without 'end'
    EXPECT_THAT(
        replay(session, journal),
        testing::ElementsAre(
            AllOf(HasSubstr(file + ":2: "), HasSubstr("no wet paint"), HasSubstr("'ground'")),
            AllOf(HasSubstr(file + ":3: "), HasSubstr("'start' is \"same\"")),
            AllOf(HasSubstr(file + ":3: "), HasSubstr("'paint' is not used")),
            AllOf(HasSubstr(file + ":3: "), HasSubstr("changes nothing: no paint is on the brush")),
            AllOf(HasSubstr(file + ":8: "), HasSubstr("not pressed")),
            AllOf(HasSubstr(file + ":13: "), HasSubstr("'retouch'"), HasSubstr("'retouch 2'")),
            AllOf(HasSubstr(file + ":15: "), HasSubstr("'paint' is not used"), HasSubstr("load_mm"))));
    ASSERT_EQ(session.canvas().dried().size(), 1u);
    EXPECT_EQ(session.canvas().dried()[0].name, "retouch 2");
    EXPECT_TRUE(session.take_warning().empty());
}

TEST(SessionWarnings, SaysOfStrokesThatChangeNothingWhy) {
    const auto warning = [](StrokeEvent stroke, double x, bool on_paint = false) {
        Session session(flat_surface(128, 96), artist_acrylics());
        PileEvent pile;
        pile.on = Place::painting;
        pile.paint = {{"Bone Black", 1}};
        if (on_paint) session.apply(pile);
        session.apply(stroke);
        session.apply(point(0, x, 0));
        session.apply(point(0.1, x + 5, 0));
        session.apply(EndEvent{});
        const std::string first = session.take_warning();
        EXPECT_TRUE(session.take_warning().empty()) << "once";
        return first;
    };
    const StrokeEvent bare = tool_stroke("round", "", 1), painting = tool_stroke("round", "Bone Black", 1);
    EXPECT_THAT(warning(bare, 0), HasSubstr("no paint is on the brush ('paint' is missing or empty)"));
    EXPECT_THAT(warning(tool_stroke("smudge", "", 1), 0), HasSubstr("no wet paint lies under it"));
    EXPECT_EQ(warning(tool_stroke("smudge", "", 1), 0, true), "");
    EXPECT_EQ(warning(bare, 0, true), "");
    EXPECT_EQ(warning(painting, 0), "");
    const Session session(flat_surface(128, 96), artist_acrylics());
    const double edge = 64 * session.canvas().mm_per_pixel();
    EXPECT_THAT(warning(painting, edge + 40), AllOf(HasSubstr("wholly outside of the painting"),
                                                    HasSubstr(fmt::format("({:.4g}, ", edge))));
    EXPECT_EQ(warning(painting, edge - 4), "") << "a part of it lies inside";
    StrokeEvent unpressed = painting;
    unpressed.on = Place::palette;
    EXPECT_THAT(warning(unpressed, 500), HasSubstr("outside of the palette"));
}

TEST(SessionWarnings, SaysThatWhatIsDryStays) {
    Session session(flat_surface(128, 96), artist_acrylics());
    const auto warning = [&](const StrokeEvent& stroke) {
        session.apply(stroke);
        session.apply(point(0, 0, 0));
        session.apply(point(0.1, 5, 0));
        session.apply(EndEvent{});
        return session.take_warning();
    };
    EXPECT_EQ(warning(tool_stroke("rag", "", 1)), "the stroke changes nothing: no wet paint lies under it");
    EXPECT_EQ(warning(tool_stroke("round", "Bone Black", 1)), "");
    session.apply(DryEvent{"ground", 1});
    for (const std::string preset : {"rag", "smudge", "scrape", "eraser"})
        EXPECT_EQ(warning(tool_stroke(preset, "", 1)),
                  "the stroke changes nothing: no wet paint lies under it; what is dry stays as it is");
    StrokeEvent elsewhere = tool_stroke("rag", "", 1);
    elsewhere.on = Place::palette;
    EXPECT_THAT(warning(elsewhere), testing::EndsWith("no wet paint lies under it"));
}

TEST(SessionWarnings, SaysThatAStrokeLiesBesideTheMask) {
    Session session(flat_surface(128, 96), artist_acrylics());
    auto mask = std::make_shared<Image<float>>(128, 96);
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 20; ++x) (*mask)(x, y) = 1;
    session.canvas().confine(mask);
    const auto warning = [&](double x) {
        session.apply(tool_stroke("round", "Bone Black", 1));
        session.apply(point(0, x, 0));
        session.apply(point(0.1, x + 2, 0));
        session.apply(EndEvent{});
        return session.take_warning();
    };
    const double pixel = session.canvas().mm_per_pixel();
    EXPECT_THAT(warning(30 * pixel), HasSubstr("outside of the mask that brushes stop at"));
    EXPECT_EQ(warning((10 - 64) * pixel), "");
}

TEST(SessionWarnings, SaysWhyABrushHasNoPaint) {
    const auto warnings = [](StrokeEvent stroke) {
        Session session(flat_surface(128, 96), artist_acrylics());
        session.apply(stroke);
        session.apply(point(0, 0, 0));
        session.apply(point(0.1, 5, 0));
        session.apply(EndEvent{});
        std::string all;
        for (std::string text; !(text = session.take_warning()).empty();) all += text + "\n";
        return all;
    };
    StrokeEvent dry = tool_stroke("round", "Bone Black", 1);
    dry.load = 0;
    EXPECT_THAT(warnings(dry), AllOf(HasSubstr("'paint' is not used: 'load' is 0"),
                                     HasSubstr("no paint is on the brush ('load' is 0)"),
                                     testing::Not(HasSubstr("missing"))));
    dry.load = 1;
    dry.brush.load_mm = 0;
    EXPECT_THAT(warnings(dry), HasSubstr("no paint is on the brush (the brush's load_mm is 0)"));
    dry.start = BrushStart::same;
    EXPECT_THAT(warnings(dry), AllOf(HasSubstr("no paint is on the brush ('start' is \"same\", and nothing"),
                                     testing::Not(HasSubstr("load"))));
    EXPECT_THAT(warnings(tool_stroke("round", "", 1)), HasSubstr("('paint' is missing or empty)"));
}

TEST(SessionWarnings, SaysThingsInTheOrderOfTheLines) {
    const TestDir dir;
    write_bytes(dir / "a.jsonl", R"({"format": "tangipaint strokes", "version": 1}
{"event": "dry", "layer": "ground"}
{"event": "stroke"}
{"event": "end"}
{"event": "dry", "layer": "ground"}
{"event": "end"}
{"event": "dry", "layer": "ground"}
)");
    Session session(flat_surface(32, 32), artist_acrylics());
    const std::string file = (dir / "a.jsonl").string();
    EXPECT_THAT(replay(session, read_journal(dir / "a.jsonl")),
                testing::ElementsAre(AllOf(HasSubstr(file + ":2: "), HasSubstr("no wet paint")),
                                     AllOf(HasSubstr(file + ":3: "), HasSubstr("no points")),
                                     AllOf(HasSubstr(file + ":5: "), HasSubstr("no wet paint")),
                                     AllOf(HasSubstr(file + ":6: "), HasSubstr("without a stroke")),
                                     AllOf(HasSubstr(file + ":7: "), HasSubstr("no wet paint"))));
}

TEST(SessionWarnings, PilesOutsideOfThePaletteAreNotLaid) {
    Session session(flat_surface(128, 96), artist_acrylics());
    PaletteEvent palette;
    palette.width_mm = 60;
    palette.height_mm = 40;
    session.apply(palette);
    PileEvent pile;
    pile.paint = {{"Bone Black", 1}};
    pile.size_mm = 12;
    const auto laid_mm3 = [&](PointMm at) {
        const auto volume = [&] {
            const auto all = session.board()->volumes_mm3();
            return all.empty() ? 0 : all[0];
        };
        const double before = volume();
        pile.at = at;
        session.apply(pile);
        return volume() - before;
    };
    const double whole = laid_mm3({-10, 0});
    EXPECT_GT(whole, 50);
    EXPECT_EQ(session.take_warning(), "");
    EXPECT_NEAR(laid_mm3({30, 0}) / whole, 0.5, 0.05);
    EXPECT_THAT(session.take_warning(),
                AllOf(HasSubstr("(30, 0) mm lies in part outside of the palette"), HasSubstr("(30, 20) mm")));
    EXPECT_GT(laid_mm3({33, 0}), 0) << "though its middle is beyond";
    EXPECT_THAT(session.take_warning(), HasSubstr("in part"));
    for (const PointMm at : {PointMm{900, 0}, PointMm{0, -26}, PointMm{35, 25}}) {
        EXPECT_EQ(laid_mm3(at), 0);
        EXPECT_THAT(session.take_warning(), HasSubstr("wholly outside of the palette"));
    }
    pile.paint = {{"Vantablack", 1}};
    EXPECT_THAT(error_of([&] { session.apply(pile); }), HasSubstr("Vantablack"));
}

TEST(SessionWarnings, SaysThatPilesDoNotFitOnThePalette) {
    const auto warning = [](double width_mm, std::size_t paints) {
        Session session(flat_surface(128, 96), artist_acrylics());
        PaletteEvent event;
        event.width_mm = event.height_mm = width_mm;
        for (std::size_t i = 0; i < paints; ++i) event.paints.push_back(artist_acrylics().paints[i].name);
        session.apply(event);
        return session.take_warning();
    };
    EXPECT_EQ(warning(200, 19), "");
    EXPECT_EQ(warning(25, 3), "");
    EXPECT_THAT(warning(25, 19),
                AllOf(HasSubstr("25 x 25 mm"), HasSubstr("19 paints"), HasSubstr("'width_mm'")));
}

}  // namespace
}  // namespace tangi
