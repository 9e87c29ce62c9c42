// mixing_board_test.cpp: a palette that paints are mixed on, and brushes that carry them to the
// painting.
#include "paint/session/mixing_board.h"

#include <gmock/gmock.h>

#include "surface/base/parallel.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

PileEvent pile_of(PaintParts paint, PointMm at) {
    PileEvent pile;
    pile.paint = std::move(paint);
    pile.at = at;
    pile.size_mm = 12;
    pile.height_mm = 1;
    return pile;
}

StrokeEvent stroke_on(Place place, BrushStart start) {
    StrokeEvent event;
    event.brush = brush_presets().at("round");
    event.brush.size_mm = 5;
    event.on = place;
    event.start = start;
    event.seed = 3;
    return event;
}

void line(std::vector<Event>& events, const StrokeEvent& stroke, PointMm from, PointMm to) {
    events.push_back(stroke);
    for (int i = 0; i <= 8; ++i)
        events.push_back(point(i * 0.02, from.x + (to.x - from.x) * i / 8, from.y + (to.y - from.y) * i / 8));
    events.push_back(EndEvent{});
}

// Two piles, mixed with a clean brush, and what is on it painted.
std::vector<Event> mixing() {
    PaletteEvent palette;
    palette.width_mm = 60;
    palette.height_mm = 40;
    std::vector<Event> events = {palette, pile_of({{"Diarylide Yellow", 1}}, {-14, 0}),
                                 pile_of({{"Ultramarine Blue", 1}}, {14, 0})};
    line(events, stroke_on(Place::palette, BrushStart::clean), {-14, 0}, {14, 0});
    line(events, stroke_on(Place::palette, BrushStart::same), {14, -2}, {-6, -2});
    line(events, stroke_on(Place::painting, BrushStart::same), {-8, 3}, {8, 3});
    return events;
}

std::shared_ptr<Surface> ground() { return flat_surface(128, 96); }

// [mm^3] Of each paint by name, on painting, palette and brush.
std::map<std::string, double> volumes(const Session& session) {
    std::map<std::string, double> sums;
    const auto add = [&](const Canvas& canvas, const std::vector<double>& mm3) {
        for (std::size_t i = 0; i < mm3.size(); ++i) sums[canvas.ingredients()[i].name] += mm3[i];
    };
    add(session.canvas(), session.canvas().volumes_mm3());
    if (session.board()) add(*session.board(), session.board()->volumes_mm3());
    if (session.brush()) {
        const Canvas& of = session.brush_place() == Place::palette ? *session.board() : session.canvas();
        add(of, session.brush()->volumes_mm3(of.ingredients().size()));
    }
    return sums;
}

TEST(MixingBoard, MixingKeepsEachPaintsVolumeOnPaletteBrushAndPainting) {
    Session session(ground(), artist_acrylics());
    const std::vector<Event> events = mixing();
    for (int i = 0; i < 3; ++i) session.apply(events[static_cast<std::size_t>(i)]);
    const auto before = volumes(session);
    for (std::size_t i = 3; i < events.size(); ++i) session.apply(events[i]);
    const auto after = volumes(session);
    ASSERT_EQ(before.size(), 2u);
    for (const auto& [name, mm3] : before) EXPECT_NEAR(after.at(name) / mm3, 1, 1e-5) << name;
    // Both paints came to the painting, and no palette paint that was not carried there.
    const auto painted = session.canvas().volumes_mm3();
    ASSERT_EQ(painted.size(), 2u);
    for (const double mm3 : painted) EXPECT_GT(mm3, 0.01);
}

TEST(MixingBoard, TheBrushCarriesWhatIsOnEachBristle) {
    Session session(ground(), artist_acrylics());
    session.apply(pile_of({{"Bone Black", 1}}, {0, 0}));
    // The piles' edge: some bristles dip into it, others do not.
    session.apply(stroke_on(Place::palette, BrushStart::clean));
    session.apply(point(0, 0, 6.5));
    session.finish();
    const std::size_t on_board = session.board()->ingredients().size();
    const double carried = session.brush()->volumes_mm3(on_board)[0];
    EXPECT_GT(carried, 0);
    const Brush& brush = *session.brush();
    std::vector<float> before(
        const_cast<Brush&>(brush).load_total(),
        const_cast<Brush&>(brush).load_total() +
            static_cast<std::size_t>(brush.grid_size()) * static_cast<std::size_t>(brush.grid_size()));
    session.apply(stroke_on(Place::painting, BrushStart::same));  // no point yet: nothing is given
    ASSERT_EQ(&brush, session.brush());
    EXPECT_EQ(
        0, std::memcmp(before.data(), const_cast<Brush&>(brush).load_total(), before.size() * sizeof(float)));
    const auto sides = [&] {
        double above = 0, below = 0;
        const int n = brush.grid_size();
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                (y < n / 2 ? above : below) += before[static_cast<std::size_t>(y * n + x)];
        return std::pair(above, below);
    }();
    EXPECT_GT(sides.second, 2 * sides.first);  // the side that was in the pile
}

