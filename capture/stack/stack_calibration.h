// stack_calibration.h: what lights files and capture files say of a stack of photographs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/formats/capture_file.h"
#include "capture/photo/rejected_photo.h"
#include "capture/stack/stack.h"

namespace tangi {

// How the axes of a lights file point, where not x right, y up: many programs have y downwards.
struct LightAxes {
    bool exchanged = false;               // first, x for y and y for x
    bool flip_x = false, flip_y = false;  // then, the signs of what has become x and y
    double rotation_deg = 0;              // then, counter-clockwise as the camera sees it
    bool are_reordered() const { return exchanged || flip_x || flip_y; }
    bool differ() const { return are_reordered() || rotation_deg != 0; }

    Vec3 applied(Vec3 listed) const;
};

// The axes that "x,-y,z" or "y,x,z" says: x and y in any order, each with a sign. Nothing where it says none.
std::optional<LightAxes> light_axes_of(std::string_view text);

// "x,-y,z": order and signs of axes, but for their rotation.
std::string in_words(const LightAxes& axes);

// What the files of a stack tell, before it is known which photographs there are.
struct StackCalibration {
    std::vector<Light> lights;  // in the order of their file
    // [deg] Standard error of each direction, 0 where not known; empty where none is.
    std::vector<double> direction_sigma_deg{};
    std::filesystem::path lights_path;
    // All but directions: a capture file's, or a .dome's or .relight's, which have no size (0) until
    // apply_geometry() gives them that of the photographs.
    std::optional<CaptureFile> capture{};
    std::filesystem::path capture_path{};
    std::optional<double> picture_width_mm{};  // of a .dome or .relight
    std::vector<std::string> warnings{};
    std::vector<std::string> poor{};  // what calibrate called poor of the capture files that these are of
    std::vector<RejectedPhoto> rejected{};  // lines of an .lp that are no light, told in the warnings too
};

// The files that `options` name; else the one lights file of the folder. Throws Error naming file and place.
StackCalibration read_stack_calibration(const std::filesystem::path& folder, const StackOptions& options,
                                        const LightAxes& axes = {});

// Makes the stack the picture that the capture file describes. Throws Error where it was made from
// photographs of another size.
void apply_geometry(Stack& stack, StackCalibration& calibration);

// Puts lights, their errors, camera, scale and colours into the stack, its crop being known.
void apply_calibration(Stack& stack, const StackCalibration& calibration);

// Names for a message: the first few, and how many more.
std::string joined(const std::vector<std::string>& names, std::size_t most = 5);

}  // namespace tangi
