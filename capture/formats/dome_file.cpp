#include "capture/formats/dome_file.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kFarthestLight_mm = 1e6;  // 1 km

glm::dvec3 vector_in(const JsonField& entry) {
    const glm::dvec3 v(entry["x"].number(), entry["y"].number(), entry["z"].number());
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!std::isfinite(largest) || largest > kFarthestLight_mm)
        fail("{}: {} is out of range", entry.file(), entry.path());
    if (!(largest > 1e-6))
        fail("{}: {} is a zero vector; give a direction, or take this light out of all lists", entry.file(),
             entry.path());
    return v;
}

std::vector<glm::dvec3> vectors_in(const JsonField& dome, const char* key) {
    std::vector<glm::dvec3> vectors;
    if (!dome.has(key)) return vectors;
    for (const JsonField& entry : dome[key].list()) vectors.push_back(vector_in(entry));
    // Relight of early 2023 wrote x for all three.
    const auto is_flawed = [](const glm::dvec3& v) { return v.x == v.y && v.y == v.z; };
    if (vectors.size() > 1 && std::all_of(vectors.begin(), vectors.end(), is_flawed))
        fail(
            "{}: x, y and z of every vector of {} are the same: an early version of Relight wrote x for all "
            "three. "
            "Save the dome again with a later one",
            dome.file(), dome[key].path());
    return vectors;
}

double length_in(const JsonField& dome, const char* key) {
    if (!dome.has(key)) return 0;
    const double mm = dome[key].number();
    if (!(std::abs(mm) <= kFarthestLight_mm))
        fail("{}: {} = {} mm is farther than 1 km", dome.file(), dome[key].path(), mm);
    return mm;
}

// [mm] Of the lights, where the file holds positions.
std::vector<glm::dvec3> positions_in(const JsonField& dome, const std::vector<glm::dvec3>& directions) {
    const std::string kind =
        dome.has("lightConfiguration") ? dome["lightConfiguration"].text() : "directional";
    if (kind == "directional") return {};
    if (kind != "spherical" && kind != "lights3d")
        fail("{}: {} '{}' is none of directional, spherical, lights3d", dome.file(),
             dome["lightConfiguration"].path(), kind);
    std::vector<glm::dvec3> positions;
    if (kind == "lights3d") positions = vectors_in(dome, "positions3d");
    if (positions.empty()) positions = vectors_in(dome, "positionsSphere");
    if (positions.empty()) positions = vectors_in(dome, "positions");
    const double radius = length_in(dome, "domeDiameter") / 2;
    if (positions.empty() && radius > 0)
        for (const glm::dvec3& d : directions)
            positions.push_back(glm::normalize(d) * radius +
                                glm::dvec3(0, 0, length_in(dome, "verticalOffset")));
    return positions;
}

}  // namespace

DomeFile dome_in(const JsonField& dome) {
    DomeFile result;
    const std::vector<glm::dvec3> directions = vectors_in(dome, "directions");
    const std::vector<glm::dvec3> positions = positions_in(dome, directions);
    if (!directions.empty() && !positions.empty() && directions.size() != positions.size())
        fail("{}: {} has {} directions, but {} positions", dome.file(),
             dome.path().empty() ? "the dome" : dome.path(), directions.size(), positions.size());
    const double width_mm = length_in(dome, "imageWidth");
    if (width_mm > 0) result.picture_width_mm = width_mm;
    if (!positions.empty() && !result.picture_width_mm)
        result.warnings.push_back(fmt::format(
            "{}: its lights have positions, but the width of the photographs in mm (imageWidth) is not "
            "given; only their directions are used",
            dome.file()));
    for (const glm::dvec3& p : positions)
        result.lights.push_back(result.picture_width_mm && p.z > 0 ? near_light(Vec3(p))
                                                                   : distant_light(Vec3(glm::normalize(p))));
    if (positions.empty())
        for (const glm::dvec3& d : directions)
            result.lights.push_back(distant_light(Vec3(glm::normalize(d))));
    return result;
}

DomeFile parse_dome(const std::string& text, const std::string& file_name) {
    const nlohmann::json root = json_in(text, file_name);
    if (!root.is_object()) fail("{}: is no dome; expected a JSON object with directions", file_name);
    DomeFile dome = dome_in(JsonField(file_name, root));
    if (dome.lights.empty())
        fail("{}: holds no lights; expected directions, positionsSphere or positions3d", file_name);
    return dome;
}

bool looks_like_dome(const std::string& text) {
    const nlohmann::json root = json_or_discarded(text);
    return root.is_object() &&
           (root.contains("directions") || root.contains("positionsSphere") || root.contains("positions3d"));
}

DomeFile read_dome_file(const fs::path& path) {
    if (!fs::exists(path)) fail("{}: no such lights file", path.string());
    return parse_dome(read_text_file(path), path.string());
}

}  // namespace tangi
