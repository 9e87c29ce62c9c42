// chart_colour.cpp: the matrix by CIEDE2000, and its errors.
#include "capture/colour_chart/chart_colour.h"

#include <ceres/ceres.h>

#include <glm/matrix.hpp>
#include <limits>

#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

using glm::dmat3;
using glm::dvec3;

namespace {

constexpr int kLeastPatches = 9;
constexpr double kLeastSpread = 1e-6;  // [1] determinant of the colours' second moments: grey pictures have 0

using Used = std::array<bool, kChartPatches>;

struct Solution {
    dvec3 white_balance{1};
    dmat3 matrix{1};
    double exposure = 1;

    dvec3 apply(const dvec3& camera) const { return exposure * (matrix * (white_balance * camera)); }
};

enum class Free { exposure, neutral, all };

// The numbers that are solved for: nine of exposure * matrix, by rows; or the six off its diagonal, whose
// rows add up to one, and the exposure's logarithm.
std::vector<double> parameters_of(const Solution& s, Free free) {
    std::vector<double> p;
    if (free == Free::all)
        for (int i = 0; i < 9; ++i) p.push_back(s.exposure * s.matrix[i % 3][i / 3]);
    if (free == Free::neutral)
        for (int row = 0; row < 3; ++row)
            for (int step : {1, 2}) p.push_back(s.matrix[(row + step) % 3][row]);
    if (free != Free::all) p.push_back(std::log(s.exposure));
    return p;
}

Solution with_parameters(const Solution& before, Free free, const double* p) {
    Solution s = before;
    if (free == Free::all) {
        for (int i = 0; i < 9; ++i) s.matrix[i % 3][i / 3] = p[i];
        s.exposure = 1;
        return s;
    }
    if (free == Free::neutral)
        for (int row = 0; row < 3; ++row) {
            const double first = p[2 * row], second = p[2 * row + 1];
            s.matrix[row][row] = 1 - first - second;
            s.matrix[(row + 1) % 3][row] = first;
            s.matrix[(row + 2) % 3][row] = second;
        }
    s.exposure = std::exp(p[free == Free::neutral ? 6 : 0]);
    return s;
}

struct PatchError {
    Solution start;
    Free free;
    dvec3 camera;
    Lab reference;

    bool operator()(const double* const* p, double* error) const {
        const dvec3 parts =
            delta_e_2000_parts(lab_from_linear(with_parameters(start, free, p[0]).apply(camera)), reference);
        for (int k = 0; k < 3; ++k) error[k] = parts[k];
        return std::isfinite(parts.x + parts.y + parts.z);
    }
};

Lab reference_lab(const ChartReference& reference, std::size_t patch) {
    return lab_from_linear(dvec3(reference.patches[patch].linear));
}

// Least sum of squared CIEDE2000.
Solution solved(const Solution& start, Free free, const ChartLights& lights, const ChartReference& reference,
                const Used& used) {
    std::vector<double> parameters = parameters_of(start, free);
    ceres::Problem problem;
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        if (!used[i]) continue;
        auto* cost = new ceres::DynamicNumericDiffCostFunction<PatchError, ceres::CENTRAL>(
            new PatchError{start, free, lights.even[i], reference_lab(reference, i)});
        cost->AddParameterBlock(static_cast<int>(parameters.size()));
        cost->SetNumResiduals(3);
        problem.AddResidualBlock(cost, nullptr, parameters.data());
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return with_parameters(start, free, parameters.data());
}

// What makes the greys as grey as the reference has them; of all patches where no grey can be used. The
// exposure is a first guess. `neutral`: what makes a perfect grey grey instead, which those of a chart are
// not quite; the camera's matrix tells how their tint reads.
Solution white_balanced(const ChartLights& lights, const ChartReference& reference, const Used& used,
                        bool neutral) {
    std::array<std::vector<double>, 3> ratios;
    const dvec3 white = lights.camera_of_reflectance * dvec3(1);
    for (const bool greys : {true, false}) {
        if (!ratios[1].empty()) break;
        // The black patch is mostly noise and stray light.
        const std::size_t first = greys ? kFirstNeutral : 0, last = greys ? kChartPatches - 1 : kChartPatches;
        for (std::size_t i = first; i < last; ++i) {
            const dvec3& c = lights.even[i];
            if (!used[i] || !(std::min({c.r, c.g, c.b}) > 0)) continue;
            const dvec3 linear(reference.patches[i].linear);
            const dvec3 aim = neutral ? lights.camera_of_reflectance * linear / white : linear;
            for (int k = 0; k < 3; ++k)
                ratios[static_cast<std::size_t>(k)].push_back(std::log(std::max(1e-3, aim[k]) / c[k]));
        }
    }
    Solution s;
    if (ratios[1].empty()) return s;
    dvec3 mean(0);
    for (int k = 0; k < 3; ++k)
        for (const double r : ratios[static_cast<std::size_t>(k)])
            mean[k] += r / static_cast<double>(ratios[static_cast<std::size_t>(k)].size());
    s.exposure = std::exp(mean.g);
    s.white_balance = glm::exp(mean - mean.g);
    return s;
}

bool matrix_is_determined(const Solution& balanced, const ChartLights& lights, const Used& used) {
    if (std::count(used.begin(), used.end(), true) < kLeastPatches) return false;
    dmat3 moments(0);
    double count = 0;
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        if (!used[i]) continue;
        const dvec3 c = balanced.white_balance * lights.even[i];
        if (!(glm::length(c) > 0)) continue;
        moments += glm::outerProduct(glm::normalize(c), glm::normalize(c));
        ++count;
    }
    return count >= kLeastPatches && glm::determinant(moments / count) > kLeastSpread;
}