// Dipped into two piles that lie side by side, different bristles hold different paint.
TEST(MixingBoard, ABrushOfTwoPilesPaintsStreaksOfBoth) {
    Session session(ground(), artist_acrylics());
    session.apply(pile_of({{"Diarylide Yellow", 1}}, {-6, 0}));
    session.apply(pile_of({{"Ultramarine Blue", 1}}, {6, 0}));
    StrokeEvent dip = stroke_on(Place::palette, BrushStart::clean);
    dip.brush = brush_presets().at("flat");
    for (int i = 0; i < 3; ++i) {
        session.apply(dip);
        session.apply(point(0, 0, 0));
        dip.start = BrushStart::same;
    }
    dip.on = Place::painting;
    session.apply(dip);
    for (int i = 0; i <= 8; ++i) session.apply(point(0.02 * i, 0, 9 - 2.25 * i));
    session.finish();

    const PaintLayer& wet = session.canvas().wet();
    const auto& paints = session.canvas().ingredients();
    ASSERT_EQ(paints.size(), 2u);
    const IngredientId yellow = paints[0].name == "Diarylide Yellow" ? 0 : 1, blue = 1 - yellow;
    const auto parts = [&](int x0, int x1, int y) {  // of both, in a piece of a row
        std::pair<double, double> sums;
        for (int x = x0; x < x1; ++x) {
            sums.first += wet.thickness_mm(x, y, yellow);
            sums.second += wet.thickness_mm(x, y, blue);
        }
        return sums;
    };
    const bool turned = parts(46, 58, 48).first < parts(46, 58, 48).second;
    for (const int y : {30, 40, 48, 56}) {  // rows, from the stroke's beginning to its end
        auto left = parts(46, 58, y), right = parts(70, 82, y);
        if (turned) std::swap(left, right);
        EXPECT_GT(left.first, 4 * left.second) << y;
        EXPECT_GT(right.second, 4 * right.first) << y;
        EXPECT_GT(left.first, 0.01) << y;
        EXPECT_GT(right.second, 0.01) << y;
    }
}

TEST(MixingBoard, APilesRatioStaysWhateverIsTakenFromIt) {
    Session session(ground(), artist_acrylics());
    session.apply(pile_of({{"Titanium White", 3}, {"Bone Black", 1}}, {0, 0}));
    double left = 0;
    for (int i = 0; i < 40; ++i) {
        std::vector<Event> events;
        line(events, stroke_on(Place::palette, BrushStart::clean), {-8, 0}, {8, 0});  // washed each time
        for (const Event& event : events) session.apply(event);
        const auto mm3 = session.board()->volumes_mm3();
        ASSERT_EQ(mm3.size(), 2u);
        ASSERT_NEAR(mm3[1] / mm3[0], 3, 1e-4) << i;  // black comes first by name
        left = mm3[0] + mm3[1];
    }
    const double at_first = std::numbers::pi / 8 * 12 * 12 * 1;  // half the cylinder
    EXPECT_LT(left, 0.9 * at_first);
    EXPECT_GT(left, 0);
    const auto& wet = session.board()->wet();
    for (const TileIndex at : wet.painted())
        for (const float mm : wet.tile(at)->thickness_mm) ASSERT_GE(mm, -1e-7f);
}

TEST(MixingBoard, ReplaysToTheSameBits) {
    const TestDir dir;
    Session live(ground(), artist_acrylics());
    {
        JournalWriter writer(dir / "a.jsonl");
        for (const Event& event : mixing()) {
            live.apply(event);
            writer.append(event);
        }
    }
    for (const int threads : {1, 3}) {
        set_thread_count(threads);
        Session again(ground(), artist_acrylics());
        replay(again, read_journal(dir / "a.jsonl"));
        EXPECT_TRUE(identical(live.canvas().wet(), again.canvas().wet())) << threads;
        EXPECT_TRUE(identical(live.board()->wet(), again.board()->wet())) << threads;
    }
    set_thread_count(0);
}

