// sphere_calibration.h: the lights of a stack from the spheres in its photographs.
#pragma once

#include <nlohmann/json.hpp>

#include "capture/formats/lens_file.h"
#include "capture/sphere_lights/diffuse_sphere.h"
#include "capture/sphere_lights/light_position.h"
#include "capture/spheres/mirror_sphere.h"
#include "surface/maps/light.h"

namespace tangi {

// What the user knows. Lengths that are not given stay unknown: directions need none of them.
struct SphereCalibrationOptions {
    std::vector<GivenSphere> spheres{};        // sought automatically where empty
    bool matt = false;                         // a diffuse sphere instead of mirror spheres
    bool fixed_camera = false;                 // photographs are not registered; a motion is told, not undone
    std::optional<double> sphere_radius_mm{};  // of every sphere
    std::optional<double> mm_per_pixel{};      // of the painting, about: how large spheres are to be seen
    std::optional<double> focal_px{};          // orthographic where neither is given
    std::optional<double> focal_35mm{};  // [mm] equivalent of a 35-mm camera, by the diagonal (CIPA DCG-001)
    std::optional<glm::dvec2> principal_px{};  // the picture's centre where empty
    std::optional<glm::dvec2> origin_px{};  // where the painting's frame has its origin; the picture's centre
    std::optional<double> camera_distance_mm{};  // from the painting's plane z = 0
    std::optional<double>
        sphere_height_mm{};              // of a sphere's centre above that plane; its radius: it lies on it
    std::optional<Transfer> transfer{};  // for diffuse spheres
    std::optional<Lens> lens{};          // whose distortion is undone
};

struct CalibratedLight {
    std::filesystem::path path;
    std::string name;  // of the photograph
    std::optional<glm::dvec3>
        direction{};                 // [unit vector] surface frame, as seen from the origin; empty: left out
    double direction_sigma_deg = 0;  // standard error
    std::optional<glm::dvec3> position_mm{};  // surface frame
    glm::dvec3 position_sigma_mm{0};
    int spheres_used = 0;
    std::string reason{};  // why it is left out
};

struct SphereCalibration {
    int width = 0, height = 0;            // of the photographs
    std::vector<CalibratedLight> lights;  // one a photograph, in the order of the names
    std::vector<FoundSphere> spheres;
    std::vector<std::optional<glm::dvec3>> sphere_centres_mm;  // surface frame; empty without a known radius
    std::vector<std::optional<MattShading>> shadings;          // one a photograph, for a diffuse sphere
    std::optional<Transfer> matt_transfer{};
    CameraMotions drifts;
    SphereCamera camera;
    std::optional<double> sphere_radius_mm{};
    std::optional<glm::dvec3> camera_position_mm{};  // surface frame
    std::optional<double> mm_per_pixel{};            // at z = 0
    glm::dvec2 origin_px{0, 0};
    std::string method;  // "mirror sphere", "mirror spheres", "diffuse sphere", "none"
    double residual_px = 0, residual_sigma = 0;  // of the highlights, where positions were found
    std::vector<std::string> warnings, poor;

    int calibrated() const;
    std::vector<Light> usable_lights() const;  // with positions where there are
};

// [px] Radius that spheres must be seen with as the user's numbers say: focal length · radius / depth, or
// radius / (size of a pixel on the painting). Nothing where these are not all given. Photographs are
// width x height pixels.
std::optional<double> expected_radius_px(const SphereCalibrationOptions& options, int width, int height);

// What is known of the photographs where no sphere is in them: all lights are left out.
SphereCalibration without_spheres(const PhotoSet& photos, const SphereCalibrationOptions& options);

// Throws PhotoError, naming a photograph that shows something else than the others.
void require_same_subject(const PhotoSet& photos, const CameraMotions& drifts);

// Throws NoSphereError; as require_same_subject(); Error: no photographs, a damaged one, no light, options
// that contradict each other.
SphereCalibration calibrate_from_spheres(const PhotoSet& photos, const SphereCalibrationOptions& options,
                                         const Progress& progress = {});

// capture.json: see docs/reference/capture-json.md.
nlohmann::json to_json(const SphereCalibration& calibration);

}  // namespace tangi
