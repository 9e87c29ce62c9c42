// positions.h: a procedural painting that is photographed in overlapping parts, as a wall is that no one
// picture holds, with the truth about each part.
//
// The camera stands before each part in turn and takes its lights with it. It is never quite where it should
// be, never quite square to the painting, and never exposes quite alike.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/generator.h"

namespace tangi {

struct PositionsOptions {
    int columns = 3, rows = 2;
    double overlap = 0.3;             // [1] of a picture's side that its neighbour has, too
    double position_shift = 0.01;     // [picture widths] rms of the camera's place, in x and y each
    double position_roll_deg = 0.5;   // [deg] rms, about the camera's axis
    double position_tilt_deg = 0.5;   // [deg] rms, about the picture's x and y each
    double position_zoom = 0.003;     // [1] rms, relative
    double position_exposure = 0.05;  // [1] rms, relative, of all photographs of a position alike
    double camera_distance = 4;       // [picture widths] by which perspective shows that the camera is tilted
    bool whole_truth = true;          // the truth about the whole painting, too

    static constexpr std::string_view name = "positions";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"columns", 1, 100, "1", "positions side by side"}, self.columns);
        visit(FieldInfo{"rows", 1, 100, "1", "positions above each other"}, self.rows);
        visit(FieldInfo{"overlap", 0, 0.9, "1", "part of a picture that its neighbour has, too"},
              self.overlap);
        visit(FieldInfo{"position_shift", 0, 0.1, "picture widths",
                        "how far the camera is from its place, rms"},
              self.position_shift);
        visit(
            FieldInfo{"position_roll_deg", 0, 10, "deg", "how far the camera is turned about its axis, rms"},
            self.position_roll_deg);
        visit(FieldInfo{"position_tilt_deg", 0, 10, "deg", "how far the camera looks aside, rms"},
              self.position_tilt_deg);
        visit(FieldInfo{"position_zoom", 0, 0.1, "1", "how much sizes differ between positions, rms"},
              self.position_zoom);
        visit(FieldInfo{"position_exposure", 0, 0.5, "1", "how much exposures differ between positions, rms"},
              self.position_exposure);
        visit(FieldInfo{"camera_distance", 0.5, 1000, "picture widths", "of the camera from the painting"},
              self.camera_distance);
        visit(FieldInfo{"whole_truth", 0, 1, "", "write the truth about the whole painting, too"},
              self.whole_truth);
    }
};

// One place of the camera.
struct CameraPosition {
    std::string name;  // "r1_c2": second row from the top, third column
    int column = 0, row = 0;
    PaintingView view;
    Homography to_painting{1};  // pixel of its pictures -> pixel of the whole painting
    double exposure = 1;        // [1] of its photographs
};

// The positions, row by row from the upper left. Their pictures lie within the painting, however far the
// camera is off; what it is off by follows the painting's seed, at most 2.5 times the rms. Throws Error where
// options contradict each other.
std::vector<CameraPosition> camera_positions(const PaintingOptions& painting,
                                             const PositionsOptions& options);

// A stack for each position in a folder of its name (write_stack()), each with its truth, and
//   positions.json   of each position the place, the homography, rotation, exposure
//   gt/              the truth about the whole painting, as of a stack
// Returns what positions.json says. Errors as of write_stack().
nlohmann::json write_positions(const std::filesystem::path& folder, const PaintingOptions& painting,
                               const PositionsOptions& options, const GeneratorOptions& photos,
                               const Progress& progress = {});

}  // namespace tangi