// The linear solution, which the other starts from: the inverse of the camera's matrix, its rows made to add
// up to one.
Solution linear_solution(const Solution& balanced, const ChartLights& lights) {
    Solution s = balanced;
    const dmat3 inverse = glm::inverse(lights.camera_of_reflectance);
    for (int row = 0; row < 3; ++row) {
        dvec3 values;
        for (int k = 0; k < 3; ++k) values[k] = inverse[k][row] / balanced.white_balance[k];
        const double sum = values.x + values.y + values.z;
        for (int k = 0; k < 3; ++k) s.matrix[k][row] = std::abs(sum) > 1e-6 ? values[k] / sum : (k == row);
    }
    return s;
}

double error_of(const Solution& s, const ChartLights& lights, const ChartReference& reference,
                std::size_t patch) {
    return delta_e_2000(lab_from_linear(s.apply(lights.even[patch])), reference_lab(reference, patch));
}

void summarise(ColourErrors& errors) {
    std::vector<double> sorted;
    for (const double e : errors.patches)
        if (e >= 0) sorted.push_back(e);
    std::sort(sorted.begin(), sorted.end());
    if (sorted.empty()) {
        errors.mean = errors.maximum = errors.percentile_90 = std::numeric_limits<double>::quiet_NaN();
        return;
    }
    const double count = static_cast<double>(sorted.size());
    for (const double e : sorted) errors.mean += e / count;
    errors.maximum = sorted.back();
    errors.percentile_90 = sorted[static_cast<std::size_t>(std::ceil(0.9 * count)) - 1];  // the nearest rank
}

ColourErrors errors_of(const Solution& s, const ChartLights& lights, const ChartReference& reference,
                       const Used& used) {
    ColourErrors errors;
    for (std::size_t i = 0; i < kChartPatches; ++i)
        errors.patches[i] = used[i] ? error_of(s, lights, reference, i) : -1;
    summarise(errors);
    return errors;
}

Solution solved_from_scratch(Free free, const ChartLights& lights, const ChartReference& reference,
                             const Used& used) {
    const Solution balanced = white_balanced(lights, reference, used, true);
    const Solution neutral =
        solved(linear_solution(balanced, lights), Free::neutral, lights, reference, used);
    return free == Free::all ? solved(neutral, Free::all, lights, reference, used) : neutral;
}

