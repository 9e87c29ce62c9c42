// chart_finder.cpp: find_chart(): grids of flat patches that have the chart's colours in the chart's order.
#include <glm/matrix.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/colour_chart/chart_order.h"
#include "capture/colour_chart/patch_grid.h"
#include "surface/base/median.h"

namespace tangi {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

namespace {

constexpr int kLeastFlatPatches = 10;    // of 24 that must be seen as flat patches
constexpr int kLargestSought_px = 1600;  // larger pictures are reduced first

// Cell coordinates of chart coordinates, for each quarter turn of a window of the grid with its corner at (u,
// v).
Homography chart_to_grid(int u, int v, int turn) {
    // By columns: where x and y of the chart go, and the middle of patch 1.
    switch (turn) {
        case 0:
            return dmat3(1, 0, 0, 0, 1, 0, u - 0.5, v - 0.5, 1);
        case 1:
            return dmat3(0, 1, 0, -1, 0, 0, u + kChartRows - 0.5, v - 0.5, 1);
        case 2:
            return dmat3(-1, 0, 0, 0, -1, 0, u + kChartColumns - 0.5, v + kChartRows - 0.5, 1);
        default:
            return dmat3(0, -1, 0, 1, 0, 0, u - 0.5, v + kChartColumns - 0.5, 1);
    }
}

struct GridWindow {
    int u, v;
    bool tall;  // four cells wide and six high
    int cells;
};

std::vector<GridWindow> windows_of(const PatchGrid& grid) {
    int low_u = 1000, low_v = 1000, high_u = -1000, high_v = -1000;
    for (const PatchGrid::Cell& cell : grid.cells) {
        low_u = std::min(low_u, cell.u), high_u = std::max(high_u, cell.u);
        low_v = std::min(low_v, cell.v), high_v = std::max(high_v, cell.v);
    }
    std::vector<GridWindow> windows;
    int most = 0;
    for (const bool tall : {false, true}) {
        const int width = tall ? kChartRows : kChartColumns, height = tall ? kChartColumns : kChartRows;
        // A row or column may be missing altogether.
        for (int v = low_v - 2; v <= high_v + 2; ++v)
            for (int u = low_u - 2; u <= high_u + 2; ++u) {
                const auto inside =
                    std::count_if(grid.cells.begin(), grid.cells.end(), [&](const auto& cell) {
                        return cell.u >= u && cell.u < u + width && cell.v >= v && cell.v < v + height;
                    });
                if (inside < kLeastFlatPatches) continue;
                windows.push_back({u, v, tall, static_cast<int>(inside)});
                most = std::max(most, static_cast<int>(inside));
            }
    }
    std::erase_if(windows, [&](const GridWindow& w) { return w.cells < most - 5; });
    return windows;
}

// [px] How far the centroid of a patch's picture is from the picture of its middle: in perspective, its near
// half is the larger one.
dvec2 centroid_shift(const Homography& h, const dvec2& cell) {
    dvec2 sum(0);
    double total = 0;
    for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
            const dvec2 p = cell + 0.17 * dvec2(i, j);
            const double w = (h * dvec3(p, 1)).z, area = 1 / std::abs(w * w * w);  // up to a factor
            sum += area * mapped(h, p);
            total += area;
        }
    return sum / total - mapped(h, cell);
}

// The map through the patches that lie on the chart, and how far they are from it. Patches of which a part is
// missing, in shadow for example, have their middle elsewhere, and are left out.
void refine(FoundChart& chart, const std::vector<FlatPatch>& patches) {
    double gate_px = 1e9;
    for (int round = 0; round < 4; ++round) {
        const Homography before = chart.chart_to_picture, inverse = glm::inverse(before);
        std::vector<dvec2> from, to;
        for (const FlatPatch& patch : patches) {
            const dvec2 place = mapped(inverse, patch.centre_px);
            const dvec2 cell = glm::floor(place) + 0.5;
            if (cell.x < 0 || cell.y < 0 || cell.x > kChartColumns || cell.y > kChartRows) continue;
            const dvec2 middle = patch.centre_px - centroid_shift(before, cell);
            if (glm::length(place - cell) > 0.22 || glm::length(middle - mapped(before, cell)) > gate_px)
                continue;
            from.push_back(cell);
            to.push_back(middle);
        }
        if (from.size() < kLeastFlatPatches) return;
        const double pitch_px = glm::length(mapped(before, {3.5, 2}) - mapped(before, {2.5, 2}));
        const double stray_px = round == 0 ? std::max(0.8, 0.03 * pitch_px) : 0;
        const std::optional<Homography> h = homography_through(from, to, stray_px);
        if (!h) return;
        chart.chart_to_picture = *h;
        chart.patches_seen = static_cast<int>(from.size());
        std::vector<double> strays;
        double sum = 0;
        for (std::size_t i = 0; i < from.size(); ++i) {
            strays.push_back(glm::length(mapped(*h, from[i]) - to[i]));
            sum += strays.back() * strays.back();
        }
        chart.grid_residual_px = std::sqrt(sum / static_cast<double>(from.size()));
        gate_px = 2.5 * median(strays) + 0.15;
    }
}

// How doubtful a chart is: its colours fit badly, patches are missing, or lie off the grid. A grid that is
// bent to fit some patches only may still have the right colours at most of its places.
double doubt(const FoundChart& chart) {
    const double pitch_px =
        glm::length(mapped(chart.chart_to_picture, {3.5, 2}) - mapped(chart.chart_to_picture, {2.5, 2}));
    return chart.misfit + 0.004 * (kChartPatches - chart.patches_seen) + chart.grid_residual_px / pitch_px;
}

std::vector<FoundChart> charts_in(const Image<Rgb>& linear, const ChartOptions& options) {
    const std::vector<FlatPatch> patches = flat_patches(linear, options.smallest_patch_px);
    std::vector<FoundChart> charts;
    for (const PatchGrid& grid : patch_grids(patches, kLeastFlatPatches)) {
        // Several charts may lie on one grid: every window that fits, the best first.
        std::vector<FoundChart> fitting;
        for (const GridWindow& window : windows_of(grid))
            for (const int turn : {window.tall ? 1 : 0, window.tall ? 3 : 2}) {
                FoundChart chart;
                chart.chart_to_picture = grid.grid_to_picture * chart_to_grid(window.u, window.v, turn);
                chart.patches_seen = window.cells;
                chart.misfit = order_misfit(sampled_patches(linear, chart.chart_to_picture));
                if (chart.misfit <= options.worst_misfit) fitting.push_back(chart);
            }
        for (FoundChart& chart : fitting) refine(chart, patches);
        charts.insert(charts.end(), fitting.begin(), fitting.end());
    }
    std::sort(charts.begin(), charts.end(), [](const auto& a, const auto& b) { return doubt(a) < doubt(b); });
    // One chart is there once.
    std::vector<FoundChart> distinct;
    for (const FoundChart& chart : charts) {
        const bool seen = std::any_of(distinct.begin(), distinct.end(), [&](const FoundChart& other) {
            const dvec2 place = mapped(glm::inverse(other.chart_to_picture), chart.centre_px());
            return place.x > -1 && place.y > -1 && place.x < kChartColumns + 1 && place.y < kChartRows + 1;
        });
        if (!seen) distinct.push_back(chart);
    }
    return distinct;
}

Image<Rgb> reduced(const Image<Rgb>& linear, double scale) {
    const int width = std::max(1, static_cast<int>(std::lround(linear.width() * scale)));
    const int height = std::max(1, static_cast<int>(std::lround(linear.height() * scale)));
    Image<Rgb> small(width, height);
    const cv::Mat from(linear.height(), linear.width(), CV_32FC3, const_cast<Rgb*>(linear.data()));
    cv::Mat to(height, width, CV_32FC3, small.data());
    cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
    return small;
}

}  // namespace

