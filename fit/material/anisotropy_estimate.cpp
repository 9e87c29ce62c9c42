#include "fit/material/anisotropy_estimate.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "fit/material/lobe_neighbour_prior.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kFree = kWardParameters + 2;
constexpr double kBound = 1.2 * kMostStretch;  // [1] of each number of the stretch, while it is looked for
constexpr double kPriorSigma = 0.5;            // [1] of both numbers, around 0
constexpr double kStretchSpread = 0.1;         // [1] of what a pixel says: other lobes than Ward's
constexpr double kWidestStretched = 0.6;       // [1] alpha from which on a lobe may be diffuse light
constexpr double kLeastGloss = 0.005;          // [1] rho_s from which on there is a lobe
// [1] Stretch below which a lobe is not anisotropic: relief finer than a pixel.
constexpr float kClearStretch = 0.1f;
constexpr int kLooksApart = 3;                     // [pixels] at most, between those that say how pixels look
constexpr int kNextAsked = 1, kFarthestAsked = 3;  // [asked pixels] how far neighbours are asked
constexpr double kOthers2 = 30;  // [1] squared, in standard errors: what is anisotropic some other way
constexpr float kAlikeStretched = 0.1f,
                kAlikeStretchedFloor = 0.04f;  // [1] relative difference of looks that are others, and noise
constexpr int kStretchIterations = 15;         // what is not found by then is told by neighbours
constexpr int kDirections = 6;
constexpr std::array kStarts = {0.35, 0.8};  // [1] s

// What ceres::TinySolver minimises: the residuals of a pixel, and the prior of its stretch.
class StretchFunction {
public:
    using Scalar = double;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kFree };

    StretchFunction(const WardResiduals& residuals, const WardBounds& bounds)
        : residuals_(residuals), bounds_(bounds) {}
    int NumResiduals() const { return residuals_.size() + 2; }
    bool operator()(const double* u, double* residuals, double* jacobian) const {
        double derivative[kFree];
        const WardVector theta = natural_of(u, bounds_, derivative);
        glm::dvec2 stretch;
        for (int i = 0; i < 2; ++i) {
            stretch[i] = kBound * std::sin(u[kWardParameters + i]);
            derivative[kWardParameters + i] = kBound * std::cos(u[kWardParameters + i]);
        }
        const int rows = NumResiduals();
        evaluate(theta, stretch, residuals, jacobian);
        if (jacobian)
            for (int column = 0; column < kFree; ++column)
                for (int row = 0; row < rows; ++row) jacobian[column * rows + row] *= derivative[column];
        return true;
    }

    // The same by natural parameters.
    void evaluate(const WardVector& theta, const glm::dvec2& stretch, double* residuals,
                  double* jacobian) const {
        const int inner = residuals_.size(), rows = inner + 2;
        residuals_.evaluate(theta.data(), stretch, residuals, jacobian);
        for (int i = 0; i < 2; ++i) residuals[inner + i] = stretch[i] / kPriorSigma;
        if (!jacobian) return;
        // From the last column on: two rows more in each.
        for (int column = kFree; column-- > 0;) {
            std::copy_backward(jacobian + column * inner, jacobian + (column + 1) * inner,
                               jacobian + column * rows + inner);
            for (int i = 0; i < 2; ++i)
                jacobian[column * rows + inner + i] = column == kWardParameters + i ? 1 / kPriorSigma : 0;
        }
    }

private:
    const WardResiduals& residuals_;
    WardBounds bounds_;
};

using StretchSolver = ceres::TinySolver<StretchFunction>;
using StretchMatrix = Eigen::Matrix<double, kFree, kFree>;
using Parameters = Eigen::Matrix<double, kFree, 1>;

struct Start {
    WardVector theta;
    glm::dvec2 stretch{0};
};

