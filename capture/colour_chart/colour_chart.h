// colour_chart.h: the classic colour chart of 24 patches in a photograph: where it is, and what its patches
// read.
//
// Chart coordinates: units of the patches' pitch, x along the rows from patch 1 to 6, y down; the chart is
// [0, 6] x [0, 4], and patch n has its centre at (column + 1/2, row + 1/2). Pixels: x right, y down, the
// centre of the top left pixel is (0, 0). Pictures are linear light; whose primaries they have does not
// matter.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/formats/chart_reference.h"
#include "capture/geometry/scale.h"
#include "surface/base/options.h"
#include "surface/image/homography.h"
#include "surface/image/image.h"

namespace tangi {

using ChartCorners = std::array<glm::dvec2, 4>;  // [px] in the order of chart_corners()

struct ChartOptions {
    double inner_part = 0.6;    // [1] of a patch's width, around its middle, that is read
    double clip_level = 0.998;  // [1] a pixel with a channel from here on is clipped
    double smallest_patch_px = 8;
    double worst_misfit = 0.1;  // [1] of the patches' colours, above which what was found is no chart

    static constexpr std::string_view name = "chart";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"inner_part", 0.1, 1, "1", "part of a patch's width that is read"}, self.inner_part);
        visit(FieldInfo{"clip_level", 0.1, 1e6, "1", "value from which on a pixel is clipped"},
              self.clip_level);
        visit(FieldInfo{"smallest_patch_px", 4, 1000, "px", "width of the smallest patch that is looked for"},
              self.smallest_patch_px);
        visit(FieldInfo{"worst_misfit", 0.01, 1, "1", "misfit of colours above which it is no chart"},
              self.worst_misfit);
    }
};

struct FoundChart {
    Homography chart_to_picture{1};  // [px] of chart coordinates
    int patches_seen = 0;            // that were seen as such; 0: the corners were given
    double grid_residual_px = 0;     // rms distance of their middles from the grid
    double misfit = 0;               // [1] median misfit of the colours, in cube roots of reflectance
    std::vector<std::string> warnings{};

    glm::dvec2 centre_px() const { return mapped(chart_to_picture, {3, 2}); }
};

// The outer corners of patches 1, 6, 24 and 19: top left, top right, bottom right, bottom left of the upright
// chart, which are what people point at.
ChartCorners chart_corners(const FoundChart& chart);

// The scale at the chart's middle, from the pitch of its patches (the maker's, or measured), which need not
// be the same both ways.
Scale scale_from_chart(const FoundChart& chart, const glm::dvec2& pitch_mm);

// Looks for the chart, turned and tilted as it may be, but not mirrored, by its grid of flat patches and then
// by the order of their colours up to any 3x3 matrix, so that neither white balance nor camera matter.
// Nothing where there is none. With several, takes the one whose colours fit best, and a warning says where
// the others are.
std::optional<FoundChart> find_chart(const Image<Rgb>& linear, const ChartOptions& options = {});

// The chart with these outer corners, given in order around it, beginning anywhere: which is which, the
// colours tell. Throws Error: corners outside the picture, crossed, going round the wrong way, or nearly on a
// line. A warning says so where the colours look like no chart.
FoundChart chart_at(const Image<Rgb>& linear, const ChartCorners& corners_px,
                    const ChartOptions& options = {});

enum class PatchState { good, clipped, uneven, outside };
const char* name_of(PatchState state);

// What one patch reads.
struct PatchReading {
    Rgb mean{0};   // linear, camera's primaries; robust
    Rgb sigma{0};  // standard error of it, from the scatter of the pixels
    int pixels = 0;
    PatchState state = PatchState::outside;
};

struct ChartReading {
    std::string photo;  // its name, for messages
    std::array<PatchReading, kChartPatches> patches;
    std::vector<std::string> warnings{};

    int good() const;
};

// Reads the inner part of each patch. Patches of which more than 2 % of the pixels are clipped, which a
// shadow's edge or a highlight crosses, or which are not wholly in the picture are marked, and a warning
// names them. Shadows that cover a patch altogether are for correct_colours() to find.
ChartReading read_chart(const Image<Rgb>& linear, const FoundChart& chart, const std::string& photo = {},
                        const ChartOptions& options = {});

}  // namespace tangi
