// picture_geometry.h: the picture that a stack is read as, where that is not the photographs as they are:
// without the lens's distortion, and with the painting's plane upright.
//
//   place in the photograph = lens(rectification(registration(pixel)))
//
// Pixels: x right, y down, the centre of the top left pixel is (0, 0).
#pragma once

#include <glm/mat3x3.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "capture/formats/lens_file.h"
#include "surface/image/homography.h"

namespace tangi {

struct PictureGeometry {
    int photo_width = 0, photo_height = 0;  // [px] of the photographs
    int width = 0, height = 0;              // [px] of the whole picture
    std::optional<Lens> lens{};             // for photographs of this size
    // Pixel of the picture -> pixel of the photograph without distortion; the same where empty.
    std::optional<Homography> rectification{};
    std::optional<double> mm_per_pixel{};  // of the picture, where the rectification knows
    // Turns vectors of the photographs' frame (the camera looks along -z) into those of the picture's (the
    // painting's plane is z = 0).
    glm::dmat3 turn{1};
    std::optional<glm::dvec3> camera_mm{};  // in the picture's frame, its origin at the picture's centre

    // Of a pixel of the picture, which need not lie in it or be whole.
    glm::dvec2 place_in_photo(const glm::dvec2& pixel) const;
    // Of a place in a photograph; the reverse, to 1e-6 pixels or so where the lens allows.
    glm::dvec2 place_in_picture(const glm::dvec2& photo_px) const;
};

// For capture.json: see docs/reference/capture-json.md. Reading throws Error, or nlohmann's exceptions, where
// the JSON is not one.
nlohmann::json to_json(const PictureGeometry& geometry);
PictureGeometry geometry_from_json(const nlohmann::json& json);

}  // namespace tangi
