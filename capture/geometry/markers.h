// markers.h: ArUco markers in a picture, and the plane that they lie in.
#pragma once

#include <optional>

#include "capture/geometry/scale.h"

namespace tangi {

struct Marker {
    int id = 0;
    Corners corners_px;  // clockwise in the picture from the marker's own top left
};

struct MarkerSearch {
    std::string dictionary;  // "4x4_50"; empty where there are no markers
    std::vector<Marker> markers;
    std::vector<std::string> warnings{};
};

// The names of the dictionaries: "4x4_50" to "7x7_1000", "aruco_original", "apriltag_16h5" to
// "apriltag_36h11".
std::vector<std::string> marker_dictionaries();

// Finds markers of a dictionary, or of the one of all that explains most, the smallest such one, where none
// is given; corners are refined to a fraction of a pixel. None is no error. Throws Error for a name that is
// no dictionary's.
MarkerSearch find_markers(const Image<Rgb>& linear, const std::optional<std::string>& dictionary = {});

// Of the last of several photographs of one place: the markers that an earlier one shows as well, to half of
// their sides.
MarkerSearch seen_twice(const std::vector<MarkerSearch>& photographs);

// The plane of markers that are squares of one size, flat on it, anywhere and turned anyhow.
struct MarkerPlane {
    Homography plane_to_picture{1};  // mm to pixels; y up. The origin and turn are those of the first marker
    Scale scale;                     // at the middle of all markers
    double residual_px = 0;          // rms of the corners, each coordinate
};

// One homography and a place and turn for each marker, by least squares of the corners (Levenberg-Marquardt).
// With one marker its tilt is told by its own four corners, which is not much: several, far apart, are better
// by far. Throws Error: no marker, a side that is not positive.
MarkerPlane marker_plane(const std::vector<Marker>& markers, double side_mm);

// [mm] width and height of what has these corners, by the plane: the means of opposite sides.
glm::dvec2 size_on_plane(const MarkerPlane& plane, const Corners& corners_px);

}  // namespace tangi
