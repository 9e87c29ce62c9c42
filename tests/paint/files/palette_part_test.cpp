// palette_part_test.cpp: a sitting that goes on with the palette and the brush of another paints the same
// bits as one that was never interrupted; damaged ones say what is wrong.
#include "paint/files/palette_part.h"

#include <gmock/gmock.h>

#include "paint/files/canvas_file.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<Event> stroke_of(const StrokeEvent& event, PathPoint from, PathPoint to) {
    std::vector<Event> events = {event};
    for (int i = 0; i <= 12; ++i)
        events.push_back(PointEvent{{.time_s = 0.01 * i,
                                     .x_mm = from.x + (to.x - from.x) * i / 12,
                                     .y_mm = from.y + (to.y - from.y) * i / 12}});
    events.push_back(EndEvent{});
    return events;
}

// Mixed on the palette, painted, mixed on, painted with what is left on a brush that has turned.
std::vector<Event> recovery() {
    PaletteEvent palette;
    palette.paints = {"Titanium White", "Ultramarine Blue", "Diarylide Yellow"};
    palette.width_mm = palette.height_mm = 40;
    std::vector<Event> events = {palette};
    StrokeEvent mix, paint;
    mix.brush = paint.brush = brush_presets().at("flat");
    mix.on = Place::palette;
    mix.start = paint.start = BrushStart::same;
    const auto add = [&](const std::vector<Event>& more) {
        events.insert(events.end(), more.begin(), more.end());
    };
    add(stroke_of(mix, {-15, -15}, {12, 15}));
    add(stroke_of(paint, {-14, 0}, {14, 3}));
    mix.seed = paint.seed = 5;
    add(stroke_of(mix, {15, 10}, {-12, -15}));
    add(stroke_of(paint, {0, -10}, {4, 10}));
    return events;
}

void apply(Session& session, const std::vector<Event>& events, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) session.apply(events[i]);
    session.finish();
}

void save(const std::filesystem::path& path, const Session& session) {
    AtomicFile file(path);
    write_canvas(file, session.canvas(), {}, with_tools({}, session));
}

TEST(ToolsFile, AnInterruptedSittingPaintsTheSame) {
    const TestDir dir;
    const std::vector<Event> events = recovery();
    Session once(flat_canvas(160, 120), artist_acrylics());
    apply(once, events, 0, events.size());
    for (const std::size_t strokes : {1, 2, 3}) {
        const std::size_t cut = 1 + 15 * strokes;
        Session first(flat_canvas(160, 120), artist_acrylics());
        apply(first, events, 0, cut);
        save(dir / "a.exr", first);
        Session second(read_canvas(dir / "a.exr"), artist_acrylics());
        read_tools(dir / "a.exr", second);
        apply(second, events, cut, events.size());
        EXPECT_TRUE(identical(second.canvas().wet(), once.canvas().wet())) << strokes;
        EXPECT_TRUE(identical(second.board()->wet(), once.board()->wet())) << strokes;
        EXPECT_TRUE(second.brush()->bristles().mm == once.brush()->bristles().mm) << strokes;
        // It makes a difference.
        Session bare(read_canvas(dir / "a.exr"), artist_acrylics());
        apply(bare, events, cut, events.size());
        EXPECT_FALSE(identical(bare.canvas().wet(), once.canvas().wet())) << strokes;
    }
}

TEST(ToolsFile, OtherPartsStayAndToolsAreReplaced) {
    const TestDir dir;
    const std::vector<Event> events = recovery();
    Session session(flat_canvas(160, 120), artist_acrylics());
    apply(session, events, 0, 16);
    PartToWrite other;
    other.info = {"other", 3, 2, {"x"}, {}};
    other.fill = [](int, int, std::span<float* const> planes) { planes[0][0] = 7; };
    {
        AtomicFile file(dir / "a.exr");
        write_canvas(file, session.canvas(), {}, with_tools({other}, session));
    }
    apply(session, events, 16, events.size());
    {
        AtomicFile file(dir / "b.exr");
        write_canvas(file, session.canvas(), {}, with_tools(parts_beside_paint(dir / "a.exr"), session));
    }
    std::vector<std::string> names;
    for (const PartInfo& part : painting_parts(dir / "b.exr")) names.push_back(part.name);
    EXPECT_THAT(names, testing::UnorderedElementsAre("wet", "other", "palette", "brush"));
    Session again(read_canvas(dir / "b.exr"), artist_acrylics());
    read_tools(dir / "b.exr", again);
    EXPECT_TRUE(identical(again.board()->wet(), session.board()->wet()));
    // A painting without tools has none.
    Session bare(flat_canvas(20, 20), artist_acrylics());
    save(dir / "c.exr", bare);
    read_tools(dir / "c.exr", bare);
    EXPECT_EQ(bare.board(), nullptr);
    EXPECT_EQ(bare.brush(), nullptr);
}