// What the model leaves out, relative to the matt part (as add_model_error() of ward_fit.cpp).
PixelSamples with_model_error(const PixelSamples& given, const WardEstimate& e, double model_error) {
    PixelSamples s = given;
    const double z = 1 / std::sqrt(1 + glm::dot(e.slope, e.slope));
    const glm::dvec3 normal = z * glm::dvec3(-e.slope, 1);
    for (int i = 0; i < s.photos(); ++i) {
        const auto photo = static_cast<std::size_t>(i);
        const double cosine = std::max(glm::dot(normal, s.light[photo]), 0.0) + s.ambient[photo];
        for (int c = 0; c < s.channels; ++c) {
            const auto at = static_cast<std::size_t>(i * s.channels + c);
            if (s.sigma[at] == 0) continue;
            const double matt = e.diffuse[c] * cosine * s.irradiance[at];
            const double sigma = std::hypot(s.sigma[at], model_error * std::max(matt, s.value[at]),
                                            (1 - s.visible[photo]) * matt);
            s.sigma[at] = std::copysign(sigma, s.sigma[at]);
        }
    }
    return s;
}

// The cheapest of a lobe that is anisotropic one way or another, at the estimate.
Start anisotropic_start(const WardResiduals& residuals, const Start& plain) {
    Start best = plain;
    double least = std::numeric_limits<double>::infinity();
    for (const double s : kStarts)
        for (int k = 0; k < kDirections; ++k) {
            const double angle = 2 * std::numbers::pi * k / kDirections;
            const glm::dvec2 stretch = s * glm::dvec2(std::cos(angle), std::sin(angle));
            const double cost = residuals.cost(plain.theta.data(), stretch);
            if (cost >= least) continue;
            least = cost;
            best.stretch = stretch;
        }
    return best;
}

// Ends at the minimum that is next to the start; returns its cost.
double solve(const StretchFunction& function, const WardBounds& bounds, int iterations, Start& start) {
    const WardVector u0 = unbounded_of(start.theta, bounds);
    Parameters u;
    for (int i = 0; i < kWardParameters; ++i) u[i] = u0[static_cast<std::size_t>(i)];
    for (int i = 0; i < 2; ++i) u[kWardParameters + i] = std::asin(start.stretch[i] / kBound);
    StretchSolver solver;
    solver.options.max_num_iterations = iterations;
    solver.options.parameter_tolerance = 1e-4;
    solver.options.function_tolerance = 1e-3;
    solver.options.initial_trust_region_radius = 1e3;
    const double cost = solver.Solve(function, &u).final_cost;
    start.theta = natural_of(u.data(), bounds, nullptr);
    for (int i = 0; i < 2; ++i) start.stretch[i] = kBound * std::sin(u[kWardParameters + i]);
    return cost;
}

// From the covariance of all, what the samples alone say of the stretch.
StretchEvidence evidence_at(const StretchFunction& function, const Start& found, int samples) {
    const int rows = function.NumResiduals();
    Eigen::VectorXd residuals(rows);
    Eigen::Matrix<double, Eigen::Dynamic, kFree> jacobian(rows, kFree);
    function.evaluate(found.theta, found.stretch, residuals.data(), jacobian.data());
    const double chi2 = std::max(residuals.squaredNorm() / std::max(samples - kFree, 1), 1.0);
    StretchMatrix information = jacobian.transpose() * jacobian;
    information.diagonal().array() += 1e-9;
    const StretchMatrix covariance = information.ldlt().solve(StretchMatrix::Identity());
    constexpr int a = kWardParameters, b = a + 1;
    const glm::dmat2 of_both(covariance(a, a), covariance(a, b), covariance(b, a), covariance(b, b));
    constexpr double prior = 1 / (kPriorSigma * kPriorSigma);
    const glm::dmat2 posterior = glm::inverse(of_both);
    const glm::dmat2 alone = (posterior - glm::dmat2(prior)) / chi2;
    const double trace = alone[0][0] + alone[1][1];
    if (!(trace > 1e-3) || !(glm::determinant(alone) > 1e-6 * trace * trace)) return {};
    // The prior drew it to 0.
    const glm::dvec2 stretch = glm::inverse(alone * chi2) * (posterior * found.stretch);
    const double length = glm::length(stretch);
    return {length > kBound ? stretch * (kBound / length) : stretch,
            glm::inverse(glm::inverse(alone) + glm::dmat2(kStretchSpread * kStretchSpread))};
}