Used used_in(const ChartLights& lights) {
    Used used;
    for (std::size_t i = 0; i < kChartPatches; ++i) used[i] = lights.photos[i] > 0;
    return used;
}

// Each patch by the light and the matrix that were solved without it.
ColourErrors cross_validated_errors(std::span<const ChartReading> photos, const ChartReference& reference,
                                    int degree, Free free, const ChartLights& all) {
    ColourErrors errors;
    errors.patches.fill(-1);
    const Used used = used_in(all);
    // Without one of them there would be too few.
    if (std::count(used.begin(), used.end(), true) <= kLeastPatches) {
        summarise(errors);
        return errors;
    }
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        if (!used[i]) continue;
        Used others = used;
        others[i] = false;
        const ChartLights lights = fit_chart_lights(photos, reference, degree, others, &all);
        if (lights.photos[i] == 0) continue;  // the others expect another colour altogether
        Used known = used_in(lights);
        known[i] = false;
        errors.patches[i] =
            error_of(solved_from_scratch(free, lights, reference, known), lights, reference, i);
    }
    summarise(errors);
    return errors;
}

// Of patches that the camera reads so in even light.
ColourCorrection::OfPhoto errors_after(const Solution& s, const ChartLights& lights,
                                       const ChartReference& reference, const Used& used) {
    ColourCorrection::OfPhoto errors{.after = errors_of(s, lights, reference, used), .after_flat = {}};
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        errors.after_flat.patches[i] = -1;
        if (!used[i]) continue;
        const Lab made = lab_from_linear(s.apply(lights.even[i])), aim = reference_lab(reference, i);
        dvec3 parts = delta_e_2000_parts(made, aim);
        parts.x = made.l - aim.l;
        errors.after_flat.patches[i] = glm::length(parts);
        parts.x = 0;
        if (i >= kFirstNeutral && i < kChartPatches - 1)
            errors.neutral_error = std::max(errors.neutral_error, glm::length(parts));
    }
    summarise(errors.after_flat);
    return errors;
}

// Each photograph's own readings, in even light.
std::vector<ColourCorrection::OfPhoto> errors_of_photos(const Solution& s, const ChartLights& lights,
                                                        std::span<const ChartReading> photos,
                                                        const ChartReference& reference, const Used& used) {
    std::vector<ColourCorrection::OfPhoto> all;
    for (std::size_t p = 0; p < std::min(photos.size(), lights.lights.size()); ++p) {
        Used here{};
        ChartLights one = lights;
        for (std::size_t i = 0; i < kChartPatches; ++i) {
            here[i] = used[i] && lights.lights[p].known && !lights.outliers[p][i] &&
                      photos[p].patches[i].state == PatchState::good;
            if (here[i])
                one.even[i] =
                    dvec3(photos[p].patches[i].mean) / std::exp(lights.lights[p].log_at(static_cast<int>(i)));
        }
        all.push_back(errors_after(s, one, reference, here));
    }
    return all;
}

void finish(ColourCorrection& c, const Solution& s, const Solution& balanced, const ChartReference& reference,
            const Used& used, std::span<const ChartReading> photos) {
    c.before =
        errors_of(solved(balanced, Free::exposure, c.lights, reference, used), c.lights, reference, used);
    const ColourCorrection::OfPhoto all = errors_after(s, c.lights, reference, used);
    c.after = all.after;
    c.after_flat = all.after_flat;
    c.neutral_error = all.neutral_error;
    c.of_photos = errors_of_photos(s, c.lights, photos, reference, used);
    const dvec3 white = s.matrix * dvec3(1);
    const double luminance = 0.2126 * white.r + 0.7152 * white.g + 0.0722 * white.b;
    c.white_balance = Rgb(s.white_balance);
    c.matrix = s.matrix / luminance;
    c.exposure = s.exposure * luminance;
}

