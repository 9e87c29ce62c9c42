// bind_relight.cpp: lights, and paintings under them.
#include "python/bindings.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"

namespace tangi::python {

namespace {

using Xyz = std::array<float, 3>;

Vec3 vector_of(const Xyz& v) { return {v[0], v[1], v[2]}; }
Xyz xyz_of(const Vec3& v) { return {v.x, v.y, v.z}; }

Light light_of(const std::optional<Xyz>& direction, const std::optional<Xyz>& position_mm, const Xyz& gain,
               const std::string& name) {
    if (direction.has_value() == position_mm.has_value())
        fail("a light has either a direction or a position_mm");
    const Vec3 towards = vector_of(direction ? *direction : *position_mm);
    if (towards == Vec3(0)) fail("a light's direction, or its position, cannot be 0, 0, 0");
    Light light = direction ? distant_light(towards, name) : near_light(towards, name);
    light.gain = vector_of(gain);
    return light;
}

// Whether the painting's residual is added: where it is asked for, there must be one.
bool adds_residual(const Painting& painting, const std::optional<bool>& asked,
                   const RelightOptions& options) {
    if (!asked.value_or(true)) return false;
    if (painting.has_residual() && belongs_to(painting.residual, painting.surface, options)) return true;
    if (!asked) return false;
    if (!painting.has_residual()) fail("residual: the painting has none, or its maps have changed");
    fail("residual: it is one of cast_shadows=True, model='bounded' and light_radius_deg={:g}",
         painting.residual.light_radius_deg);
}

py::array relit(const SharedPainting& painting, const py::object& lights, const std::string& model,
                const std::optional<bool>& residual, const py::object& progress, const py::kwargs& words) {
    RelightOptions options;
    std::set<std::string> left = names_of(words);
    take(options, words, left);
    refuse(left);
    const auto known = ward_model_named(model);
    if (!known) fail("model: {} is no model of reflectance", model);
    options.model = *known;
    const std::vector<Light> list = lights_of(lights);
    return array_of(long_work(progress, [&](const Progress& told) {
        const bool adds = adds_residual(*painting, residual, options);
        Image<Rgb> picture = relight(painting->surface, list, options, told);
        if (adds) add_residual(painting->residual, painting->surface, list, {}, picture);
        return picture;
    }));
}

void save_picture(const std::string& path, const py::array& picture, const std::string& encoding) {
    if (picture.ndim() != 3 || picture.shape(2) != 3)
        fail("{}: a picture is an array of shape (height, width, 3)", path);
    Image<Rgb> image(static_cast<int>(picture.shape(1)), static_cast<int>(picture.shape(0)));
    copy_into(image, picture, "picture");
    const auto transfer = transfer_named(encoding);
    if (!transfer) fail("encoding: {} is none of linear, srgb, or a gamma", encoding);
    const py::gil_scoped_release unlock;
    write_picture(path, image, *transfer);
}

}  // namespace

void bind_relight(py::module_& module) {
    py::class_<Light>(
        module, "Light",
        "A distant light of this direction, or a near one at position_mm: x right, y up, z towards "
        "the viewer, from the picture's centre.")
        .def(py::init(&light_of), py::arg("direction") = py::none(), py::kw_only(),
             py::arg("position_mm") = py::none(), py::arg("gain") = Xyz{1, 1, 1}, py::arg("name") = "")
        .def_readonly("name", &Light::name, "the photograph that it belongs to, or empty")
        .def_property_readonly(
            "direction", [](const Light& l) { return xyz_of(l.direction); },
            "(x, y, z) [unit vector] from the surface to the light")
        .def_property_readonly(
            "position_mm",
            [](const Light& l) {
                return l.position_mm ? std::optional(xyz_of(*l.position_mm)) : std::nullopt;
            },
            "(x, y, z) [mm] of a near light, or None")
        .def_property_readonly(
            "gain", [](const Light& l) { return xyz_of(l.gain); },
            "(r, g, b) [1] linear value of a matt white that faces it")
        .def("__repr__", [](const Light& l) {
            return fmt::format("<tangipaint.Light {:.3f}, {:.3f}, {:.3f}>", l.direction.x, l.direction.y,
                               l.direction.z);
        });
    module.def(
        "relight", &relit, py::arg("painting"), py::arg("lights"), py::kw_only(),
        py::arg("model") = "bounded", py::arg("residual") = py::none(), py::arg("progress") = py::none(),
        "(h, w, 3) float32, linear Rec. 709: the painting under all of `lights` together, a list of "
        "directions (x, y, z) or of Light. 1 is a matt white that faces a light of gain 1. Options: "
        "cast_shadows, light_radius_deg [deg], ambient [1]. residual: whether what the photographs showed "
        "beyond the maps is added; None: with cast_shadows, where the painting has it.");
    module.def("save_picture", &save_picture, py::arg("path"), py::arg("picture"),
               py::arg("encoding") = "srgb",
               "Writes a linear picture (h, w, 3) as .png or .tif (16 bits), .jpg or .exr (linear).");
}

}  // namespace tangi::python
