// sphere_pictures.h: photographs of spheres on a table, rendered for the tests with known lights.
#pragma once

#include <functional>
#include <optional>

#include "capture/sphere_lights/sphere_calibration.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {

struct SphereScene {
    int width = 300, height = 220;
    SphereCamera camera{{}, {149.5, 109.5}};
    std::vector<SphereImage> spheres = {{{140.3, 105.7}, 40, 0, 0}};
    bool matt = false;
    double lobe_rad = 0.035;  // roughness of the mirror
    double strength = 12;     // of the highlight's middle; 1 is clipped
    double noise = 0.002;
    Transfer transfer{};
    glm::dvec2 shift_px{0, 0};   // of the camera
    std::optional<Lens> lens{};  // the spheres are where an ideal camera would see them
    std::uint64_t seed = 1;

    // The picture under a distant light, or a near one (camera frame, in the units of
    // centre_in_radius_units()).
    Image<float> picture(const glm::dvec3& light, bool near = false) const {
        Image<float> image(width, height);
        Random random(seed + static_cast<std::uint64_t>(std::abs(light.x * 1e6)));
        const double toward = near ? 0.7 : glm::normalize(light).z;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                // Inside one pixel the distortion is a shift.
                const glm::dvec2 middle(x, y),
                    bent = lens ? undistorted(*lens, middle) - middle : glm::dvec2(0);
                double sum = 0;
                for (int s = 0; s < 16; ++s) {
                    const int column = s % 4, row = s / 4;
                    const glm::dvec2 at(x + (column - 1.5) / 4, y + (row - 1.5) / 4);
                    sum += std::min(1.0, value(at + bent - shift_px, light, near, toward)) / 16;
                }
                sum = std::clamp(sum + noise * random.normal(), 0.0, 1.0);
                image(x, y) = transfer.encode(static_cast<float>(sum));
            }
        return image;
    }

private:
    double value(const glm::dvec2& at, const glm::dvec3& light, bool near, double toward) const {
        for (const SphereImage& sphere : spheres) {
            const auto point = sphere_point(sphere, camera, at);
            if (!point) continue;
            const glm::dvec3 to_light = glm::normalize(near ? light - point->position : light);
            if (matt) return 0.6 * std::max(0.0, glm::dot(point->normal, to_light));
            const double cosine =
                std::max(glm::dot(point->normal, glm::normalize(to_light + point->view)), 1e-3);
            const double tangent = std::sqrt(1 / (cosine * cosine) - 1) / lobe_rad;
            return 0.02 + strength / std::pow(1 + tangent * tangent, 2);
        }
        // A table with a pattern, so that there is something to register by.
        const double tile = std::fmod(std::floor(at.x / 23) + std::floor(at.y / 19) + 100, 2.0);
        return (0.12 + 0.1 * tile) * std::max(toward, 0.1);
    }
};

// Directions to distant lights within `cone_deg` of the camera, all around.
inline std::vector<glm::dvec3> lights_around(int count, double cone_deg = 55) {
    std::vector<glm::dvec3> lights;
    for (int i = 0; i < count; ++i) {
        const double angle = 2.4 * i, tilt = cone_deg * std::numbers::pi / 180 * std::sqrt((i + 0.5) / count);
        lights.emplace_back(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle),
                            std::cos(tilt));
    }
    return lights;
}

inline std::string sphere_photo_name(int number) { return fmt::format("sphere_{:02}.png", number); }

// Writes the scene under each light and returns the paths; `change` may change the scene for a photograph, or
// paint into its picture.
using ChangeScene = std::function<void(int photo, SphereScene&)>;
using ChangePicture = std::function<void(int photo, Image<float>&)>;
inline std::vector<std::filesystem::path> write_sphere_photos(
    const std::filesystem::path& folder, const SphereScene& scene, const std::vector<glm::dvec3>& lights,
    bool near = false, const ChangeScene& change = {}, const ChangePicture& paint = {}) {
    std::vector<std::filesystem::path> paths;
    for (int i = 0; i < static_cast<int>(lights.size()); ++i) {
        SphereScene changed = scene;
        if (change) change(i, changed);
        Image<float> picture = changed.picture(lights[static_cast<std::size_t>(i)], near);
        if (paint) paint(i, picture);
        paths.push_back(folder / sphere_photo_name(i));
        write_map(paths.back(), picture);
    }
    return paths;
}

inline double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

// Two spheres of 15 mm radius under near lights, 600 mm below a camera of 1000 pixels focal length.
struct NearScene {
    SphereScene scene;
    std::vector<glm::dvec3> lights_mm,
        in_radii;  // surface frame; camera frame in the unit of a sphere's radius in pixels

    NearScene() {
        scene.width = 420;
        scene.height = 260;
        scene.camera = {1000.0, {209.5, 129.5}};
        const double radius_px = 1000 * 15 / 585.0;
        scene.spheres = {{{70.4, 60.2}, radius_px, 0, 0}, {{350.7, 200.9}, radius_px, 0, 0}};
        for (const glm::dvec3& direction : lights_around(8, 50)) {
            lights_mm.push_back(450.0 * direction);
            in_radii.push_back((lights_mm.back() - glm::dvec3(0, 0, 600)) * (radius_px / 15));
        }
    }
};

// A bright disc, painted over what is there.
inline void paint_spot(Image<float>& picture, double x, double y, double radius, float value = 1) {
    for (int py = 0; py < picture.height(); ++py)
        for (int px = 0; px < picture.width(); ++px)
            if (std::hypot(px - x, py - y) < radius) picture(px, py) = value;
}

// A gentle relief all over the picture, as a light in this direction shades it.
inline void paint_relief(Image<float>& picture, const glm::dvec3& light) {
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const glm::dvec2 slope =
                0.25 * glm::dvec2(std::sin(0.31 * x + 0.11 * y), std::cos(0.23 * y - 0.07 * x));
            picture(x, y) *= static_cast<float>(
                std::max(0.1, 1 + glm::dot(slope, glm::dvec2(light)) / std::max(light.z, 0.2)));
        }
}

// Mean angle to lights that are known, in the order of the photographs; of those that have a light.
inline double mean_error_deg(const SphereCalibration& c, const std::vector<glm::dvec3>& truth) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (c.lights[i].direction) sum += degrees_between(*c.lights[i].direction, truth[i]) / c.calibrated();
    return sum;
}

// As --sphere X,Y,R.
inline GivenSphere circle(double x, double y, double r) {
    return {{x, y}, r, false, fmt::format("{},{},{}", x, y, r)};
}

}  // namespace tangi
