#include "fit/mosaic/mosaic_seams.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/stitching/detail/seam_finders.hpp>

#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr float kLogFloor = 1e-4f;  // [1] of rho_d and rho_s, whose logarithms are taken
// [cells] What is finer is detail: a cell's mean depends on which pixels fall into it, more so in small ones.
constexpr double kLowSigma = 3;
constexpr float kLeastKnown = 1e-3f;  // [1] of the weights of what is known
constexpr double kFeather = 1;        // [cells] standard deviation of a seam
// Pictures that seams are sought in, 0..255 as the finder's own penalties have it: rho_d as sRGB nearly, and
// slopes of this many degrees of tilt over the whole of it.
constexpr float kFull = 255;
constexpr double kSlopeRange = 0.5;  // [1]

// Maps of a cell on the wall's scale.
struct LevelCell {
    glm::dvec2 slope{0};
    Rgb ln_diffuse{0};
    double ln_specular = 0, ln_alpha = 0;
};

LevelCell level_cell(const CellMaps& maps, const PositionScale& scale, int x, int y) {
    const auto ln = [](float value) { return std::log(std::max(value, kLogFloor)); };
    const Rgb diffuse = maps.diffuse(x, y) * scale.diffuse;
    return {slope_on_wall(scale, maps.slope(x, y)),
            {ln(diffuse.r), ln(diffuse.g), ln(diffuse.b)},
            ln(maps.specular(x, y) * scale.specular),
            maps.ln_alpha(x, y) + std::log(scale.roughness)};
}

// Sums of all positions by their distance from the rim.
struct CellSum {
    LevelCell sum;
    double weight = 0;
};

Image<CellSum> means_of_all(const CellGrid& grid, const std::vector<CellMaps>& maps,
                            const MosaicScales& scales) {
    Image<CellSum> all(grid.columns, grid.rows);
    for (std::size_t i = 0; i < maps.size(); ++i)
        for (int y = maps[i].cells.y0; y < maps[i].cells.y1; ++y)
            for (int x = maps[i].cells.x0; x < maps[i].cells.x1; ++x) {
                if (!maps[i].covers(x, y)) continue;
                const int u = x - maps[i].cells.x0, v = y - maps[i].cells.y0;
                const LevelCell cell = level_cell(maps[i], scales.positions[i], u, v);
                const double weight = static_cast<double>(maps[i].distance(u, v));
                CellSum& sum = all(x, y);
                sum.weight += weight;
                sum.sum.slope += weight * cell.slope;
                sum.sum.ln_diffuse += static_cast<float>(weight) * cell.ln_diffuse;
                sum.sum.ln_specular += weight * cell.ln_specular;
                sum.sum.ln_alpha += weight * cell.ln_alpha;
            }
    return all;
}

// Smooths what is known (normalised convolution: Knutsson & Westin 1993), which also continues it a little.
void smooth(Image<LowBand>& low, Image<float>& known) {
    constexpr int kNumbers = sizeof(LowBand) / sizeof(float);
    static_assert(kNumbers == 7 && sizeof(LowBand) == 7 * sizeof(float));
    cv::Mat numbers(low.height(), low.width(), CV_32FC(kNumbers), low.data());
    const cv::Mat weights = view_of(known);
    cv::GaussianBlur(numbers, numbers, {}, kLowSigma, kLowSigma, cv::BORDER_CONSTANT);
    cv::GaussianBlur(weights, weights, {}, kLowSigma, kLowSigma, cv::BORDER_CONSTANT);
    for (std::size_t i = 0; i < low.size(); ++i) {
        const float weight = known.pixels()[i];
        if (!(weight > kLeastKnown)) continue;
        LowBand& b = low.pixels()[i];
        b = {b.slope / weight, b.ln_diffuse / weight, b.ln_specular / weight, b.ln_alpha / weight};
    }
}

