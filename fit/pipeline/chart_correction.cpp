#include "fit/pipeline/chart_correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "capture/stack/survey.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr int kFewestPatches = 9;    // in the picture, for the chart to say anything
constexpr double kInner = 0.5;       // [1] of a patch's width that is read
constexpr int kGrid = 9;             // places across it
constexpr double kLowest = 0.2;      // [1] sine of a light's elevation, below which it tells no brightness
constexpr int kLargestSide = 20000;  // [px] of the chart's surroundings
constexpr double kDarkest = 0.03;    // [1] luminance from which on a patch tells brightness

using Patches = std::array<std::optional<Rgb>, kChartPatches>;

// [px of the whole picture] One of the places at which a patch is read.
glm::dvec2 place_in_picture(const Stack& stack, const CaptureColour::Chart& chart, int patch, int i) {
    const glm::dvec2 in_patch(i % kGrid / (kGrid - 1.0) - 0.5, i / kGrid / (kGrid - 1.0) - 0.5);
    const glm::dvec2 middle(patch % kChartColumns + 0.5, patch / kChartColumns + 0.5);
    const glm::dvec2 place = mapped(chart.to_photo, middle + kInner * in_patch);
    return stack.geometry ? stack.geometry->place_in_picture(place) : place;
}

// Mean rho_d of each patch that lies wholly in the picture and was measured.
Patches patches_of(const Stack& stack, const CaptureColour::Chart& chart, const Surface& surface) {
    Patches patches;
    for (int n = 0; n < kChartPatches; ++n) {
        Rgb sum(0);
        bool whole = true;
        for (int i = 0; i < kGrid * kGrid && whole; ++i) {
            const glm::dvec2 place = place_in_picture(stack, chart, n, i);
            const int x = static_cast<int>(std::lround(place.x)) - stack.crop.x0;
            const int y = static_cast<int>(std::lround(place.y)) - stack.crop.y0;
            whole = x >= 0 && y >= 0 && x < surface.width() && y < surface.height() &&
                    surface.confidence(x, y) > 0;
            if (whole) sum += surface.diffuse(x, y);
        }
        if (whole) patches[static_cast<std::size_t>(n)] = sum / static_cast<float>(kGrid * kGrid);
    }
    return patches;
}

void compare_with_chart(const CaptureColour::Chart& chart, const Patches& patches, ColourReport& report) {
    for (std::size_t n = 0; n < patches.size(); ++n) {
        if (!patches[n]) continue;
        ++report.patches;
        report.patches_delta_e += delta_e_2000(lab_from_linear(glm::dvec3(*patches[n])),
                                               lab_from_linear(glm::dvec3(chart.reference[n])));
    }
    report.patches_delta_e /= std::max(report.patches, 1);
}

// The part of the whole picture around the chart, which may reach beyond it where photographs are resampled.
Region around_chart(const Stack& stack, const CaptureColour::Chart& chart) {
    glm::dvec2 low(1e9), high(-1e9);
    for (int n = 0; n < kChartPatches; ++n)
        for (int i = 0; i < kGrid * kGrid; ++i) {
            const glm::dvec2 place = place_in_picture(stack, chart, n, i);
            low = glm::min(low, place), high = glm::max(high, place);
        }
    return {static_cast<int>(std::floor(low.x)), static_cast<int>(std::floor(low.y)),
            static_cast<int>(std::ceil(high.x)) + 1, static_cast<int>(std::ceil(high.y)) + 1};
}

// The chart in all photographs of a stack, and the lights that they were taken under.
struct ChartView {
    const Stack& stack;  // with a chart
    const Lighting& lighting;
    double mm_per_pixel;
    Region crop;  // of the band, in the whole picture
    Band band;
    float clipped;  // [1] linear

    // Of a place in the whole picture, in the surface's frame.
    Vec3 point_mm(const glm::dvec2& place) const {
        const glm::dvec2 centre((stack.crop.x0 + stack.crop.x1 - 1) / 2.0,
                                (stack.crop.y0 + stack.crop.y1 - 1) / 2.0);
        const glm::dvec2 mm = (place - centre) * glm::dvec2(mm_per_pixel, -mm_per_pixel);
        return {static_cast<float>(mm.x), static_cast<float>(mm.y), 0};
    }
};