TEST(MixingBoard, UndoTakesWhatWasDoneLastOnEitherCanvas) {
    Session session(ground(), artist_acrylics());
    const std::vector<Event> events = mixing();
    for (const Event& event : events) session.apply(event);
    const PaintLayer mixed = session.board()->wet(), painted = session.canvas().wet();
    session.apply(UndoEvent{});
    EXPECT_TRUE(session.canvas().wet().empty());
    EXPECT_TRUE(identical(session.board()->wet(), mixed));
    session.apply(UndoEvent{});
    EXPECT_FALSE(identical(session.board()->wet(), mixed));
    for (int i = 0; i < 3; ++i) session.apply(UndoEvent{});
    EXPECT_TRUE(session.board()->wet().empty());
    for (int i = 0; i < 5; ++i) session.apply(RedoEvent{});
    EXPECT_TRUE(identical(session.board()->wet(), mixed));
    EXPECT_TRUE(identical(session.canvas().wet(), painted));
}

TEST(MixingBoard, PaintsAreLaidOutAlongTheRimOfAnyPalette) {
    for (const BoardSize size : {BoardSize{}, BoardSize{60, 120}, BoardSize{400, 100}}) {
        std::vector<std::string> names;
        for (const Pigment& paint : artist_acrylics().paints) names.push_back(paint.name);
        const auto piles = laid_out(names, size);
        ASSERT_EQ(piles.size(), names.size());
        for (std::size_t i = 0; i < piles.size(); ++i) {
            const PileEvent& pile = piles[i];
            EXPECT_EQ(pile.paint[0].first, names[i]);
            EXPECT_LE(std::abs(pile.at.x) + pile.size_mm / 2, size.width_mm / 2);
            EXPECT_LE(std::abs(pile.at.y) + pile.size_mm / 2, size.height_mm / 2);
            if (i == 0) continue;
            const double apart = std::hypot(pile.at.x - piles[i - 1].at.x, pile.at.y - piles[i - 1].at.y);
            EXPECT_GT(apart, 0.7 * pile.size_mm) << i;  // around a corner, they are nearer
        }
    }
    Session session(ground(), artist_acrylics());
    PaletteEvent all;
    all.all_paints = true;
    session.apply(all);
    EXPECT_EQ(session.board()->ingredients().size(), artist_acrylics().paints.size());
    const auto full = session.board()->volumes_mm3();
    for (const double mm3 : full) EXPECT_NEAR(mm3 / full[0], 1, 0.01);
    session.apply(PaletteEvent{});  // wiped
    EXPECT_TRUE(session.board()->wet().empty());
}

TEST(MixingBoard, HasPixelsOfThePaintingsSize) {
    EXPECT_DOUBLE_EQ(default_board_size(0.25).width_mm, 200);
    EXPECT_DOUBLE_EQ(default_board_size(0.02).width_mm, 32);
    EXPECT_DOUBLE_EQ(default_board_size(1).width_mm, 400);
    const Canvas board = make_board({50, 30}, 0.25);
    EXPECT_EQ(board.width(), 200);
    EXPECT_EQ(board.height(), 120);
    EXPECT_EQ(board.mm_per_pixel(), 0.25);
}

TEST(MixingBoard, ABrushHoldsSoMuchAndNoMore) {
    Session session(ground(), artist_acrylics());
    PileEvent deep = pile_of({{"Bone Black", 1}}, {0, 0});
    deep.size_mm = 40;
    deep.height_mm = 20;
    session.apply(deep);
    std::vector<Event> events;
    StrokeEvent stroke = stroke_on(Place::palette, BrushStart::clean);
    stroke.brush.hold_mm = 3;
    line(events, stroke, {-10, 0}, {10, 0});
    for (const Event& event : events) session.apply(event);
    Brush& brush = *const_cast<Brush*>(session.brush());
    const float* load = brush.load_total();
    const float most =
        *std::max_element(load, load + static_cast<std::ptrdiff_t>(brush.grid_size()) * brush.grid_size());
    EXPECT_GT(most, 1.5f);
    EXPECT_LE(most, 3.001f);
}