Image<LowBand> low_band(const CellMaps& maps, const PositionScale& scale, const Image<CellSum>& all) {
    Image<LowBand> low(maps.cells.width(), maps.cells.height());
    Image<float> known(low.width(), low.height());
    for (int v = 0; v < low.height(); ++v)
        for (int u = 0; u < low.width(); ++u) {
            const int x = maps.cells.x0 + u, y = maps.cells.y0 + v;
            if (!maps.covers(x, y) || !(all(x, y).weight > 0)) continue;
            const LevelCell cell = level_cell(maps, scale, u, v);
            const CellSum& s = all(x, y);
            low(u, v) = {glm::vec2(s.sum.slope / s.weight - cell.slope),
                         s.sum.ln_diffuse / static_cast<float>(s.weight) - cell.ln_diffuse,
                         static_cast<float>(s.sum.ln_specular / s.weight - cell.ln_specular),
                         static_cast<float>(s.sum.ln_alpha / s.weight - cell.ln_alpha)};
            known(u, v) = 1;
        }
    smooth(low, known);
    return low;
}

// Brightness and slopes of a position, for the finder.
cv::Mat picture_of(const CellMaps& maps, const PositionScale& scale) {
    cv::Mat picture(maps.cells.height(), maps.cells.width(), CV_32FC3);
    const auto in_range = [](double value) {
        return kFull * static_cast<float>(std::clamp(value, 0.0, 1.0));
    };
    for (int y = 0; y < picture.rows; ++y)
        for (int x = 0; x < picture.cols; ++x) {
            const glm::dvec2 slope = slope_on_wall(scale, maps.slope(x, y));
            const double bright = static_cast<double>(luminance(maps.diffuse(x, y) * scale.diffuse));
            picture.at<cv::Vec3f>(y, x) = {in_range(std::pow(std::max(bright, 0.0), 1 / 2.2)),
                                           in_range(0.5 + slope.x / kSlopeRange),
                                           in_range(0.5 + slope.y / kSlopeRange)};
        }
    return picture;
}

// 255 where a position is the owner; empty of one that is not joined.
std::vector<cv::Mat> cut_masks(const MosaicLayout& layout, const std::vector<CellMaps>& maps,
                               const MosaicScales& scales) {
    std::vector<cv::UMat> pictures, masks;
    std::vector<cv::Point> corners;
    std::vector<std::size_t> joined;
    for (std::size_t i = 0; i < maps.size(); ++i) {
        if (!layout.positions[i].joined) continue;
        cv::Mat mask(maps[i].cells.height(), maps[i].cells.width(), CV_8U, cv::Scalar(0));
        for (int y = 0; y < mask.rows; ++y)
            for (int x = 0; x < mask.cols; ++x)
                if (maps[i].covers(maps[i].cells.x0 + x, maps[i].cells.y0 + y)) mask.at<uchar>(y, x) = 255;
        picture_of(maps[i], scales.positions[i]).copyTo(pictures.emplace_back());
        mask.copyTo(masks.emplace_back());
        corners.emplace_back(maps[i].cells.x0, maps[i].cells.y0);
        joined.push_back(i);
    }
    cv::detail::GraphCutSeamFinder(cv::detail::GraphCutSeamFinderBase::COST_COLOR)
        .find(pictures, corners, masks);
    std::vector<cv::Mat> all(maps.size());
    for (std::size_t k = 0; k < joined.size(); ++k) masks[k].copyTo(all[joined[k]]);
    return all;
}

}  // namespace

MosaicSeams find_seams(const CellGrid& grid, const MosaicLayout& layout, const std::vector<CellMaps>& maps,
                       const MosaicScales& scales) {
    MosaicSeams seams{Image<int>(grid.columns, grid.rows, -1), {}};
    const Image<CellSum> all = means_of_all(grid, maps, scales);
    const std::vector<cv::Mat> masks = cut_masks(layout, maps, scales);
    for (std::size_t i = 0; i < maps.size(); ++i) {
        const Region& cells = maps[i].cells;
        if (!layout.positions[i].joined) {
            seams.shares.push_back({cells, {}, {}});
            continue;
        }
        PositionShare share{cells, Image<float>(cells.width(), cells.height()),
                            low_band(maps[i], scales.positions[i], all)};
        const cv::Mat& mask = masks[i];
        cv::Mat part;
        for (int y = 0; y < mask.rows; ++y)
            for (int x = 0; x < mask.cols; ++x)
                if (mask.at<uchar>(y, x)) seams.owner(cells.x0 + x, cells.y0 + y) = static_cast<int>(i);
        mask.convertTo(part, CV_32F, 1.0 / 255);
        cv::GaussianBlur(part, view_of(share.weight), {}, kFeather, kFeather, cv::BORDER_REPLICATE);
        seams.shares.push_back(std::move(share));
    }
    return seams;
}

}  // namespace tangi