// [1] Linear value from which on the stack's samples are clipped.
float clipped_value(const Stack& stack, const Transfer& transfer) {
    if (stack.development) return stack.development->clipped;
    return stack.bits == 32 ? std::numeric_limits<float>::infinity() : transfer.decode(kClipped);
}

// [1] By one patch, whose luminance is to be `right`, in one photograph; NaN where it is clipped or its light
// is too low.
double white_level_of(const ChartView& view, int patch, int photo, double right) {
    const Light& source = view.lighting.lights[static_cast<std::size_t>(photo)];
    const Rig& rig = view.lighting.rig;
    glm::dvec3 sum(0);
    double light = 0;
    for (int k = 0; k < kGrid * kGrid; ++k) {
        const glm::dvec2 place = place_in_picture(view.stack, *view.stack.colour->chart, patch, k);
        const int x = static_cast<int>(std::lround(place.x)) - view.crop.x0;
        const int y = static_cast<int>(std::lround(place.y)) - view.crop.y0;
        for (int c = 0; c < 3; ++c) {
            const float value = view.band.row(photo, c, y)[x];
            // Of another white balance, too.
            sum[c] +=
                value < view.clipped ? static_cast<double>(value * source.gain.g / source.gain[c]) : NAN;
        }
        const Incidence in = incidence(source, view.point_mm(place), rig);
        light += in.direction.z > kLowest ? in.irradiance.g * (in.direction.z + rig.ambient) : NAN;
    }
    return luminance(Rgb(glm::inverse(view.stack.colour->to_camera) * sum)) / (light * right);
}

}  // namespace

Lighting as_camera_sees(Lighting lighting, const Stack& stack) {
    if (stack.colour)
        for (Light& light : lighting.lights) light.gain *= Rgb(stack.colour->light());
    return lighting;
}

Rgb light_of_gain(const Rgb& gain, const Stack& stack) {
    if (!stack.colour) return gain;
    return glm::max(Rgb(glm::inverse(stack.colour->to_camera) * (stack.colour->light() * glm::dvec3(gain))),
                    Rgb(1e-3f));
}

std::optional<double> white_level_by_chart(const Stack& stack, const Transfer& transfer,
                                           const Lighting& lighting, double mm_per_pixel) {
    if (!stack.colour || !stack.colour->chart) return {};
    const CaptureColour::Chart& chart = *stack.colour->chart;
    Stack part = stack;
    part.crop = around_chart(stack, chart);
    const bool resampled = stack.geometry || std::any_of(stack.photos.begin(), stack.photos.end(),
                                                         [](const StackPhoto& p) { return p.homography; });
    if (part.crop.width() > kLargestSide || part.crop.height() > kLargestSide) return {};
    if (!resampled && (part.crop.x0 < 0 || part.crop.y0 < 0)) return {};
    StackReader reader(part);
    const ChartView view{stack,
                         lighting,
                         mm_per_pixel,
                         part.crop,
                         reader.read(0, part.height(), transfer),
                         clipped_value(stack, transfer)};
    std::vector<double> levels;
    int patches = 0;
    for (int n = 0; n < kChartPatches; ++n) {
        const double right = luminance(chart.reference[static_cast<std::size_t>(n)]);
        if (right < kDarkest) continue;
        const std::size_t before = levels.size();
        for (int i = 0; i < view.band.photos(); ++i) {
            const double level = white_level_of(view, n, i, right);
            if (level > 0) levels.push_back(level);  // NaN is not
        }
        patches += levels.size() > before;
    }
    if (patches < kFewestPatches) return {};
    return median(std::move(levels));
}

ColourReport correct_colours(const Stack& stack, Surface& surface) {
    ColourReport report;
    if (!stack.colour) return report;
    const glm::mat3 matrix(stack.colour->from_balanced());
    for (Rgb& diffuse : surface.diffuse.pixels()) {
        const Rgb corrected = matrix * diffuse;
        diffuse = glm::max(corrected, Rgb(0));
        report.clamped += diffuse != corrected;
    }
    surface.photography.to_camera = stack.colour->to_camera;
    report.corrected = true;
    report.delta_e_2000 = stack.colour->delta_e_2000;
    if (const auto& chart = stack.colour->chart)
        compare_with_chart(*chart, patches_of(stack, *chart, surface), report);
    return report;
}

}  // namespace tangi