// As many of them as have their middle in the middle.
EvenPlaces every_so_many(int pixels, int apart) {
    int count = (pixels - 1) / apart + 1;
    if ((pixels - 1 - (count - 1) * apart) % 2 != 0 && count > 1) --count;
    return {(pixels - 1 - (count - 1) * apart) / 2, apart, count};
}

// Whether a neighbour is anisotropic as the mean of those next to a pixel, by both their errors: 1 to 0.
double agreement(const StretchEvidence& neighbour, const StretchEvidence& mean) {
    const glm::dvec2 off = neighbour.stretch - mean.stretch;
    const glm::dmat2 covariance = glm::inverse(neighbour.information) + glm::inverse(mean.information);
    return square(std::max(1 - glm::dot(off, glm::inverse(covariance) * off) / kOthers2, 0.0));
}

Rgb look_at(const Surface& s, int x, int y) { return s.diffuse(x, y) + s.specular(x, y); }

// Whether pixels look alike, 1 to 0: Tukey's biweight, as of lobe_neighbour_prior.cpp.
double alikeness(const Rgb& other, const Rgb& look) {
    const float scale2 = square(kAlikeStretched * (look.r + look.g + look.b) / 3 + kAlikeStretchedFloor);
    const Rgb off = other - look;
    return square(std::max(1 - glm::dot(off, off) / (12 * scale2), 0.0f));
}

// What those around one that is asked say together: the ones that look like it and, of those farther away,
// are anisotropic as the ones next to it.
StretchEvidence pooled(const Surface& s, const Image<StretchEvidence>& evidence, const SampledPixels& asked,
                       int i, int j) {
    const Rgb look = look_at(s, asked.x.at(i), asked.y.at(j));
    const auto mean = [&](int reach, const StretchEvidence& near) {
        StretchEvidence sum;
        glm::dvec2 weighted(0);
        const bool known = glm::determinant(near.information) > 0;
        for (int v = std::max(j - reach, 0); v <= std::min(j + reach, asked.y.count - 1); ++v)
            for (int u = std::max(i - reach, 0); u <= std::min(i + reach, asked.x.count - 1); ++u) {
                const StretchEvidence& one = evidence(u, v);
                if (!(glm::determinant(one.information) > 0)) continue;
                double alike = alikeness(look_at(s, asked.x.at(u), asked.y.at(v)), look);
                if (alike > 0 && known) alike *= agreement(one, near);
                sum.information += alike * one.information;
                weighted += alike * (one.information * one.stretch);
            }
        if (glm::determinant(sum.information) > 0) sum.stretch = glm::inverse(sum.information) * weighted;
        return sum;
    };
    return mean(kFarthestAsked, mean(kNextAsked, {}));
}

// How those that say how pixels look do, each the median of itself and the four next to it: where a glint or
// a crack was fitted badly, it looks like nothing around. Not a number where nothing was measured.
Image<Rgb> looks_of(const Surface& s, const SampledPixels& asked) {
    const int columns = asked.look_x.count, rows = asked.look_y.count;
    Image<Rgb> looks(columns, rows, Rgb(std::numeric_limits<float>::quiet_NaN()));
    parallel_for(0, rows, 16, [&](int begin, int end) {
        for (int j = begin; j < end; ++j)
            for (int i = 0; i < columns; ++i) {
                std::array<std::array<float, 5>, 3> values;
                std::size_t count = 0;
                for (const auto& [u, v] :
                     {std::array{i, j}, {i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
                    if (u < 0 || u >= columns || v < 0 || v >= rows) continue;
                    const int x = asked.look_x.at(u), y = asked.look_y.at(v);
                    if (!(s.confidence(x, y) > 0)) {
                        if (count == 0) break;  // the pixel itself
                        continue;
                    }
                    const Rgb look = look_at(s, x, y);
                    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)][count] = look[c];
                    ++count;
                }
                if (count == 0) continue;
                for (int c = 0; c < 3; ++c) {
                    auto& of_channel = values[static_cast<std::size_t>(c)];
                    std::sort(of_channel.begin(), of_channel.begin() + count);
                    looks(i, j)[c] = (of_channel[(count - 1) / 2] + of_channel[count / 2]) / 2;
                }
            }
    });
    return looks;
}

