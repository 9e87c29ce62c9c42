#include "retouch/colour_match/film_match.h"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>

#include "paint/optics/spectrum_tables.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr double kStep = 1e-5;       // of finite differences, in logarithms of parts
constexpr double kLeastPart = 1e-4;  // relative to the first paint of a mixture
constexpr int kFree = kMostPaints - 1;

double film_inside(double k, double s, double thickness_mm, double below) {
    return film_reflectance(k * thickness_mm, s * thickness_mm, below);
}

// K of a film of this S that reflects `target` inside; bounded where no absorption reaches it.
double absorption_for(double target, double s, double thickness_mm, double below) {
    double low = 1e-6 * s, high = 1e4 * s;
    for (int i = 0; i < 50; ++i) {
        const double middle = std::sqrt(low * high);
        (film_inside(middle, s, thickness_mm, below) > target ? low : high) = middle;
    }
    return std::sqrt(low * high);
}

// The solver's view: logarithms of parts against the first paint's.
class Finish {
public:
    using Scalar = double;
    enum { NUM_RESIDUALS = FilmMatch::kResiduals, NUM_PARAMETERS = kFree };

    Finish(const FilmMatch& match, const Mixture& start, double power)
        : match_(match), start_(start), power_(power) {}

    bool operator()(const double* logs, double* residuals, double* jacobian) const {
        evaluate(logs, residuals);
        if (!jacobian) return true;
        std::fill(jacobian, jacobian + NUM_RESIDUALS * NUM_PARAMETERS, 0.0);
        for (int p = 0; p + 1 < start_.count; ++p) {
            double moved[kFree], beyond[NUM_RESIDUALS];
            std::copy(logs, logs + kFree, moved);
            moved[p] += kStep;
            evaluate(moved, beyond);
            for (int r = 0; r < NUM_RESIDUALS; ++r)
                jacobian[p * NUM_RESIDUALS + r] = (beyond[r] - residuals[r]) / kStep;
        }
        return true;
    }

    Mixture at(const double* logs) const {
        Mixture m = start_;
        double sum = m.volumes[0] = 1;
        for (int i = 1; i < m.count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            m.volumes[at] = std::exp(std::clamp(logs[i - 1], std::log(kLeastPart), -std::log(kLeastPart)));
            sum += m.volumes[at];
        }
        for (double& v : m.volumes) v /= sum;
        return m;
    }

private:
    // Residuals whose squares sum up to sum |difference|^power.
    void evaluate(const double* logs, double* residuals) const {
        match_.residuals(at(logs), residuals);
        for (int illuminant = 0; illuminant < kIlluminants; ++illuminant) {
            double* r = residuals + 3 * illuminant;
            if (power_ == 2) continue;
            const double squares = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
            const double factor = std::pow(squares + 1e-12, power_ / 4 - 0.5);
            for (int i = 0; i < 3; ++i) r[i] *= factor;
        }
    }

    const FilmMatch& match_;
    const Mixture& start_;
    double power_;
};

}  // namespace

FilmMatch::FilmMatch(std::span<const Pigment> paints, const Spectrum& target,
                     std::span<const Illuminant> illuminants, const std::optional<FilmOnGround>& film)
    : illuminants_(illuminants.begin(), illuminants.end()) {
    TP_REQUIRE(!paints.empty() && !illuminants.empty() && illuminants.size() <= kIlluminants,
               "paints and illuminants");
    for (const Pigment& paint : paints) {
        k_.emplace_back(), s_.emplace_back();
        double sum = 0;
        for (std::size_t band = 0; band < kBands; ++band) {
            k_.back()[band] = static_cast<double>(paint.k[band]);
            s_.back()[band] = static_cast<double>(paint.s[band]);
            sum += s_.back()[band];
        }
        mean_s_.push_back(std::max(sum / kBands, 1e-6));
    }
    for (const Illuminant illuminant : illuminants) {
        const glm::dvec3 white = white_xyz(illuminant);
        auto& weights = weights_.emplace_back();
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t band = 0; band < kBands; ++band)
                weights[c][band] =
                    static_cast<double>(kXyzWeights[static_cast<std::size_t>(illuminant)][c][band]) /
                    white[static_cast<int>(c)];
    }
    for (std::size_t band = 0; band < kBands; ++band) target_[band] = static_cast<double>(target[band]);
    for (std::size_t illuminant = 0; illuminant < weights_.size(); ++illuminant)
        target_lab_.push_back(lab_of(target_, illuminant));
    if (!film) return;
    if (!(film->thickness_mm > 0 && film->thickness_mm <= 10))
        fail("film of {} mm: is outside of (0, 10]", film->thickness_mm);
    film_mm_ = film->thickness_mm;
    for (std::size_t band = 0; band < kBands; ++band)
        below_inside_[band] =
            inside_of(static_cast<double>(film->below[band]), static_cast<double>(kInternalReflection));
}

