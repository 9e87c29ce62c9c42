#include "capture/formats/relight_file.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/formats/dome_file.h"
#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct ListedPhoto {
    std::string name;
    bool skip = false;
};

std::vector<ListedPhoto> listed_photos(const JsonField& project) {
    std::vector<ListedPhoto> photos;
    for (const JsonField& image : project["images"].list())
        photos.push_back({image["filename"].text(), image.has("skip") && image["skip"].truth()});
    if (photos.empty()) fail("{}: its list of images is empty", project.file());
    return photos;
}

// The direction that one sphere shows of each photograph; a zero vector where it shows none.
std::vector<glm::dvec3> directions_of(const JsonField& sphere) {
    std::vector<glm::dvec3> directions;
    if (!sphere.has("directions")) return directions;
    for (const JsonField& entry : sphere["directions"].list()) {
        const std::vector<JsonField> n = entry.list();
        glm::dvec3 d(0);
        if (n.size() == 3) d = {n[0].number(), n[1].number(), n[2].number()};
        if ((n.size() != 3 && !n.empty()) || !std::isfinite(glm::dot(d, d)))
            fail("{}: {} is not a direction of three numbers", sphere.file(), entry.path());
        const double length = glm::length(d);
        directions.push_back(length > 1e-6 ? d / length : glm::dvec3(0));
    }
    return directions;
}

// Empty where no sphere shows a light.
std::vector<std::optional<Light>> lights_of_spheres(const JsonField& project, std::size_t wanted) {
    std::vector<glm::dvec3> sums(wanted, glm::dvec3(0));
    bool any = false;
    if (project.has("spheres"))
        for (const JsonField& sphere : project["spheres"].list()) {
            const std::vector<glm::dvec3> directions = directions_of(sphere);
            if (directions.empty()) continue;
            if (directions.size() != wanted)
                fail("{}: {}.directions has {} lights for {} photographs", project.file(), sphere.path(),
                     directions.size(), wanted);
            for (std::size_t i = 0; i < wanted; ++i) sums[i] += directions[i];
            any = true;
        }
    std::vector<std::optional<Light>> lights;
    if (any)
        for (const glm::dvec3& sum : sums)
            lights.push_back(glm::length(sum) > 1e-6 ? std::optional(distant_light(Vec3(sum)))
                                                     : std::nullopt);
    return lights;
}

}  // namespace

RelightFile parse_relight(const std::string& text, const std::string& file_name) {
    const nlohmann::json root = json_in(text, file_name);
    const JsonField project(file_name, root);
    if (!project.has("images")) fail("{}: is no project of Relight; it has no list of images", file_name);
    const std::vector<ListedPhoto> photos = listed_photos(project);
    const auto kept = static_cast<std::size_t>(
        std::count_if(photos.begin(), photos.end(), [](const ListedPhoto& photo) { return !photo.skip; }));
    RelightFile result;
    std::vector<std::optional<Light>> lights;
    if (project.has("dome")) {
        DomeFile dome = dome_in(project["dome"]);
        lights.assign(dome.lights.begin(), dome.lights.end());
        result.picture_width_mm = dome.picture_width_mm;
        result.warnings = std::move(dome.warnings);
    }
    if (lights.empty()) lights = lights_of_spheres(project, kept);
    if (lights.empty())
        fail(
            "{}: holds no lights: neither its dome nor a sphere has directions. Find them in Relight, or "
            "with "
            "tangipaint calibrate",
            file_name);
    if (lights.size() != kept && lights.size() != photos.size())
        fail("{}: has {} lights for {} photographs ({} of them not skipped)", file_name, lights.size(),
             photos.size(), kept);
    if (project.has("pixelSize") && project["pixelSize"].number() > 0)
        result.mm_per_pixel = project["pixelSize"].number(1e-6, 1e3);
    std::string without;
    std::size_t next = 0;
    const bool skipped_too = lights.size() == photos.size();
    for (const ListedPhoto& photo : photos) {
        if (photo.skip && !skipped_too) continue;
        std::optional<Light>& light = lights[next++];
        if (photo.skip) continue;
        if (!light) {
            without += (without.empty() ? "" : ", ") + photo.name;
            continue;
        }
        light->name = photo.name;
        result.lights.push_back(*light);
    }
    if (result.lights.empty()) fail("{}: no photograph has a light", file_name);
    if (!without.empty())
        result.warnings.push_back(fmt::format("{}: has no light for {}; rejected", file_name, without));
    return result;
}

bool looks_like_relight(const std::string& text) {
    const nlohmann::json root = json_or_discarded(text);
    return root.is_object() && root.contains("images") && (root.contains("dome") || root.contains("spheres"));
}

RelightFile read_relight_file(const fs::path& path) {
    if (!fs::exists(path)) fail("{}: no such lights file", path.string());
    return parse_relight(read_text_file(path), path.string());
}

}  // namespace tangi
