// scale.h: millimetres per pixel, and the map from pictures to the painting's plane.
//
// Pixels: x right, y down, the centre of the top left pixel is (0, 0). The plane: x right, y up, z towards
// the camera, millimetres. In perspective the scale differs from place to place: it is told where it was
// measured.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surface/image/homography.h"
#include "surface/image/image.h"

namespace tangi {

struct Scale {
    double mm_per_pixel = 0;
    double sigma = 0;           // standard error of it
    glm::dvec2 place_px{0, 0};  // where it holds
    std::string method;         // "scale bar", "ppi", "corners", "markers", "chart", "painting"
    std::vector<std::string> warnings{};
};

// Errors of the points are those of each coordinate. All throw Error for lengths that are not positive,
// points too near to each other, and corners that make no convex quadrilateral.
Scale scale_from_bar(const glm::dvec2& first_px, const glm::dvec2& last_px, double length_mm,
                     double point_sigma_px = 0.5);

// Of pictures that were scanned; the number is taken to be rounded to whole ones.
Scale scale_from_ppi(double pixels_per_inch);

// The scale at the middle of a rectangle of known size, such as the painting. Its standard error includes how
// much the two sides disagree, beyond what perspective can do; a warning says so where they were likely
// swapped.
Scale scale_from_corners(const Corners& corners_px, double width_mm, double height_mm,
                         double point_sigma_px = 1);

// The scale at `place_px` of a map from a plane in mm (either handedness) to pixels: the square root of the
// ratio of areas.
double mm_per_pixel_at(const Homography& plane_to_picture, const glm::dvec2& place_px);

// The scale of the plane from that of something that lies `height_mm` above it, parallel to it, seen by a
// camera `camera_distance_mm` above the plane: what is higher looks larger (similar triangles).
Scale at_plane(const Scale& measured, double height_mm, double camera_distance_mm);

// From a picture to an upright one of the painting alone.
struct Rectification {
    double width_mm = 0, height_mm = 0;
    double mm_per_pixel = 0;
    int width = 0, height = 0;          // [px] of the output
    Homography picture_to_plane_mm{1};  // origin at the painting's centre, y up
    Homography output_to_picture{1};    // pixels both
    std::vector<std::string> warnings{};
};

// `mm_per_pixel` of 0 keeps the picture's own where it is finest, so that nothing is lost. Throws Error:
// sizes that are not positive, corners crossed, anticlockwise or on a line, or an output of more than 65535
// pixels a side.
Rectification rectification(const Corners& corners_px, double width_mm, double height_mm,
                            double mm_per_pixel = 0);

// The picture through it, bicubic, averaged where it shrinks; what lies outside the picture is black.
Image<Rgb> rectified(const Image<Rgb>& picture, const Rectification& r);

nlohmann::json to_json(const Scale& scale);
nlohmann::json to_json(const Rectification& r);

}  // namespace tangi
