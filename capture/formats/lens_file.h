// lens_file.h: a lens as OpenCV calibrates it, read from its file; and pictures without its distortion.
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

// The pinhole camera with radial and tangential distortion of OpenCV (Brown 1971; docs of calib3d).
struct Lens {
    int width = 0, height = 0;  // [px] of the pictures it was calibrated with
    glm::dvec2 focal_px{0, 0}, principal_px{0, 0};
    std::vector<double> distortion{};  // k1, k2, p1, p2 [, k3 [, k4, k5, k6 [, s1 ... s4 [, tx, ty]]]]
};

// Reads .yml, .yaml or .xml with camera_matrix (3 x 3), distortion_coefficients (4, 5, 8, 12 or 14 numbers),
// image_width and image_height, as OpenCV's calibration program writes them. Throws Error naming the file and
// what is missing or wrong in it.
Lens read_lens(const std::filesystem::path& path);

// The lens for photographs that are the calibrated ones enlarged or reduced; Error for another shape.
Lens lens_for(const Lens& lens, int width, int height);

// For each pixel of the undistorted picture, the pixel of the photograph that is seen there; of the same
// size, with the same camera matrix. Photographs that are the calibrated ones enlarged or reduced are allowed
// for; Error for another shape.
Image<glm::vec2> undistortion_map(const Lens& lens, int width, int height);

// The picture through such a map, bicubic; black where it has nothing.
Image<Rgb> through_map(const Image<Rgb>& picture, const Image<glm::vec2>& map);

// [px] Where a point of a photograph lies in the undistorted picture of that size, and the reverse. The lens
// is for photographs of that size.
glm::dvec2 undistorted(const Lens& lens, const glm::dvec2& place_px);
glm::dvec2 distorted(const Lens& lens, const glm::dvec2& place_px);

}  // namespace tangi
