// chart_colour.h: white balance and a 3x3 matrix, from the camera's linear primaries to linear Rec. 709, from
// photographs of a colour chart; and how good they are.
#pragma once

#include <nlohmann/json.hpp>

#include "capture/colour_chart/chart_light.h"

namespace tangi {

struct ColourOptions {
    // [1] Least mean CIEDE2000 that a free matrix must win over one that keeps greys grey, to be used.
    double neutral_cost = 0.25;
    bool keep_neutral_always = false;
    int light_degree = 0;  // 1 or 2, see chart_light.h; 0: the one that predicts left-out patches better

    static constexpr std::string_view name = "chart_colour";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"neutral_cost", 0, 100, "1", "mean CIEDE2000 that exact greys may cost"},
              self.neutral_cost);
        visit(FieldInfo{"keep_neutral_always", 0, 1, "", "greys stay grey whatever it costs"},
              self.keep_neutral_always);
        visit(FieldInfo{"light_degree", 0, 2, "1",
                        "degree of the light's field over the chart, 0: by prediction"},
              self.light_degree);
    }
};

// CIEDE2000 of each patch; negative where the patch was left out. The others are NaN where all were.
struct ColourErrors {
    std::array<double, kChartPatches> patches{};
    double mean = 0, maximum = 0, percentile_90 = 0;
};

struct ColourCorrection {
    // linear Rec. 709 = matrix * (white_balance * camera). White balance has 1 for green; the matrix maps
    // (1, 1, 1) to a colour of luminance 1, which is (1, 1, 1) where greys stay grey. So brightness stays.
    Rgb white_balance{1};
    glm::dmat3 matrix{1};
    bool neutral_kept = true;
    bool matrix_solved = false;  // false: too few patches, white balance only

    ColourErrors before;  // white balance only
    ColourErrors after;
    ColourErrors after_flat;  // after, with S_L = 1 in CIEDE2000, as Metamorfoze has it
    ColourErrors
        cross_validated;  // each patch by the correction solved without it: what to expect of other colours
    double neutral_error = 0;  // largest CIEDE2000 without lightness of patches 19 to 23, after
    double neutral_gain = 0;   // mean CIEDE2000 by which a free matrix would be better
    // Of each photograph by itself, what is off in it after correction: a mean over photographs of which one
    // half is too red and the other too blue is grey. In their order; empty patches where its light is not
    // known.
    struct OfPhoto {
        ColourErrors after, after_flat;
        double neutral_error = 0;
    };
    std::vector<OfPhoto> of_photos{};
    std::optional<std::size_t> worst_photo() const;  // by the mean; nothing where none is known
    int patches_used = 0;
    int light_degree = 1;
    double exposure = 1;  // the chart's reflectance = exposure * apply(lights.even)
    ChartLights lights;
    std::string reference;  // source of the reference
    std::vector<std::string> warnings{};

    glm::dmat3 total() const;  // matrix with white balance
    Rgb apply(const Rgb& camera) const { return Rgb(total() * glm::dvec3(camera)); }
};

// Corrected pictures; values below 0 are kept.
Image<Rgb> corrected(const Image<Rgb>& camera, const ColourCorrection& correction);

// Solves the light on the chart together with the camera's colours (chart_light.h), then the matrix that
// minimises the sum of squared CIEDE2000 over the patches in even light, starting from linear least squares.
// The matrix keeps greys grey unless a free one is better by options.neutral_cost in the mean. With fewer
// than 9 patches, or colours that leave the matrix open, only white balance is solved, and a warning says so.
// Throws Error where not even that can be: no photograph, no good patch.
ColourCorrection correct_colours(std::span<const ChartReading> photos, const ChartReference& reference,
                                 const ColourOptions& options = {});

// Adds, for each photograph, that its chart is black or cannot be read, or which patches do not fit the
// others.
void warn_of_outliers(ColourCorrection& correction, std::span<const ChartReading> photos);

// For capture.json: see docs/reference/capture-json.md.
nlohmann::json to_json(const ColourCorrection& correction, const ChartReference& reference);
nlohmann::json to_json(const FoundChart& chart);

}  // namespace tangi
