// sphere_geometry.h: spheres as a camera sees them, and where the light that a mirror sphere reflects comes
// from.
//
// Camera frame: x right, y up, z towards the camera, which is at the origin in perspective. Pixels: x right,
// y down, the centre of the top left pixel is (0, 0).
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace tangi {

// A number and its standard error.
struct Known {
    double value = 0, sigma = 0;
};

// An ideal camera. Orthographic (far away, with a long lens) where the focal length is not known.
struct SphereCamera {
    std::optional<double> focal_px{};
    glm::dvec2 principal_px{0, 0};

    // [unit vector] from the camera to what is seen at a pixel.
    glm::dvec3 ray(const glm::dvec2& pixel) const;
};

// A sphere in a picture: where its centre is seen, and its radius as it would be seen edge-on at the depth of
// its centre, focal length * radius / depth. Without perspective that is the circle of its outline; with it,
// the outline is an ellipse that is a little larger and lies a little farther out.
struct SphereImage {
    glm::dvec2 centre_px{0, 0};
    double radius_px = 0;
    double centre_sigma_px = 0;  // standard errors, each coordinate
    double radius_sigma_px = 0;
};

// The sphere's centre in the camera frame in units in which its radius is radius_px (z = 0 without
// perspective). Times radius_mm / radius_px it is in mm.
glm::dvec3 centre_in_radius_units(const SphereImage& sphere, const SphereCamera& camera);

// [px] How far a pixel lies outside the sphere's outline, along the radius; < 0 inside. To first order.
double outside_px(const SphereImage& sphere, const SphereCamera& camera, const glm::dvec2& pixel);

// The outline's point in the direction (cos angle, -sin angle) of the picture from the centre.
glm::dvec2 outline_point(const SphereImage& sphere, const SphereCamera& camera, double angle);

// What is seen of the sphere at a pixel.
struct SpherePoint {
    glm::dvec3 position{
        0};  // from the sphere's centre is radius_px * normal; units as centre_in_radius_units()
    glm::dvec3 normal{0, 0, 1};  // [unit vector]
    glm::dvec3 view{0, 0, 1};    // [unit vector] to the camera
    glm::dvec3 mirrored() const {
        return 2 * glm::dot(normal, view) * normal - view;
    }  // to what is reflected there
};

std::optional<SpherePoint> sphere_point(const SphereImage& sphere, const SphereCamera& camera,
                                        const glm::dvec2& pixel);

// Where the sphere's surface with this normal is seen; nothing where it faces away.
std::optional<glm::dvec2> pixel_of_normal(const SphereImage& sphere, const SphereCamera& camera,
                                          const glm::dvec3& normal);

// Where the highlight of a distant light is seen; nothing where the light is right behind the sphere.
std::optional<glm::dvec2> highlight_of_direction(const SphereImage& sphere, const SphereCamera& camera,
                                                 const glm::dvec3& direction);

// That of a near light at `light`, in the units of centre_in_radius_units().
std::optional<glm::dvec2> highlight_of_position(const SphereImage& sphere, const SphereCamera& camera,
                                                const glm::dvec3& light);

// [rad] Standard error of sphere_point().mirrored() for a highlight known to highlight_sigma_px: root mean
// square of both angles. By differences of the above, with the errors of the sphere.
double direction_sigma(const SphereImage& sphere, const SphereCamera& camera, const glm::dvec2& highlight,
                       double highlight_sigma_px);

}  // namespace tangi
