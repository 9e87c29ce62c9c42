// bind_painting.cpp: paintings and their maps.
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "python/bindings.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi::python {

namespace {

SharedPainting read(const std::string& path, bool painted, const py::object& progress) {
    return long_work(progress, [&](const Progress& told) {
        auto painting = std::make_shared<Painting>();
        bool with_paint = false;
        if (painted) {
            const Canvas canvas = read_canvas(path, told);
            with_paint = !canvas.ingredients().empty();
            painting->surface = with_paint ? appearance(canvas, {}, told) : canvas.dry();
        } else {
            painting->surface = read_painting(path, told);
        }
        if (has_errors(path)) painting->errors = read_errors(path, told);
        if (!with_paint) painting->residual = read_residual(path, painting->surface, told);
        return painting;
    });
}

void save(const Painting& painting, const std::string& path, const py::object& progress) {
    long_work(progress, [&](const Progress& told) {
        std::vector<PartToWrite> parts;
        if (painting.errors) parts.push_back(part_of(*painting.errors));
        if (painting.has_residual()) parts.push_back(part_of(painting.residual));
        AtomicFile file(path);
        write_painting(file, painting.surface, parts, told);
        return true;
    });
}

// A map as a property that looks into the painting, and takes arrays of its shape.
template <class T>
void map(py::class_<Painting, SharedPainting>& type, const char* name, Image<T> Surface::*image,
         const char* doc) {
    type.def_property(
        name,
        [image](const py::object& self) { return view_of(self.cast<Painting&>().surface.*image, self); },
        [image, name](Painting& painting, const py::array& values) {
            copy_into(painting.surface.*image, values, name);
        },
        doc);
}

py::dict errors_of(const Painting& painting) {
    py::dict errors;
    if (!painting.errors) return errors;
    const auto floats = [](const auto& halves) {
        Image<float> image(halves.width(), halves.height());
        for (std::size_t i = 0; i < image.size(); ++i)
            image.pixels()[i] = static_cast<float>(halves.pixels()[i]);
        return array_of(std::move(image));
    };
    errors["height_mm"] = floats(painting.errors->height);
    errors["slope"] = floats(painting.errors->slope);
    errors["diffuse"] = floats(painting.errors->diffuse);
    errors["specular"] = floats(painting.errors->specular);
    errors["roughness"] = floats(painting.errors->roughness);
    return errors;
}

void bind_properties(py::class_<Painting, SharedPainting>& type) {
    type.def_property_readonly(
            "width", [](const Painting& p) { return p.surface.width(); }, "[pixels]")
        .def_property_readonly(
            "height", [](const Painting& p) { return p.surface.height(); }, "[pixels]")
        .def_property(
            "mm_per_pixel", [](const Painting& p) { return p.surface.mm_per_pixel; },
            [](Painting& p, double mm) {
                if (!(mm > 0) || !std::isfinite(mm)) fail("mm_per_pixel: {} is not positive", mm);
                p.surface.mm_per_pixel = kept_scale_mm(mm);
                p.surface.scale_known = true;
            },
            "[mm] size of a pixel; 1 where unknown. Setting it makes the scale known.")
        .def_property_readonly(
            "scale_known", [](const Painting& p) { return p.surface.scale_known; },
            "whether mm_per_pixel is more than a guess")
        .def_property_readonly(
            "provenance",
            [](const Painting& p) {
                const nlohmann::json json = json_or_discarded(p.surface.provenance);
                return json.is_discarded() ? py::object(py::str(p.surface.provenance)) : from_json(json);
            },
            "dict: program, command, options, and the inputs with their SHA-256")
        .def_property_readonly(
            "lights",
            [](const Painting& p) {
                std::vector<Light> lights;
                for (const auto& photo : p.surface.photography.photos) lights.push_back(photo.light);
                return lights;
            },
            "the lights that it was photographed with, a list of Light")
        .def_property_readonly("has_residual", &Painting::has_residual,
                               "whether relight() can add what the photographs showed beyond these maps")
        .def_property_readonly("errors", &errors_of,
                               "dict of (h, w) standard errors: height_mm [mm], slope, diffuse, specular, "
                               "roughness [1]; empty where nothing is known")
        .def_property_readonly(
            "hash", [](const Painting& p) { return hash_of(p.surface); }, "of the maps, 16 hex digits")
        .def("save", &save, py::arg("path"), py::arg("progress") = py::none(),
             "Writes a painting file (.exr), whole or not at all. Paint on it is not kept: Canvas.save keeps "
             "it; nor is the residual of maps that have changed since.")
        .def("__repr__", [](const Painting& p) {
            return fmt::format("<tangipaint.Painting {} x {} pixels, {:g} mm each{}>", p.surface.width(),
                               p.surface.height(), p.surface.mm_per_pixel,
                               p.surface.scale_known ? "" : " (not known)");
        });
}

}  // namespace

void bind_painting(py::module_& module) {
    py::class_<Painting, SharedPainting> type(
        module, "Painting",
        "A painting as maps of shape and reflectance. Maps are numpy arrays, float32, that look into the "
        "painting: what is written to them is in it. Rows run downwards; x is right, y up, z towards the "
        "viewer.");
    type.def(py::init([](int width, int height) {
                 if (width < 1 || height < 1) fail("a painting of {} x {} pixels has none", width, height);
                 return std::make_shared<Painting>(Painting{Surface(width, height)});
             }),
             py::arg("width"), py::arg("height"), "A flat, black painting of which nothing was measured.");
    map(type, "height_mm", &Surface::height_mm, "(h, w) [mm] height above the mean plane of the support");
    map(type, "normal", &Surface::normal, "(h, w, 3) [unit vector] normals, z > 0");
    map(type, "diffuse", &Surface::diffuse, "(h, w, 3) [1] diffuse reflectance, linear Rec. 709");
    map(type, "specular", &Surface::specular, "(h, w) [1] specular reflectance");
    map(type, "roughness", &Surface::roughness, "(h, w) [1] Ward's alpha, rms slope of the microfacets");
    map(type, "confidence", &Surface::confidence, "(h, w) [1] 0: not measured, up to 1: certain");
    bind_properties(type);
    module.def("open", &read, py::arg("path"), py::arg("painted") = true, py::arg("progress") = py::none(),
               "Reads a painting file (.exr); with its paint as it looks, or without it (painted=False).");
}

}  // namespace tangi::python
