// colour_chart.cpp: the geometry of the chart, and reading its patches.
#include "capture/colour_chart/colour_chart.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "capture/colour_chart/chart_order.h"
#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

// Where the outer edges of the outer patches lie, in pitches. The gaps between patches differ a little
// between sizes of the chart; what is read is far from the edges.
constexpr double kMargin = 0.065;
constexpr ChartCorners kCorners = {dvec2(kMargin, kMargin), dvec2(kChartColumns - kMargin, kMargin),
                                   dvec2(kChartColumns - kMargin, kChartRows - kMargin),
                                   dvec2(kMargin, kChartRows - kMargin)};
constexpr double kPatchWidth = 1 - 2 * kMargin;

// A pixel of a patch, and where in its inner part it lies: -1..1 each.
struct PatchPixel {
    dvec2 place;
    Rgb value;
};

struct PatchPixels {
    std::vector<PatchPixel> pixels;
    bool whole = true;  // nothing of it lies outside the picture
};

PatchPixels pixels_of(const Image<Rgb>& linear, const Homography& chart_to_picture, int patch,
                      double inner_part) {
    const dvec2 centre(patch % kChartColumns + 0.5, patch / kChartColumns + 0.5);
    const double reach = inner_part * kPatchWidth / 2;
    dvec2 low(1e9), high(-1e9);
    for (const dvec2 corner : {dvec2(-1, -1), dvec2(1, -1), dvec2(1, 1), dvec2(-1, 1)}) {
        const dvec2 p = mapped(chart_to_picture, centre + reach * corner);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    PatchPixels result;
    if (!(low.x >= 0 && low.y >= 0 && high.x <= linear.width() - 1 && high.y <= linear.height() - 1)) {
        result.whole = false;
        return result;
    }
    const Homography inverse = glm::inverse(chart_to_picture);
    for (int y = static_cast<int>(std::ceil(low.y)); y <= high.y; ++y)
        for (int x = static_cast<int>(std::ceil(low.x)); x <= high.x; ++x) {
            const dvec2 place = (mapped(inverse, dvec2(x, y)) - centre) / reach;
            if (std::abs(place.x) <= 1 && std::abs(place.y) <= 1)
                result.pixels.push_back({place, linear(x, y)});
        }
    return result;
}

// Brightest less darkest of 3 x 3 cells of a patch, relative to their mean, less what noise makes of it.
// Light that falls off smoothly makes a few percent of it; the edge of a shadow or highlight much more.
double unevenness(const std::vector<PatchPixel>& pixels) {
    std::array<std::vector<double>, 9> cells;
    for (const PatchPixel& p : pixels) {
        const auto third = [](double t) { return std::clamp(static_cast<int>((t + 1) * 1.5), 0, 2); };
        cells[static_cast<std::size_t>(3 * third(p.place.y) + third(p.place.x))].push_back(
            p.value.r + p.value.g + p.value.b);
    }
    double low = 1e9, high = -1e9, sum = 0, variance = 0;
    int count = 0;
    for (const std::vector<double>& cell : cells) {
        if (cell.empty()) continue;
        double mean = 0, square = 0;
        for (const double v : cell) mean += v / static_cast<double>(cell.size());
        for (const double v : cell) square += (v - mean) * (v - mean) / static_cast<double>(cell.size());
        low = std::min(low, mean);
        high = std::max(high, mean);
        sum += mean;
        variance += square / static_cast<double>(cell.size());
        ++count;
    }
    if (count == 0 || !(sum > 0)) return 0;
    // The range of nine normal values is three standard deviations on average.
    const double noise = 4 * std::sqrt(variance / count);
    return std::max(0.0, (high - low - noise) / (sum / count));
}

// Mean of the values within 3 robust standard deviations of the median brightness: dust and hot pixels go.
void read_robustly(const std::vector<PatchPixel>& pixels, PatchReading& reading) {
    const auto brightness = [](const Rgb& c) { return static_cast<double>(c.r) + c.g + c.b; };
    std::vector<double> values, deviations;
    for (const PatchPixel& p : pixels) values.push_back(brightness(p.value));
    const double middle = median(values);
    for (const double v : values) deviations.push_back(std::abs(v - middle));
    const double reach = 3 * 1.4826 * median(deviations) + 1e-9 + 1e-6 * std::abs(middle);
    dvec3 sum(0), square(0);
    int count = 0;
    for (const PatchPixel& p : pixels)
        if (std::abs(brightness(p.value) - middle) <= reach) sum += dvec3(p.value), ++count;
    const dvec3 mean = sum / static_cast<double>(count);
    for (const PatchPixel& p : pixels)
        if (std::abs(brightness(p.value) - middle) <= reach)
            square += (dvec3(p.value) - mean) * (dvec3(p.value) - mean);
    reading.mean = Rgb(mean);
    reading.sigma = Rgb(glm::sqrt(square / (static_cast<double>(count) * std::max(1, count - 1))));
}

PatchReading read_patch(const Image<Rgb>& linear, const Homography& chart_to_picture, int patch,
                        const ChartOptions& options) {
    PatchReading reading;
    const PatchPixels region = pixels_of(linear, chart_to_picture, patch, options.inner_part);
    if (!region.whole || region.pixels.size() < 4) return reading;
    reading.pixels = static_cast<int>(region.pixels.size());
    int clipped = 0;
    for (const PatchPixel& p : region.pixels)
        clipped += std::max({p.value.r, p.value.g, p.value.b}) >= options.clip_level ||
                   !std::isfinite(p.value.r + p.value.g + p.value.b);
    read_robustly(region.pixels, reading);
    constexpr double kMostClipped = 0.02, kMostUneven = 0.2;
    if (clipped > kMostClipped * reading.pixels)
        reading.state = PatchState::clipped;
    else
        reading.state = unevenness(region.pixels) > kMostUneven ? PatchState::uneven : PatchState::good;
    return reading;
}

}  // namespace