// An asked pixel beside another one: how it is anisotropic, and how much it counts there.
struct Beside {
    Stretch stretch;
    float weight;
};

// How asked pixels are anisotropic, by themselves and those around them; not a number where nothing is known.
Image<Stretch> stretches_of_asked(const Surface& s, const Image<StretchEvidence>& evidence,
                                  const SampledPixels& asked) {
    constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
    Image<Stretch> told(asked.x.count, asked.y.count, Stretch(nothing));
    parallel_for(0, asked.y.count, 1, [&](int begin, int end) {
        for (int j = begin; j < end; ++j)
            for (int i = 0; i < asked.x.count; ++i) {
                if (!(s.confidence(asked.x.at(i), asked.y.at(j)) > 0)) continue;
                const StretchEvidence all = pooled(s, evidence, asked, i, j);
                if (glm::determinant(all.information) > 0) told(i, j) = stretch_of(all);
            }
    });
    return told;
}

// Pixels that are nearer to place i than to those beside it.
int begin_of(const EvenPlaces& places, int i) { return i == 0 ? 0 : places.at(i) - places.apart / 2; }
int end_of(const EvenPlaces& places, int i, int pixels) {
    return i == places.count - 1 ? pixels : begin_of(places, i + 1);
}

// Of place i from a pixel: 1 to 0.
float nearness_of(const EvenPlaces& places, int i, int pixel) {
    const float off = static_cast<float>(std::abs(places.at(i) - pixel)) / static_cast<float>(places.apart);
    return square(square(std::max(1 - off / kFarthestAsked, 0.0f)));
}

// The asked pixels around a pixel that look like it, as far as they are known.
void find_beside(const Surface& s, const Image<Stretch>& told, const SampledPixels& asked,
                 const glm::ivec2& pixel, const Rgb& look, std::vector<Beside>& beside) {
    const int u0 = asked.x.nearest(pixel.x), v0 = asked.y.nearest(pixel.y);
    beside.clear();
    for (int v = std::max(v0 - kFarthestAsked, 0); v <= std::min(v0 + kFarthestAsked, asked.y.count - 1); ++v)
        for (int u = std::max(u0 - kFarthestAsked, 0); u <= std::min(u0 + kFarthestAsked, asked.x.count - 1);
             ++u) {
            const float near = nearness_of(asked.x, u, pixel.x) * nearness_of(asked.y, v, pixel.y);
            if (!(near > 0) || std::isnan(told(u, v).x)) continue;
            const double alike = alikeness(look_at(s, asked.x.at(u), asked.y.at(v)), look);
            if (alike > 0) beside.push_back({told(u, v), near * static_cast<float>(alike)});
        }
}

// Their mean, or, where there are two kinds of them, that of the kind that has more weight: none where most
// are not anisotropic.
Stretch mode_of(std::span<const Beside> beside) {
    float all = 0, plain = 0;
    for (const auto& [stretch, weight] : beside) {
        all += weight;
        if (stretch == Stretch(0)) plain += weight;
    }
    Stretch found(0);
    if (2 * plain >= all) return found;
    for (const float reach : {std::numeric_limits<float>::infinity(), 1.0f, 0.8f, 0.6f}) {
        Stretch sum(0);
        float weights = 0;
        for (const auto& [stretch, weight] : beside) {
            const Stretch off = stretch - found;
            const float w = weight * square(std::max(1 - glm::dot(off, off) / (reach * reach), 0.0f));
            sum += w * stretch;
            weights += w;
        }
        if (!(weights > 0)) return found;
        found = sum / weights;
    }
    return found;
}

}  // namespace