// White balance from readings that were never put in even light: for a chart of which hardly anything shows.
ColourCorrection white_balance_only(std::span<const ChartReading> photos, const ChartReference& reference,
                                    ColourCorrection c) {
    ChartLights& lights = c.lights;
    c.cross_validated.patches.fill(-1);
    summarise(c.cross_validated);
    if (lights.lights.empty() ||
        std::none_of(lights.lights.begin(), lights.lights.end(), [](const auto& l) { return l.known; }))
        for (const ChartReading& photo : photos)
            for (std::size_t i = 0; i < kChartPatches; ++i) {
                if (photo.patches[i].state != PatchState::good) continue;
                const double n = ++lights.photos[i];
                lights.even[i] += (dvec3(photo.patches[i].mean) - lights.even[i]) / n;
            }
    const Used used = used_in(lights);
    c.patches_used = static_cast<int>(std::count(used.begin(), used.end(), true));
    if (c.patches_used == 0)
        fail(
            "no patch of the colour chart can be used in any photograph: all are clipped, in shadow or "
            "outside; "
            "photograph it anew, or leave the chart out");
    const Solution balanced = white_balanced(lights, reference, used, false);
    c.warnings.push_back(
        fmt::format("{} patches of the colour chart can be used, or their colours are too much alike: "
                    "9 different ones are needed for a matrix, so only white balance was solved",
                    c.patches_used));
    finish(c, solved(balanced, Free::exposure, lights, reference, used), balanced, reference, used, photos);
    return c;
}

}  // namespace

dmat3 ColourCorrection::total() const {
    dmat3 result = matrix;
    for (int k = 0; k < 3; ++k) result[k] *= static_cast<double>(white_balance[k]);
    return result;
}

Image<Rgb> corrected(const Image<Rgb>& camera, const ColourCorrection& correction) {
    const glm::mat3 total(correction.total());
    Image<Rgb> result(camera.width(), camera.height());
    for (std::size_t i = 0; i < camera.size(); ++i) result.pixels()[i] = total * camera.pixels()[i];
    return result;
}

ColourCorrection correct_colours(std::span<const ChartReading> photos, const ChartReference& reference,
                                 const ColourOptions& options) {
    validate(options);
    if (photos.empty()) fail("no photograph of the colour chart was given");
    ColourCorrection c;
    c.reference = reference.source;
    Used everything;
    everything.fill(true);

    const Free free = Free::neutral;
    std::vector<int> degrees = {options.light_degree};
    if (options.light_degree == 0) degrees = {1, 2};
    bool first = true;
    for (const int degree : degrees) {
        ChartLights lights = fit_chart_lights(photos, reference, degree, everything);
        const Used used = used_in(lights);
        if (!matrix_is_determined(white_balanced(lights, reference, used, false), lights, used)) {
            if (first) c.lights = std::move(lights);
            continue;
        }
        ColourErrors cross_validated = cross_validated_errors(photos, reference, degree, free, lights);
        // A patch more may not be taken for a better prediction.
        if (!c.matrix_solved || cross_validated.mean < c.cross_validated.mean) {
            c.cross_validated = cross_validated;
            c.lights = std::move(lights);
            c.light_degree = degree;
        }
        c.matrix_solved = true;
        first = false;
    }
    if (!c.matrix_solved) return white_balance_only(photos, reference, std::move(c));
    warn_of_outliers(c, photos);

    const Used used = used_in(c.lights);
    c.patches_used = static_cast<int>(std::count(used.begin(), used.end(), true));
    const Solution balanced = white_balanced(c.lights, reference, used, false);
    Solution s = solved_from_scratch(Free::neutral, c.lights, reference, used);
    const Solution open = solved_from_scratch(Free::all, c.lights, reference, used);
    c.neutral_gain =
        errors_of(s, c.lights, reference, used).mean - errors_of(open, c.lights, reference, used).mean;
    c.neutral_kept = options.keep_neutral_always || c.neutral_gain < options.neutral_cost;
    if (!c.neutral_kept) {
        s = open;
        c.cross_validated = cross_validated_errors(photos, reference, c.light_degree, Free::all, c.lights);
        c.warnings.push_back(fmt::format(
            "greys are not kept exactly grey: that would cost {:.2f} in mean CIEDE2000", c.neutral_gain));
    }
    finish(c, s, balanced, reference, used, photos);
    return c;
}

}  // namespace tangi