const char* name_of(PatchState state) {
    switch (state) {
        case PatchState::good:
            return "good";
        case PatchState::clipped:
            return "clipped";
        case PatchState::uneven:
            return "uneven";
        case PatchState::outside:
            return "outside";
    }
    return "";
}

ChartCorners chart_corners(const FoundChart& chart) {
    ChartCorners corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = mapped(chart.chart_to_picture, kCorners[i]);
    return corners;
}

namespace {

// By how many times the square patches look longer one way than the other, at a place: the singular values'
// ratio of the map's derivative. Seen from afar, a plane that is tilted by t looks 1 / cos t times longer
// along the axis of the tilt.
double elongation_at(const Homography& plane_to_picture, const dvec2& place_px) {
    const Homography back = glm::inverse(plane_to_picture);
    const auto on_plane = [&](const dvec2& p) {
        const glm::dvec3 q = back * glm::dvec3(p, 1);
        return dvec2(q) / q.z;
    };
    const dvec2 a = on_plane(place_px + dvec2(0.5, 0)) - on_plane(place_px - dvec2(0.5, 0));
    const dvec2 b = on_plane(place_px + dvec2(0, 0.5)) - on_plane(place_px - dvec2(0, 0.5));
    const double sum = glm::dot(a, a) + glm::dot(b, b), area = std::abs(a.x * b.y - a.y * b.x);
    const double root = std::sqrt(std::max(sum * sum - 4 * area * area, 0.0));
    return std::sqrt((sum + root) / std::max(sum - root, 1e-12 * sum));
}

constexpr double kTilted = 0.03;  // [1] elongation from which on a chart is said to be tilted: 14 degrees

}  // namespace

Scale scale_from_chart(const FoundChart& chart, const dvec2& pitch_mm) {
    if (!(pitch_mm.x > 0 && pitch_mm.y > 0))
        fail("the pitch of the chart's patches is {:g} x {:g} mm; give positive numbers", pitch_mm.x,
             pitch_mm.y);
    const Homography plane_to_picture =
        chart.chart_to_picture * Homography(1 / pitch_mm.x, 0, 0, 0, 1 / pitch_mm.y, 0, 0, 0, 1);
    const double mm = mm_per_pixel_at(plane_to_picture, chart.centre_px());
    // Errors of the patches' middles over the grid's extent: the scale is a slope through `patches` points
    // whose rms distance from the middle is about 2 pitches. Given corners are taken to be good to a pixel.
    const double pitch_px = (pitch_mm.x + pitch_mm.y) / (2 * mm);
    const bool given = chart.patches_seen == 0;
    const double point_px = given ? 1 : std::max(0.1, chart.grid_residual_px);
    const double points = given ? 4 : chart.patches_seen;
    Scale scale{mm, mm * point_px / (2 * pitch_px * std::sqrt(points)), chart.centre_px(), "chart", {}};
    const double elongation = elongation_at(plane_to_picture, scale.place_px) - 1;
    if (elongation > std::max(kTilted, 6 * scale.sigma / mm)) {
        // What lies flat beside it has the scale along the axis of its tilt.
        const double off = std::sqrt(1 + elongation) - 1;
        scale.sigma = std::hypot(scale.sigma, off * mm);
        scale.warnings.push_back(fmt::format(
            "the colour chart's patches look {:.0f} % longer one way than the other, as if it were tilted by "
            "{:.0f} degrees: of a painting that is not tilted with it, its scale is {:.1f} % off; lay it "
            "flat "
            "beside the painting, or give another scale",
            100 * elongation, std::acos(1 / (1 + elongation)) * 180 / std::numbers::pi, 100 * off));
    }
    return scale;
}

