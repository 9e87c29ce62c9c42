// capture_colour.h: how the photographs' channels relate to linear Rec. 709, as a colour chart in them told.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/formats/chart_reference.h"
#include "surface/image/colour.h"
#include "surface/image/homography.h"

namespace tangi {

// [1] Mean CIEDE2000 of a chart's patches from which on what was read is no chart, or in no light for it: far
// beyond what the loosest guidelines allow.
constexpr double kWorstChart = 10;

struct CaptureColour {
    // Linear Rec. 709 under the lights -> linear channels of the photographs, white balance
    // included. The luminance of white stays: to_camera (1, 1, 1) has 1 for green.
    glm::dmat3 to_camera{1};
    Transfer transfer;        // that the photographs were linearised by when the chart was read
    bool raw_rec709 = false;  // of camera raws, developed to Rec. 709 before; else as the sensor sees
    // What the photographs had been developed with: of "dark", "flat", "ambient", "brackets".
    std::vector<std::string> developed_with{};
    double delta_e_2000 = -1;  // [1] mean over patches, each by the matrix without it; negative: not known
    double misfit = 0;         // [1] mean CIEDE2000 of the patches by the matrix

    // Of photographs in which it was read, by name: ln of red and of blue against green, beside the white
    // balance of to_camera (white_balances.h).
    std::map<std::string, glm::dvec2> log_gains{};

    // Where the chart lies in the photographs (chart coordinates, colour_chart.h), and what its patches are.
    struct Chart {
        Homography to_photo{1};
        std::array<Rgb, kChartPatches> reference{};
    };
    std::optional<Chart> chart{};

    // What their light looks like to the camera: the colour of highlights.
    glm::dvec3 light() const { return to_camera * glm::dvec3(1); }
    // From channels that were divided by light() to linear Rec. 709. Keeps white.
    glm::dmat3 from_balanced() const {
        const glm::dvec3 white = light();
        return glm::inverse(to_camera) * glm::dmat3(white.r, 0, 0, 0, white.g, 0, 0, 0, white.b);
    }
};

}  // namespace tangi