TEST(MixingBoard, MistakesAreToldAndChangeNothing) {
    Session session(ground(), artist_acrylics());
    const auto error = [&](const Event& event) { return error_of([&] { session.apply(event); }); };
    session.apply(pile_of({{"Bone Black", 1}}, {0, 0}));
    const PaintLayer before = session.board()->wet();
    session.apply(pile_of({{"Bone Black", 1}}, {900, 0}));  // beyond the palette
    EXPECT_THAT(error(pile_of({{"Vantablack", 1}}, {0, 0})), HasSubstr("Vantablack"));
    PaletteEvent other;
    other.width_mm = 50;
    other.height_mm = 50;
    EXPECT_THAT(error(other), AllOf(HasSubstr("200 x 150"), HasSubstr("already")));
    PaletteEvent missing;
    missing.paints = {"Bone Black", "Vantablack"};
    EXPECT_THAT(error(missing), HasSubstr("Vantablack"));
    EXPECT_TRUE(identical(session.board()->wet(), before));
    session.apply(UndoEvent{});  // the one pile is what there is to undo
    EXPECT_TRUE(session.board()->wet().empty());
    EXPECT_THAT(error(UndoEvent{}), HasSubstr("nothing to undo"));
    EXPECT_THAT(error_of([] { make_board({1e5, 10}, 0.25); }), HasSubstr("8192"));
}

TEST(MixingBoard, FinishIsThePaintsGlossOnThePainting) {
    Session session(ground(), artist_acrylics());
    StrokeEvent stroke = stroke_on(Place::painting, BrushStart::clean);
    stroke.paint = {{"Bone Black", 1}};
    std::vector<Event> events;
    line(events, stroke, {-8, 3}, {8, 3});
    stroke.finish = {.specular = 0.08, .roughness = 0.4, .medium = 0.5};
    line(events, stroke, {-8, -3}, {8, -3});
    for (const Event& event : events) session.apply(event);
    const auto& paints = session.canvas().ingredients();
    ASSERT_EQ(paints.size(), 2u);
    EXPECT_EQ(paints[1].name, "Bone Black");
    EXPECT_FLOAT_EQ(paints[1].specular, 0.08f);
    EXPECT_FLOAT_EQ(paints[1].roughness, 0.4f);
    EXPECT_FLOAT_EQ(paints[1].k[3], 0.5f * paints[0].k[3]);
    stroke.finish.roughness = 2;
    EXPECT_THAT(error_of([&] { session.apply(stroke); }), AllOf(HasSubstr("roughness"), HasSubstr("2")));
}

TEST(MixingBoard, APileTooSmallForThePixelsHasItsVolume) {
    for (const double size_mm : {0.05, 0.3, 0.7})  // pixels are 0.25 mm
        for (const PointMm at : {PointMm{0, 0}, PointMm{0.125, 0.125}, PointMm{0.06, -0.03}}) {
            Canvas canvas = flat_canvas(64, 64);
            lay_pile(canvas, {{add_paint(canvas, "Bone Black"), 1}}, at, size_mm, 0.5);
            const double wanted = std::numbers::pi / 8 * size_mm * size_mm * 0.5;  // of a dome
            EXPECT_NEAR(canvas.volumes_mm3()[0] / wanted, 1, 0.25) << size_mm;
        }
}

TEST(MixingBoard, APileFindsRoom) {
    Canvas board = make_board({60, 40}, 0.25);
    EXPECT_NEAR(free_place(board, 12).x, 0, 0.5) << "an empty palette's middle";
    EXPECT_NEAR(free_place(board, 12).y, 0, 0.5);
    const std::vector<Portion> white = {{board.add(artist_acrylics().paints.front()), 1}};
    std::vector<PointMm> places;
    for (int i = 0; i < 6; ++i) {
        const PointMm at = free_place(board, 12);
        EXPECT_LE(std::abs(at.x), 24.5);
        EXPECT_LE(std::abs(at.y), 14.5);
        for (const PointMm& other : places) EXPECT_GT(std::hypot(at.x - other.x, at.y - other.y), 11);
        lay_pile(board, white, at, 12, 1);
        places.push_back(at);
    }
    for (int i = 0; i < 30; ++i) lay_pile(board, white, free_place(board, 12), 12, 1);  // all is full
    EXPECT_LE(std::abs(free_place(board, 12).x), 24.5);
    EXPECT_NEAR(free_place(board, 500).x, 0, 10) << "wider than the palette";
}

}  // namespace
}  // namespace tangi
