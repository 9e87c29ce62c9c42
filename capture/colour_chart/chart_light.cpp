// chart_light.cpp: the joint fit of light fields and the camera's matrix.
#include "capture/colour_chart/chart_light.h"

#include <ceres/ceres.h>

#include <glm/matrix.hpp>

#include "capture/colour_chart/chart_order.h"
#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

using glm::dvec3;

namespace {

constexpr int kLeastLitPatches = 9;     // of a photograph, to know its light
constexpr double kDark = 0.02;          // [1] of the usual white: a light that failed tells no colours
constexpr double kModelError = 0.01;    // [1] relative: what smooth light and one matrix leave of real charts
constexpr double kReadingFloor = 1e-3;  // [1] of the white patch's reading, below which errors are absolute
constexpr double kLossSigmas = 2;       // where Cauchy's function begins to bend
constexpr double kOutlier = 0.08;       // [1] relative, of the brightness
constexpr double kOutlierFloor = 0.004;  // [1] of the white patch, beside it: stray light on dark patches

std::array<double, 6> basis_at(int patch) {
    const auto column = patch % kChartColumns, row = patch / kChartColumns;
    const double x = (column + 0.5) / 3 - 1, y = (row + 0.5) / 3 - 2.0 / 3;
    return {1, x, y, x * x, x * y, y * y};
}

double brightness(const dvec3& c) { return c.r + 2 * c.g + c.b; }

// Difference of a reading from the model, in standard errors.
struct ReadingError {
    dvec3 reading, sigma, reflectance;
    std::array<double, 6> basis;

    template <class T>
    bool operator()(const T* field, const T* matrix, T* error) const {
        using std::exp;
        T log_light(0);
        for (std::size_t k = 0; k < 6; ++k) log_light += field[k] * basis[k];
        const T light = exp(log_light);
        for (int k = 0; k < 3; ++k) {
            const T colour = matrix[3 * k] * reflectance.r + matrix[3 * k + 1] * reflectance.g +
                             matrix[3 * k + 2] * reflectance.b;
            error[k] = (light * colour - reading[k]) / sigma[k];
        }
        return true;
    }
};

dvec3 sigma_of(const PatchReading& reading, double white) {
    dvec3 sigma;
    // Errors of a channel are not smaller than the model's for the brightness: reds have hardly any blue.
    const double size = std::max({reading.mean.r, reading.mean.g, reading.mean.b, 0.0f});
    for (int k = 0; k < 3; ++k) {
        const double model = kModelError * 0.5 * (size + std::abs(double(reading.mean[k])));
        sigma[k] = std::sqrt(double(reading.sigma[k]) * reading.sigma[k] + model * model +
                             kReadingFloor * kReadingFloor * white * white);
    }
    return sigma;
}

double white_of(const ChartReading& photo) {
    double white = 0;
    for (const PatchReading& p : photo.patches)
        if (p.state == PatchState::good)
            white = std::max({white, double(p.mean.r), double(p.mean.g), double(p.mean.b)});
    return white;
}

// The level of a photograph's light such that the white patch reads about 1: the median over patches of how
// bright they are against how bright they should be.
double level_of(const ChartReading& photo, const ChartReference& reference) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        const PatchReading& p = photo.patches[i];
        if (p.state != PatchState::good || brightness(dvec3(p.mean)) <= 0) continue;
        ratios.push_back(std::log(brightness(dvec3(p.mean)) /
                                  std::max(1e-3, brightness(dvec3(reference.patches[i].linear)))));
    }
    return median(ratios);
}

// How bright each patch is in most photographs, against what the model says: charts are not quite what their
// references say, and that is no shadow. 1 where fewer than three photographs tell.
std::array<double, kChartPatches> usual_ratios(std::span<const ChartReading> photos,
                                               const ChartLights& lights, const ChartReference& reference) {
    std::array<double, kChartPatches> usual;
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        std::vector<double> ratios;
        const double expected = brightness(lights.camera_of_reflectance * dvec3(reference.patches[i].linear));
        for (std::size_t p = 0; p < photos.size(); ++p)
            if (lights.lights[p].known && photos[p].patches[i].state == PatchState::good && expected > 0)
                ratios.push_back(brightness(dvec3(photos[p].patches[i].mean)) /
                                 (expected * std::exp(lights.lights[p].log_at(static_cast<int>(i)))));
        usual[i] = ratios.size() < 3 ? 1 : std::clamp(median(ratios), 0.8, 1.25);
    }
    return usual;
}

}  // namespace

double ChartLight::log_at(int patch) const {
    const std::array<double, 6> basis = basis_at(patch);
    double sum = 0;
    for (std::size_t k = 0; k < 6; ++k) sum += terms[k] * basis[k];
    return sum;
}

namespace {

// The joint problem of the lights of all photographs and of the camera's matrix.
class ChartLightFit {
public:
    ChartLightFit(std::span<const ChartReading> photos, const ChartReference& reference,
                  const std::array<bool, kChartPatches>& use, const ChartLights* start)
        : photos_(photos), reference_(reference), use_(use), start_(start) {
        result_.lights.resize(photos.size());
        result_.outliers.assign(photos.size(), {});
        if (start)
            for (int i = 0; i < 9; ++i)
                matrix_[static_cast<std::size_t>(i)] = start->camera_of_reflectance[i % 3][i / 3];
    }
    // Those whose light can be known; false where there are none.
    bool add_photographs(int degree);
    void solve();
    // What the solution makes of the readings.
    void judge();
    const ChartLights& found() const { return result_; }

private:
    bool usable(const ChartReading& photo, std::size_t i) const {
        return use_[i] && photo.patches[i].state == PatchState::good;
    }
    bool is_lit(const ChartReading& photo) const {
        int good = 0;
        for (std::size_t i = 0; i < kChartPatches; ++i) good += usable(photo, i);
        return good >= kLeastLitPatches;
    }
    void add_photograph(const ChartReading& photo, ChartLight& light);
    void even_out();

