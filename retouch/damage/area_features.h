// area_features.h: what tells a damaged area from its surroundings, at each place and across an area's rim;
// for sources of this module only.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// Maps of one size, CV_32F, means of blocks of pixels.
enum class Cue : std::size_t {
    height,     // [mm]
    lightness,  // CIELAB
    a,
    b,
    red,  // ln rho_d
    green,
    blue,
    roughness,  // ln alpha
    specular,   // ln rho_s
    texture,    // ln of the rms slope about its local mean
    wear  // ln of the rms contrast of colour [CIELAB] over the rms relief [mm], both of what is as fine as
          // a weave: where paint was rubbed off its ground, colours change though the surface is level
};
inline constexpr std::size_t kCues = 11;

struct AreaFeatures {
    std::array<cv::Mat, kCues> maps;
    cv::Mat measured;       // CV_8U, 255 where most of the block was
    int block = 1;          // [pixels] along a side
    cv::Mat gloss_range;    // CV_32F [1], of ln alpha and ln rho_s within 3 x 3 blocks, both together
    float gloss_noise = 0;  // [1] by which gloss varies there in one paint

    const cv::Mat& of(Cue cue) const { return maps[static_cast<std::size_t>(cue)]; }
};
// Blocks as large as needed for at most `most_px` of them along the longer side. `wear` is told by squares of
// at most some threads' width, however large the blocks are, where the surface's scale is known.
AreaFeatures area_features_of(const Surface& surface, double unit_mm, int most_px, const Progress& progress);

// [1] How likely a difference of gloss (both logarithms together) is within one paint: 1 where there is none.
float within_paint(const AreaFeatures& features, float gloss_step);

// How a cue changes from outside of an area's rim to inside.
struct RimStep {
    double step = 0;     // the median, inside minus outside
    double agree = 0;    // [1] part of the rim where it has that sign, and at least a third of that size
    double usual = 0;    // robust spread of the same differences that lie wholly outside, as far apart
    double spread = 0;   // robust spread of the steps
    double variety = 1;  // [1] robust spread along the rim, inside over outside
};
struct Rim {
    std::array<RimStep, kCues> cues;
    double seen = 0;  // [1] part of the rim that is compared
    int points = 0;   // of it; where there are too few of them, the cues are 0

    const RimStep& of(Cue cue) const { return cues[static_cast<std::size_t>(cue)]; }
};

// A connected area and what is around it.
struct Area {
    cv::Rect box;    // [blocks] with a margin
    cv::Mat inside;  // CV_8U, of the box: 255 in the area
    int blocks = 0;
};
// Measured places are compared that lie `away` blocks from the rim on both sides; all of them, or those only
// between which one and the same paint goes on.
enum class Compared { all, within_paint };
Rim rim_of(const AreaFeatures& features, const Area& area, int away, Compared which = Compared::all);

// Connected areas where `evidence` is above one of `thresholds`, without crumbs and holes; of `least` blocks,
// and of at most the part `most` of all.
std::vector<Area> areas_above(const cv::Mat& evidence, const std::vector<double>& thresholds, int least,
                              double most);

// Wider by `blocks` all round.
Area grown(const Area& area, int blocks, const cv::Size& picture);

constexpr int kSide_px = 640;  // areas are looked for in a copy of this size at most

// How sure an area is, and by what.
struct Judged {
    double confidence = 0;
    std::string cues;
};

}  // namespace tangi