std::optional<FoundChart> find_chart(const Image<Rgb>& linear, const ChartOptions& options) {
    validate(options);
    const double side = std::max(linear.width(), linear.height());
    std::vector<double> scales = {std::min(1.0, kLargestSought_px / side)};
    scales.push_back(scales[0] / 2);         // where patches are noisy or textured
    if (scales[0] < 1) scales.push_back(1);  // where the chart is small
    for (const double scale : scales) {
        std::vector<FoundChart> charts =
            scale < 1 ? charts_in(reduced(linear, scale), options) : charts_in(linear, options);
        if (charts.empty()) continue;
        for (FoundChart& chart : charts) {
            // Pixel centres are at integers: the reduced picture's (0, 0) is the middle of several.
            const double back_x = linear.width() / std::round(linear.width() * scale);
            const double back_y = linear.height() / std::round(linear.height() * scale);
            const dmat3 enlarge(back_x, 0, 0, 0, back_y, 0, (back_x - 1) / 2, (back_y - 1) / 2, 1);
            chart.chart_to_picture = enlarge * chart.chart_to_picture;
            chart.grid_residual_px *= back_x;
        }
        FoundChart& best = charts.front();
        for (std::size_t i = 1; i < charts.size(); ++i)
            best.warnings.push_back(fmt::format(
                "there are several colour charts: the one at ({:.0f}, {:.0f}) is used, the one at ({:.0f}, "
                "{:.0f}) "
                "is not; --chart takes the corners of the one you mean",
                best.centre_px().x, best.centre_px().y, charts[i].centre_px().x, charts[i].centre_px().y));
        return best;
    }
    return std::nullopt;
}

}  // namespace tangi