    std::span<const ChartReading> photos_;
    const ChartReference& reference_;
    const std::array<bool, kChartPatches>& use_;
    const ChartLights* start_;
    ChartLights result_;
    std::array<double, 9> matrix_ = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    // Far from the solution everything looks like a shadow: the loss bends late at first.
    ceres::LossFunctionWrapper loss_{nullptr, ceres::DO_NOT_TAKE_OWNERSHIP};
    ceres::Problem problem_{[] {
        ceres::Problem::Options ownership;
        ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        return ownership;
    }()};
    std::array<std::vector<dvec3>, kChartPatches> evened_;  // readings over their light
};

void ChartLightFit::add_photograph(const ChartReading& photo, ChartLight& light) {
    const double white = white_of(photo);
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        if (!usable(photo, i)) continue;
        const PatchReading& reading = photo.patches[i];
        problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ReadingError, 3, 6, 9>(new ReadingError{
                                      dvec3(reading.mean), sigma_of(reading, white),
                                      dvec3(reference_.patches[i].linear), basis_at(static_cast<int>(i))}),
                                  &loss_, light.terms.data(), matrix_.data());
    }
}

bool ChartLightFit::add_photographs(int degree) {
    std::vector<double> whites;
    for (const ChartReading& photo : photos_)
        if (const double white = white_of(photo); white > 0) whites.push_back(white);
    const double dark = whites.empty() ? 0 : kDark * median(whites);
    bool fixed = false;
    for (std::size_t p = 0; p < photos_.size(); ++p) {
        ChartLight& light = result_.lights[p];
        light.dark = !(white_of(photos_[p]) > dark);
        if (light.dark || !is_lit(photos_[p])) continue;
        light.known = true;
        if (start_)
            light.terms = start_->lights[p].terms;
        else
            light.terms[0] = level_of(photos_[p], reference_);
        add_photograph(photos_[p], light);
        // The strength of all lights and of the matrix cannot be told apart: one of them is kept.
        std::vector<int> kept;
        if (!fixed) kept.push_back(0);
        if (degree == 1)
            for (const int quadratic : {3, 4, 5}) kept.push_back(quadratic);
        fixed = true;
        if (!kept.empty()) problem_.SetManifold(light.terms.data(), new ceres::SubsetManifold(6, kept));
    }
    return fixed;
}

void ChartLightFit::solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    for (const double bend : {40.0, 8.0, 1.0}) {
        if (start_ && bend > 1) continue;
        loss_.Reset(new ceres::CauchyLoss(kLossSigmas * bend), ceres::TAKE_OWNERSHIP);
        ceres::Solve(options, &problem_, &summary);
    }
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            result_.camera_of_reflectance[column][row] = matrix_[static_cast<std::size_t>(3 * row + column)];
}

void ChartLightFit::judge() {
    double squares = 0;
    int count = 0;
    const std::array<double, kChartPatches> usual = usual_ratios(photos_, result_, reference_);
    for (std::size_t p = 0; p < photos_.size(); ++p) {
        if (!result_.lights[p].known) continue;
        const double white = white_of(photos_[p]);
        for (std::size_t i = 0; i < kChartPatches; ++i) {
            const PatchReading& reading = photos_[p].patches[i];
            if (reading.state != PatchState::good) continue;
            const double light = std::exp(result_.lights[p].log_at(static_cast<int>(i)));
            const dvec3 expected =
                light * (result_.camera_of_reflectance * dvec3(reference_.patches[i].linear));
            // Shadows and highlights change the brightness; what a matrix cannot do is a matter of channels.
            const double off = brightness(dvec3(reading.mean)) - usual[i] * brightness(expected);
            result_.outliers[p][i] =
                std::abs(off) > kOutlier * brightness(expected) + kOutlierFloor * 4 * white;
            if (result_.outliers[p][i]) continue;
            evened_[i].push_back(dvec3(reading.mean) / light);
            const double relative = brightness(dvec3(reading.mean) - expected) / brightness(expected);
            squares += relative * relative;
            ++count;
        }
    }
    result_.residual = count ? std::sqrt(squares / count) : 0;
    even_out();
}

// Patches under even light: means over the photographs, with standard errors.
void ChartLightFit::even_out() {
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        const std::vector<dvec3>& values = evened_[i];
        result_.photos[i] = static_cast<int>(values.size());
        if (values.empty()) continue;
        const double n = static_cast<double>(values.size());
        dvec3 mean(0), square(0);
        for (const dvec3& v : values) mean += v / n;
        for (const dvec3& v : values) square += (v - mean) * (v - mean);
        result_.even[i] = mean;
        if (values.size() > 1) result_.even_sigma[i] = glm::sqrt(square / (n * (n - 1)));
    }
}

}  // namespace

ChartLights fit_chart_lights(std::span<const ChartReading> photos, const ChartReference& reference,
                             int degree, const std::array<bool, kChartPatches>& use,
                             const ChartLights* start) {
    TP_REQUIRE(degree == 1 || degree == 2, "light is a plane or a paraboloid");
    ChartLightFit fit(photos, reference, use, start);
    if (fit.add_photographs(degree)) {
        fit.solve();
        fit.judge();
    }
    return fit.found();
}

}  // namespace tangi
