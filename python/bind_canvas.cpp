// bind_canvas.cpp: canvases, and strokes on them.
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "paint/session/session.h"
#include "paint/substrate/substrate.h"
#include "python/bindings.h"
#include "retouch/treatment/confining_mask.h"
#include "surface/base/error.h"

namespace tangi::python {

namespace {

using Point = std::array<double, 4>;

// A sitting at a canvas; not to be copied.
using Sitting = std::unique_ptr<Session>;

Sitting on_painting(const SharedPainting& painting, const std::optional<double>& mm_per_pixel) {
    return std::make_unique<Session>(Canvas(std::make_shared<Surface>(painting->surface), mm_per_pixel),
                                     artist_acrylics());
}

Sitting opened(const std::string& path) {
    const py::gil_scoped_release unlock;
    return std::make_unique<Session>(read_canvas(path), artist_acrylics());
}

Sitting substrate(const std::string& kind, const py::kwargs& words) {
    SubstrateOptions options;
    std::set<std::string> left = names_of(words);
    take(options, words, left);
    refuse(left);
    const auto known = substrate_named(kind);
    if (!known) fail("{}: is no substrate", kind);
    const py::gil_scoped_release unlock;
    return std::make_unique<Session>(std::make_shared<Surface>(make_substrate(*known, options)),
                                     artist_acrylics());
}

// One stroke through these points [s, mm, mm, 1].
void stroke(Session& session, const std::vector<Point>& points, const py::dict& paint, const py::dict& brush,
            const py::kwargs& words) {
    if (points.empty()) fail("a stroke has a point at least: (t [s], x [mm], y [mm], pressure)");
    nlohmann::json first = to_json(words);
    first["event"] = "stroke";
    first["brush"] = to_json(brush);
    if (!paint.empty()) first["paint"] = to_json(paint);
    std::vector<Event> events = {event_from_json(first, "stroke")};
    for (const auto& [t, x, y, p] : points)
        events.push_back(
            event_from_json({{"event", "point"}, {"t", t}, {"x", x}, {"y", y}, {"p", p}}, "point"));
    events.emplace_back(EndEvent{});
    const py::gil_scoped_release unlock;
    for (const Event& event : events) session.apply(event);
}

std::vector<std::string> replayed(Session& session, const std::string& path, const py::object& progress) {
    return long_work(progress, [&](const Progress& told) {
        session.masks_from(masks_beside(path, session.canvas().width(), session.canvas().height()));
        return replay(session, read_journal(path), told);
    });
}

void bind_canvas_properties(py::class_<Session>& type) {
    type.def_property_readonly(
            "volumes_mm3",
            [](const Session& session) {
                return volumes_by_name(session.canvas().ingredients(), session.canvas().volumes_mm3());
            },
            "{name: volume} [mm^3] of each paint")
        .def_property_readonly(
            "layers",
            [](const Session& session) {
                std::vector<std::string> names;
                for (const DriedLayer& layer : session.canvas().dried()) names.push_back(layer.name);
                return names;
            },
            "names of the dried layers, from the bottom up")
        .def_property_readonly(
            "width", [](const Session& s) { return s.canvas().width(); }, "[pixels]")
        .def_property_readonly(
            "height", [](const Session& s) { return s.canvas().height(); }, "[pixels]")
        .def_property_readonly(
            "mm_per_pixel", [](const Session& s) { return s.canvas().mm_per_pixel(); }, "[mm]");
}

}  // namespace

void bind_canvas(py::module_& module) {
    py::class_<Session> type(module, "Canvas", "A surface to paint on, with wet paint and dried layers.");
    type.def(py::init(&on_painting), py::arg("painting"), py::arg("mm_per_pixel") = py::none(),
             "To paint on a painting, of which a copy is taken.")
        .def_static("open", &opened, py::arg("path"), "A painting file, with the paint that is in it.")
        .def_static("substrate", &substrate, py::arg("kind"),
                    "A piece of linen, panel, paper …; options: width_mm, height_mm, pixel_mm, seed.")
        .def("stroke", &stroke, py::arg("points"), py::arg("paint"), py::arg("brush") = py::dict(),
             "One stroke through points (t [s], x [mm], y [mm], pressure 0..1), x right and y up from the "
             "middle. "
             "paint: {name in the palette: part}. brush: {'preset': 'flat', 'size_mm': 12}. Further fields "
             "are "
             "those of a journal's stroke: load, seed.")
        .def(
            "apply",
            [](Session& session, const py::dict& event) {
                const Event read = event_from_json(to_json(event), "event");
                const py::gil_scoped_release unlock;
                session.apply(read);
            },
            py::arg("event"), "One event, as a line of a journal has it: {'event': 'dry', 'layer': 'first'}.")
        .def("replay", &replayed, py::arg("journal"), py::arg("progress") = py::none(),
             "Paints all strokes of a journal (.jsonl); returns what is to be known, a list of sentences.")
        .def(
            "painting",
            [](Session& session, const py::object& progress) {
                return long_work(progress, [&](const Progress& told) {
                    session.finish();
                    return std::make_shared<Painting>(Painting{appearance(session.canvas(), {}, told)});
                });
            },
            py::arg("progress") = py::none(), "A Painting: the canvas as it looks, with its paint.")
        .def(
            "save",
            [](Session& session, const std::string& path) {
                const py::gil_scoped_release unlock;
                session.finish();
                write_canvas(path, session.canvas());
            },
            py::arg("path"), "Writes a painting file (.exr) with all paint in it.");
    bind_canvas_properties(type);
    module.def(
        "paints",
        [] {
            std::vector<std::string> names;
            for (const Pigment& paint : artist_acrylics().paints) names.push_back(paint.name);
            return names;
        },
        "names of the paints that strokes may have");
}

}  // namespace tangi::python
