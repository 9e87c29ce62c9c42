// bindings.h: what the sources of the Python module share: arrays without copies, JSON, options by name, and
// long functions that Python may interrupt.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "fit/pixel/fit_errors.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relighting_residual.h"

namespace tangi::python {

namespace py = pybind11;

// A painting as Python holds it: its maps, and of a fit its standard errors and its residual, where there are
// any. The residual is that of the maps as they were fitted: nobody's where paint lies on them.
struct Painting {
    Surface surface;
    std::optional<FitErrors> errors{};
    RelightingResidual residual{};

    bool has_residual() const { return !residual.empty() && residual.dry_hash == hash_of(surface); }
};
using SharedPainting = std::shared_ptr<Painting>;

void bind_painting(py::module_& module);
void bind_stack(py::module_& module);
void bind_relight(py::module_& module);
void bind_canvas(py::module_& module);

// Numbers of a picture as an array, (height, width) or (height, width, 3), float32. `owner` keeps the picture
// alive; the array looks into it.
py::array view_of(Image<float>& image, const py::object& owner);
py::array view_of(Image<Rgb>& image, const py::object& owner);
// The same of a picture that nobody else holds.
py::array array_of(Image<float>&& image);
py::array array_of(Image<Rgb>&& image);

// Copies an array into a picture of the same size. Throws Error naming the map and both shapes.
void copy_into(Image<float>& image, const py::array& values, const char* name);
void copy_into(Image<Rgb>& image, const py::array& values, const char* name);

py::object from_json(const nlohmann::json& json);
nlohmann::json to_json(const py::handle& object);

// A sequence of lights: (x, y, z) each, or Light.
std::vector<Light> lights_of(const py::object& lights);

// Sets the fields that keywords name, and takes these out of `left`.
template <class Options>
void take(Options& options, const py::kwargs& words, std::set<std::string>& left) {
    Options::fields(options, [&](const FieldInfo& info, auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        const std::string name(info.name);
        if (!words.contains(name.c_str())) return;
        try {
            value = words[name.c_str()].template cast<T>();
        } catch (const py::cast_error&) {
            throw py::type_error(fmt::format("{}: a number is expected, or None", name));
        }
        left.erase(name);
    });
    validate(options);
}
std::set<std::string> names_of(const py::kwargs& words);
// Throws TypeError naming what no options took.
void refuse(const std::set<std::string>& left);

// Runs `work(progress)` without the interpreter's lock. `callback(stage, fraction)` may be None; where it
// returns False the work stops (Cancelled), and what it raises comes out here. Ctrl-C stops the work, too.
template <class Work>
auto long_work(const py::object& callback, Work&& work) {
    std::exception_ptr raised;
    std::chrono::steady_clock::time_point looked{};
    const bool is_silent = callback.is_none();
    const Progress progress = [&](std::string_view stage, double fraction) {
        const auto now = std::chrono::steady_clock::now();
        if (is_silent && now - looked < std::chrono::milliseconds(100)) return true;
        looked = now;
        const py::gil_scoped_acquire lock;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            return is_silent || !callback(std::string(stage), fraction).is(py::bool_(false));
        } catch (...) {
            raised = std::current_exception();
            return false;
        }
    };
    try {
        const py::gil_scoped_release unlock;
        return work(progress);
    } catch (const Cancelled&) {
        if (raised) std::rethrow_exception(raised);
        throw;
    }
}

}  // namespace tangi::python