void FilmMatch::look_of(const Mixture& m, Bands& reflectance) const {
    for (std::size_t band = 0; band < kBands; ++band) {
        double k = 0, s = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
            const auto paint = static_cast<std::size_t>(m.paints[i]);
            k += m.volumes[i] * k_[paint][band];
            s += m.volumes[i] * s_[paint][band];
        }
        const double inside =
            film_mm_ ? film_inside(k, s, *film_mm_, below_inside_[band]) : opaque_reflectance(k, s);
        reflectance[band] = outside_of(inside, static_cast<double>(kInternalReflection));
    }
}

Lab FilmMatch::lab_of(const Bands& reflectance, std::size_t illuminant) const {
    double f[3];
    for (std::size_t c = 0; c < 3; ++c) {
        double x = 0;
        for (std::size_t band = 0; band < kBands; ++band)
            x += weights_[illuminant][c][band] * reflectance[band];
        constexpr double epsilon = 216.0 / 24389, kappa = 24389.0 / 27;
        f[c] = x > epsilon ? std::cbrt(x) : (kappa * x + 16) / 116;
    }
    return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

Spectrum FilmMatch::look(const Mixture& mixture) const {
    Bands reflectance;
    look_of(mixture, reflectance);
    Spectrum look;
    std::transform(reflectance.begin(), reflectance.end(), look.begin(),
                   [](double r) { return static_cast<float>(r); });
    return look;
}

void FilmMatch::residuals(const Mixture& mixture, double* parts) const {
    Bands reflectance;
    look_of(mixture, reflectance);
    std::fill(parts, parts + kResiduals, 0.0);
    for (std::size_t illuminant = 0; illuminant < illuminants_.size(); ++illuminant) {
        const glm::dvec3 d = delta_e_2000_parts(target_lab_[illuminant], lab_of(reflectance, illuminant));
        for (int i = 0; i < 3; ++i) parts[3 * static_cast<int>(illuminant) + i] = d[i];
    }
}

std::vector<double> FilmMatch::differences(const Mixture& mixture) const {
    double parts[kResiduals];
    residuals(mixture, parts);
    std::vector<double> result;
    for (int illuminant = 0; illuminant < illuminants(); ++illuminant)
        result.push_back(
            std::hypot(parts[3 * illuminant], parts[3 * illuminant + 1], parts[3 * illuminant + 2]));
    return result;
}

double FilmMatch::error(const Mixture& mixture, MatchGoal goal) const {
    const std::vector<double> each = differences(mixture);
    if (goal == MatchGoal::worst) return *std::max_element(each.begin(), each.end());
    double sum = 0;
    for (const double d : each) sum += d;
    return sum / static_cast<double>(each.size());
}

std::vector<double> FilmMatch::gram() const {
    const int n = paints();
    // What K/S in each band gives the target, and how the look follows it.
    Bands q{}, slope{};
    const std::vector<double> by_s = [&] {
        std::vector<double> sorted = mean_s_;
        std::sort(sorted.begin(), sorted.end());
        return sorted;
    }();
    const double usual_s = by_s[by_s.size() / 2];
    for (std::size_t band = 0; band < kBands; ++band) {
        const double k2 = static_cast<double>(kInternalReflection);
        const double inside = std::clamp(inside_of(target_[band], k2), 0.002, 0.9995);
        const auto look_at = [&](double ratio) {
            return outside_of(film_mm_ ? film_inside(ratio * usual_s, usual_s, *film_mm_, below_inside_[band])
                                       : opaque_reflectance(ratio, 1.0),
                              k2);
        };
        q[band] = film_mm_ ? absorption_for(inside, usual_s, *film_mm_, below_inside_[band]) / usual_s
                           : k_over_s(inside);
        slope[band] = (look_at(q[band] * 1.001) - look_at(q[band])) / (0.001 * q[band]);
    }
    std::vector<std::array<double, kResiduals + kBands>> columns(static_cast<std::size_t>(n));
    std::array<Bands, kResiduals> jacobian{};
    for (std::size_t illuminant = 0; illuminant < illuminants_.size(); ++illuminant) {
        for (std::size_t band = 0; band < kBands; ++band) {
            Bands moved = target_;
            moved[band] += 1e-5;
            const glm::dvec3 d = delta_e_2000_parts(target_lab_[illuminant], lab_of(moved, illuminant));
            for (int i = 0; i < 3; ++i)
                jacobian[3 * illuminant + static_cast<std::size_t>(i)][band] = d[i] / 1e-5;
        }
    }
    for (std::size_t p = 0; p < columns.size(); ++p)
        for (std::size_t band = 0; band < kBands; ++band) {
            const double change = slope[band] * (k_[p][band] - q[band] * s_[p][band]) / mean_s_[p];
            for (std::size_t r = 0; r < kResiduals; ++r) columns[p][r] += jacobian[r][band] * change;
            // A little of the spectrum itself, so that one illuminant alone tells spectra apart that look the
            // same.
            columns[p][kResiduals + band] = change;
        }
    std::vector<double> product(static_cast<std::size_t>(n * n));
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (std::size_t r = 0; r < kResiduals + kBands; ++r)
                product[static_cast<std::size_t>(i * n + j)] +=
                    columns[static_cast<std::size_t>(i)][r] * columns[static_cast<std::size_t>(j)][r];
    return product;
}

Mixture FilmMatch::from_weights(const SubsetFit& fit) const {
    Mixture m;
    m.count = fit.count;
    m.paints = fit.columns;
    double sum = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(fit.count); ++i)
        sum += m.volumes[i] = fit.weights[i] / mean_s_[static_cast<std::size_t>(fit.columns[i])];
    for (double& v : m.volumes) v /= sum;
    return m;
}