int ChartReading::good() const {
    return static_cast<int>(std::count_if(patches.begin(), patches.end(),
                                          [](const auto& p) { return p.state == PatchState::good; }));
}

FoundChart chart_at(const Image<Rgb>& linear, const ChartCorners& corners_px, const ChartOptions& options) {
    validate(options);
    double largest = 0, smallest = 1e18;
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec2 &a = corners_px[i], &b = corners_px[(i + 1) % 4], &c = corners_px[(i + 2) % 4];
        if (!(a.x >= 0 && a.y >= 0 && a.x <= linear.width() - 1 && a.y <= linear.height() - 1))
            fail("corner {} of the chart, ({:.1f}, {:.1f}), lies outside the picture of {} x {} pixels",
                 i + 1, a.x, a.y, linear.width(), linear.height());
        const double turn = cross(b - a, c - b);
        largest = std::max(largest, turn);
        smallest = std::min(smallest, turn);
    }
    if (largest <= 0 || smallest < 0)
        fail(
            "the chart's corners cross or go round anticlockwise; give them clockwise as seen in the "
            "picture, from "
            "any of them on");
    if (smallest < 0.1 * largest || smallest < 16 * options.smallest_patch_px)
        fail("the chart's corners lie nearly on a line; give the outer corners of the four corner patches");

    FoundChart best;
    best.misfit = 1e9;
    for (std::size_t turn = 0; turn < 4; ++turn) {
        ChartCorners turned;
        for (std::size_t i = 0; i < 4; ++i) turned[i] = corners_px[(i + turn) % 4];
        const Homography map = homography_between(kCorners, turned);
        const double misfit = order_misfit(sampled_patches(linear, map));
        if (misfit < best.misfit) best = {map, 0, 0, misfit, {}};
    }
    if (best.misfit > options.worst_misfit)
        best.warnings.push_back(
            fmt::format("the chart at ({:.0f}, {:.0f}), where you gave its corners, does not have the "
                        "colours of the classic "
                        "chart: its patches are off by {:.2f}, and {:.2f} is the most for a chart",
                        best.centre_px().x, best.centre_px().y, best.misfit, options.worst_misfit));
    return best;
}

ChartReading read_chart(const Image<Rgb>& linear, const FoundChart& chart, const std::string& photo,
                        const ChartOptions& options) {
    validate(options);
    ChartReading reading{photo, {}};
    for (int patch = 0; patch < kChartPatches; ++patch) {
        PatchReading& p = reading.patches[static_cast<std::size_t>(patch)];
        p = read_patch(linear, chart.chart_to_picture, patch, options);
    }
    for (const PatchState state : {PatchState::clipped, PatchState::uneven, PatchState::outside}) {
        std::string numbers;
        for (std::size_t i = 0; i < kChartPatches; ++i)
            if (reading.patches[i].state == state)
                numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", i + 1);
        if (numbers.empty()) continue;
        const char* why = state == PatchState::clipped  ? "is clipped: expose less"
                          : state == PatchState::uneven ? "has the edge of a shadow or a highlight on it"
                                                        : "is not wholly in the picture";
        reading.warnings.push_back(fmt::format("{}{}the chart's patch {} {}; rejected", photo,
                                               photo.empty() ? "" : ": ", numbers, why));
    }
    return reading;
}

}  // namespace tangi
