#include "python/bindings.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"

namespace tangi::python {

namespace {

constexpr py::ssize_t kSize = sizeof(float);

template <class T>
std::vector<py::ssize_t> shape_of(const Image<T>& image) {
    std::vector<py::ssize_t> shape = {image.height(), image.width()};
    if (sizeof(T) == sizeof(Rgb)) shape.push_back(3);
    return shape;
}

template <class T>
py::array view(Image<T>& image, const py::object& owner) {
    constexpr py::ssize_t pixel = sizeof(T);
    std::vector<py::ssize_t> strides = {pixel * image.width(), pixel};
    if (sizeof(T) == sizeof(Rgb)) strides.push_back(kSize);
    return py::array(py::dtype::of<float>(), shape_of(image), strides, image.data(), owner);
}

template <class T>
py::array owned(Image<T>&& image) {
    auto* kept = new Image<T>(std::move(image));
    const py::capsule owner(kept, [](void* picture) { delete static_cast<Image<T>*>(picture); });
    return view(*kept, owner);
}

template <class T>
void copied(Image<T>& image, const py::array& values, const char* name) {
    const auto numbers = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(values);
    const std::vector<py::ssize_t> wanted = shape_of(image);
    const std::vector<py::ssize_t> found(values.shape(), values.shape() + values.ndim());
    if (!numbers || found != wanted)
        fail("{}: an array of shape ({}) is given, and the map's is ({})", name, fmt::join(found, ", "),
             fmt::join(wanted, ", "));
    std::memcpy(image.data(), numbers.data(), image.size() * sizeof(T));
}

}  // namespace

py::array view_of(Image<float>& image, const py::object& owner) { return view(image, owner); }
py::array view_of(Image<Rgb>& image, const py::object& owner) { return view(image, owner); }
py::array array_of(Image<float>&& image) { return owned(std::move(image)); }
py::array array_of(Image<Rgb>&& image) { return owned(std::move(image)); }
void copy_into(Image<float>& image, const py::array& values, const char* name) {
    copied(image, values, name);
}
void copy_into(Image<Rgb>& image, const py::array& values, const char* name) { copied(image, values, name); }

py::object from_json(const nlohmann::json& json) {
    return py::module_::import("json").attr("loads")(json_line(json));
}

nlohmann::json to_json(const py::handle& object) {
    return read_json(py::module_::import("json").attr("dumps")(object).cast<std::string>(), "the argument");
}

std::vector<Light> lights_of(const py::object& lights) {
    std::vector<Light> found;
    for (const py::handle light : lights) {
        if (py::isinstance<Light>(light)) {
            found.push_back(light.cast<Light>());
            continue;
        }
        const auto xyz = light.cast<std::array<float, 3>>();
        if (xyz == std::array<float, 3>{}) fail("a light of direction (0, 0, 0) has none");
        found.push_back(distant_light({xyz[0], xyz[1], xyz[2]}));
    }
    return found;
}

std::set<std::string> names_of(const py::kwargs& words) {
    std::set<std::string> names;
    for (const auto& [name, value] : words) names.insert(name.cast<std::string>());
    return names;
}

void refuse(const std::set<std::string>& left) {
    if (!left.empty()) throw py::type_error(fmt::format("there is no option {}", fmt::join(left, ", ")));
}

}  // namespace tangi::python