// Earlier versions gave brushes that are too small for the pixels a smaller grid.
TEST(ToolsFile, TheSmallerGridOfATinyBrushIsTakenUp) {
    const TestDir dir;
    Session session(flat_canvas(160, 120), artist_acrylics());
    StrokeEvent event;
    event.brush.size_mm = 0.1;
    event.paint = {{"Bone Black", 1}};
    apply(session, stroke_of(event, {-9, 0}, {9, 0}), 0, 14);
    std::vector<PartToWrite> parts = with_tools({}, session);
    ASSERT_EQ(parts.back().info.name, "brush");
    const int size = parts.back().info.width, small = size - 2;
    const auto fill = parts.back().fill;
    parts.back().info.width = parts.back().info.height = small;
    parts.back().fill = [=](int y0, int y1, std::span<float* const> planes) {
        std::vector<std::vector<float>> whole(planes.size(),
                                              std::vector<float>(static_cast<std::size_t>(size * size)));
        std::vector<float*> rows;
        for (auto& plane : whole) rows.push_back(plane.data());
        fill(0, size, rows);
        for (std::size_t c = 0; c < planes.size(); ++c)
            for (int y = y0; y < y1; ++y)
                std::copy_n(rows[c] + (y + 1) * size + 1, small, planes[c] + (y - y0) * small);
    };
    {
        AtomicFile file(dir / "a.exr");
        write_canvas(file, session.canvas(), {}, parts);
    }
    Session again(read_canvas(dir / "a.exr"), artist_acrylics());
    read_tools(dir / "a.exr", again);
    EXPECT_TRUE(again.brush()->bristles().mm == session.brush()->bristles().mm);
}

TEST(ToolsFile, DamagedToolsSayWhatIsWrong) {
    const TestDir dir;
    Session session(flat_canvas(160, 120), artist_acrylics());
    apply(session, recovery(), 0, 16);
    const auto message = [&](const std::function<void(PartToWrite&)>& damage, const std::string& name) {
        std::vector<PartToWrite> parts = with_tools({}, session);
        for (PartToWrite& part : parts)
            if (part.info.name == name) damage(part);
        AtomicFile file(dir / "bad.exr");
        write_canvas(file, session.canvas(), {}, parts);
        Session again(read_canvas(dir / "bad.exr"), artist_acrylics());
        return error_of([&] { read_tools(dir / "bad.exr", again); });
    };
    const auto with_brush = [](const std::string& from, const std::string& to) {
        return [=](PartToWrite& part) {
            std::string& text = part.info.attributes.at("brush");
            text.replace(text.find(from), from.size(), to);
        };
    };
    EXPECT_THAT(message([](PartToWrite& part) { part.info.attributes.clear(); }, "brush"),
                AllOf(HasSubstr("bad.exr"), HasSubstr("attribute 'brush'")));
    EXPECT_THAT(message(with_brush("\"on\":\"palette\"", "\"on\":\"floor\""), "brush"), HasSubstr("floor"));
    EXPECT_THAT(message(with_brush("\"size_mm\":12.0", "\"size_mm\":14.0"), "brush"),
                HasSubstr("a brush of these settings is"));
    EXPECT_THAT(message(with_brush("\"size_mm\":12.0", "\"size_mm\":-1"), "brush"), HasSubstr("size_mm"));
    EXPECT_THAT(message(with_brush("\"size_mm\":12.0", "\"size_mm\":999"), "brush"),
                AllOf(HasSubstr("bad.exr"), HasSubstr("pixels wide here")));
    EXPECT_THAT(message([](PartToWrite& part) { part.info.channels.back() = "volume.00077"; }, "brush"),
                HasSubstr("no ingredient"));
    EXPECT_THAT(message(
                    [](PartToWrite& part) {
                        part.fill = [](int, int, std::span<float* const> planes) { planes[0][5] = -3; };
                    },
                    "palette"),
                AllOf(HasSubstr("part 'palette'"), HasSubstr("pixel (5, ")));
    const auto with_value = [](std::size_t channel, float value) {
        return [=](PartToWrite& part) {
            part.fill = [=, fill = part.fill](int y0, int y1, std::span<float* const> planes) {
                fill(y0, y1, planes);
                if (y0 == 0) planes[channel][5] = value;
            };
        };
    };
    EXPECT_THAT(message(with_value(0, 1e30f), "palette"),
                AllOf(HasSubstr("bad.exr: part 'palette' holds 1e+30 mm of paint at pixel (5, 0)")));
    EXPECT_THAT(message(with_value(1, 1e30f), "brush"),
                HasSubstr("bad.exr: part 'brush' holds 1e+30 mm of paint at pixel (5, 0)"));
    for (const std::size_t channel : {0u, 1u})
        EXPECT_THAT(message(with_value(channel, 500), "brush"),
                    AllOf(HasSubstr("bad.exr: part 'brush', channel 'total' holds"),
                          HasSubstr("at pixel (5, 0), but the volumes there sum to")));
    // Paint on the brush, of a painting that lists none.
    {
        Session bare(flat_canvas(160, 120), artist_acrylics());
        std::vector<PartToWrite> parts = with_tools({}, session);
        std::erase_if(parts, [](const PartToWrite& part) { return part.info.name != "brush"; });
        with_brush("\"on\":\"palette\"", "\"on\":\"painting\"")(parts.at(0));
        AtomicFile file(dir / "bad.exr");
        write_canvas(file, bare.canvas(), {}, parts);
        EXPECT_THAT(error_of([&] { read_tools(dir / "bad.exr", bare); }),
                    AllOf(HasSubstr("bad.exr: part 'brush'"), HasSubstr("no ingredient")));
    }
    EXPECT_THAT(message([](PartToWrite& part) { part.info.attributes["ingredients"] = "[{"; }, "palette"),
                HasSubstr("attribute 'ingredients' of part 'palette'"));
}

}  // namespace
}  // namespace tangi