StretchEvidence stretch_evidence(const PixelSamples& given, const WardEstimate& e,
                                 const WardFitOptions& options) {
    if (e.roughness > kWidestStretched || e.specular < kLeastGloss) return {};
    const PixelSamples samples = with_model_error(given, e, options.model_error);
    const WardResiduals residuals(samples, options.prior, options.robust_scale, options.reflectance_model);
    const StretchFunction function(residuals, options.bounds);
    Start plain{.theta = {e.slope.x, e.slope.y, std::log(e.roughness), e.specular, 0, 0, 0}};
    for (int c = 0; c < 3; ++c) plain.theta[static_cast<std::size_t>(kWardCommon + c)] = e.diffuse[c];
    Start anisotropic = anisotropic_start(residuals, plain);
    const double cost = solve(function, options.bounds, kStretchIterations, anisotropic);
    if (solve(function, options.bounds, kStretchIterations, plain) <= cost) anisotropic = plain;
    const auto used =
        std::count_if(samples.sigma.begin(), samples.sigma.end(), [](double v) { return v > 0; });
    return evidence_at(function, anisotropic, static_cast<int>(used));
}

Stretch stretch_of(const StretchEvidence& evidence) {
    constexpr double prior = 1 / (kPriorSigma * kPriorSigma);
    const glm::dmat2 covariance = glm::inverse(evidence.information + glm::dmat2(prior));
    const Stretch mean(covariance * (evidence.information * evidence.stretch));
    // As specular_colour_of(): what is small is nothing, what is large is kept.
    const float doubt2 = square(kClearStretch) + 2 * static_cast<float>(covariance[0][0] + covariance[1][1]);
    const float kept = std::max(1 - doubt2 / std::max(glm::dot(mean, mean), 1e-12f), 0.0f);
    const Stretch shrunk = kept * mean;
    const float s = glm::length(shrunk);
    return s > static_cast<float>(kMostStretch) ? shrunk * (static_cast<float>(kMostStretch) / s) : shrunk;
}

SampledPixels sampled_pixels(int width, int height) {
    // Odd multiples of odd distances: else what is in the middle is not the same from both ends.
    const int least =
        std::max(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(width) * height / kAsked))), 1);
    const int looks_apart = std::min(least | 1, kLooksApart);
    const int every = (least + looks_apart - 1) / looks_apart | 1;
    const auto asked = [&](const EvenPlaces& looks) {
        const EvenPlaces some = every_so_many(looks.count, every);
        return EvenPlaces{looks.at(some.first), every * looks_apart, some.count};
    };
    const EvenPlaces look_x = every_so_many(width, looks_apart), look_y = every_so_many(height, looks_apart);
    return {asked(look_x), asked(look_y), look_x, look_y};
}

Image<Stretch> lobe_stretches(const Surface& s, const Image<StretchEvidence>& evidence) {
    const SampledPixels asked = sampled_pixels(s.width(), s.height());
    const Image<Stretch> told = stretches_of_asked(s, evidence, asked);
    const Image<Rgb> looks = looks_of(s, asked);
    Image<Stretch> stretches(s.width(), s.height(), Stretch(0));
    parallel_for(0, asked.look_y.count, 1, [&](int begin, int end) {
        std::vector<Beside> beside;
        for (int j = begin; j < end; ++j)
            for (int i = 0; i < asked.look_x.count; ++i) {
                if (std::isnan(looks(i, j).r)) continue;
                find_beside(s, told, asked, {asked.look_x.at(i), asked.look_y.at(j)}, looks(i, j), beside);
                const Stretch stretch = mode_of(beside);
                // Those between look as the nearest.
                for (int v = begin_of(asked.look_y, j); v < end_of(asked.look_y, j, s.height()); ++v)
                    for (int u = begin_of(asked.look_x, i); u < end_of(asked.look_x, i, s.width()); ++u)
                        stretches(u, v) = stretch;
            }
    });
    return stretches;
}

}  // namespace tangi