Mixture FilmMatch::refined(const Mixture& start, MatchGoal goal) const {
    if (start.count < 2) return start;
    ceres::TinySolver<Finish>::Options options;
    options.max_num_iterations = 30;
    options.function_tolerance = 1e-6;
    options.parameter_tolerance = 1e-6;
    Mixture best = start;
    double least = error(start, goal);
    Eigen::Matrix<double, kFree, 1> logs = Eigen::Matrix<double, kFree, 1>::Zero();
    for (int i = 1; i < start.count; ++i)
        logs[i - 1] = std::log(std::max(start.volumes[static_cast<std::size_t>(i)], 1e-9) /
                               std::max(start.volumes[0], 1e-9));
    for (const double power : {2.0, 8.0}) {
        if (power > 2 && (goal != MatchGoal::worst || illuminants() < 2)) break;
        const Finish finish(*this, start, power);
        ceres::TinySolver<Finish> solver;
        solver.options = options;
        solver.Solve(finish, &logs);
        const Mixture found = finish.at(logs.data());
        const double reached = error(found, goal);
        if (reached < least) least = reached, best = found;
    }
    return best;
}

std::array<double, kMostPaints * kMostPaints> FilmMatch::curvature(const Mixture& mixture) const {
    double at[kResiduals], jacobian[kMostPaints][kResiduals] = {};
    residuals(mixture, at);
    for (int p = 0; p < mixture.count; ++p) {
        Mixture moved = mixture;
        moved.volumes[static_cast<std::size_t>(p)] *= 1 + kStep;
        double sum = 0;
        for (const double v : moved.volumes) sum += v;
        for (double& v : moved.volumes) v /= sum;
        residuals(moved, jacobian[p]);
        for (int r = 0; r < kResiduals; ++r) jacobian[p][r] = (jacobian[p][r] - at[r]) / kStep;
    }
    std::array<double, kMostPaints * kMostPaints> result{};
    for (int i = 0; i < mixture.count; ++i)
        for (int j = 0; j < mixture.count; ++j)
            for (int r = 0; r < kResiduals; ++r)
                result[static_cast<std::size_t>(i * kMostPaints + j)] += jacobian[i][r] * jacobian[j][r];
    return result;
}

}  // namespace tangi
