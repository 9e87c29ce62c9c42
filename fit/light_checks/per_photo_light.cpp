#include "fit/light_checks/per_photo_light.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "capture/radiometry/photometric_stereo.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

using Eigen::Vector2d;
using glm::dvec2;
using glm::dvec3;

namespace {

// Light times strength, and what varies slowly over the picture, to the second degree.
using ShownUnknowns = Eigen::Matrix<double, 8, 1>;
using ShownNormal = Eigen::Matrix<double, 8, 8>;

constexpr std::size_t kFewestPixels = 100;
constexpr int kMostLookedAt = 4000;
constexpr double kLeastLit = 0.03;     // [1] of what the pixel would reflect: shadow
constexpr double kTukeyShown = 4.685;  // [standard deviations] (Beaton and Tukey 1974)
constexpr int kShownSweeps = 8;
constexpr double kLeastUnclipped = 0.7;  // [1] of a photograph: what is left over is chosen by its shading
constexpr double kUnknownValue = std::numeric_limits<double>::quiet_NaN();

ShownUnknowns relief_row(const ReliefPixel& pixel) {
    const dvec2 at = pixel.place;
    const double z = pixel.g.z;
    ShownUnknowns row;
    row << pixel.g.x, pixel.g.y, z, z * at.x, z * at.y, z * at.x * at.x, z * at.x * at.y, z * at.y * at.y;
    return row / glm::length(pixel.g);
}

struct ShownSums {
    ShownNormal matrix = ShownNormal::Zero();
    ShownUnknowns right = ShownUnknowns::Zero();
    double squares = 0;

    ShownSums& operator+=(const ShownSums& o) {
        matrix += o.matrix, right += o.right, squares += o.squares;
        return *this;
    }
    // [1] Part of what is left over without a side that it explains.
    double explained() const {
        const ShownUnknowns found = solve_symmetric(matrix, right).x;
        const double all = squares - right.dot(found);
        const Eigen::Matrix<double, 6, 6> even = matrix.bottomRightCorner<6, 6>();
        const Eigen::Matrix<double, 6, 1> even_right = right.tail<6>(),
                                          even_found = solve_symmetric(even, even_right).x;
        const double without = squares - even_right.dot(even_found);
        return without > 0 ? std::clamp(1 - all / without, 0.0, 1.0) : 0;
    }
    // Light times strength, at the picture's middle.
    std::optional<Eigen::Vector3d> light() const {
        const SymmetricSolution solution = solve_symmetric(matrix, right);
        if (!(solution.rcond > 1e-9)) return std::nullopt;
        const Eigen::Vector3d light = solution.x.topRows<3>();
        if (!(light.head<2>().norm() > 0) || !std::isfinite(light.norm())) return std::nullopt;
        return light;
    }
};

// [rad] From above.
double zenith_of(const Eigen::Vector3d& light) { return std::atan2(light.head<2>().norm(), light.z()); }

}  // namespace

// [rad] Between two directions in the picture's plane.
double angle_between(const Vector2d& a, const Vector2d& b) {
    return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

std::vector<ReliefPixel> relief_pixels(const Survey& survey, const Transfer& transfer, std::size_t photos,
                                       int width, int height) {
    const auto channels = static_cast<std::size_t>(survey.channels);
    const double half = std::max(width, height) / 2.0;
    std::vector<ReliefPixel> pixels;
    for (const int k : survey.spread(kMostLookedAt)) {
        const glm::ivec2 at = survey.positions[static_cast<std::size_t>(k)];
        ReliefPixel pixel;
        pixel.place = {(at.x - width / 2.0) / half, (height / 2.0 - at.y) / half};
        pixel.part = std::min(kReliefParts * at.y / height, kReliefParts - 1) * kReliefParts +
                     std::min(kReliefParts * at.x / width, kReliefParts - 1);
        for (std::size_t i = 0; i < photos; ++i) {
            const float stored = survey.sample(k)[i * channels + channels / 2];
            pixel.values.push_back(std::isfinite(stored) && stored < kClipped
                                       ? static_cast<double>(transfer.decode(stored))
                                       : kUnknownValue);
        }
        pixels.push_back(std::move(pixel));
    }
    return pixels;
}

// g of each pixel from the photographs that are used.
void find_relief(std::vector<ReliefPixel>& pixels, const std::vector<Light>& lights,
                 const std::vector<bool>& used) {
    parallel_for(0, static_cast<int>(pixels.size()), 16, [&](int begin, int end) {
        PixelSamples samples;
        samples.resize(static_cast<int>(lights.size()), 1);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            samples.light[i] = dvec3(lights[i].direction);
            samples.irradiance[i] = static_cast<double>(lights[i].gain.g);
        }
        for (int k = begin; k < end; ++k) {
            ReliefPixel& pixel = pixels[static_cast<std::size_t>(k)];
            for (std::size_t i = 0; i < lights.size(); ++i) {
                const bool known = used[i] && !std::isnan(pixel.values[i]);
                samples.value[i] = known ? pixel.values[i] : 0;
                samples.sigma[i] = known ? 1 : 0;
            }
            const LambertEstimate estimate = photometric_stereo(samples);
            pixel.valid = estimate.valid && estimate.diffuse.x > 0;
            pixel.g = estimate.diffuse.x * estimate.normal;
        }
    });
}

namespace {

// Of a photograph: what the relief makes of a pixel, over how bright it is.
struct ShownSample {
    ShownUnknowns row;
    double value;
    int part;
    double weight = 1;
};

// Pixels that are lit; none where too few are.
std::vector<ShownSample> shown_samples(std::size_t photo, const std::vector<ReliefPixel>& pixels) {
    std::vector<ShownSample> samples;
    std::vector<double> brightness;
    for (const ReliefPixel& pixel : pixels)
        if (pixel.valid && !std::isnan(pixel.values[photo])) {
            const double value = pixel.values[photo] / glm::length(pixel.g);
            samples.push_back({relief_row(pixel), value, pixel.part});
            brightness.push_back(value);
        }
    const auto valid = static_cast<double>(
        std::count_if(pixels.begin(), pixels.end(), [](const ReliefPixel& p) { return p.valid; }));
    if (samples.size() < kFewestPixels || static_cast<double>(samples.size()) < kLeastUnclipped * valid)
        return {};
    const double dark = kLeastLit * median(brightness);
    std::erase_if(samples, [&](const ShownSample& s) { return s.value < dark; });
    if (samples.size() < kFewestPixels) return {};
    return samples;
}

// The sums of a regression, of the parts of the picture and of all.
struct ShownRegression {
    std::array<ShownSums, kReliefParts * kReliefParts> parts;
    ShownSums all;

    explicit ShownRegression(const std::vector<ShownSample>& samples) {
        for (const ShownSample& s : samples) {
            ShownSums& part = parts[static_cast<std::size_t>(s.part)];
            part.matrix += s.weight * s.row * s.row.transpose();
            part.right += s.weight * s.value * s.row;
            part.squares += s.weight * s.value * s.value;
        }
        for (const ShownSums& part : parts) all += part;
    }
};

// Tukey's weights of what a regression leaves over.
void weigh(const ShownSums& sums, std::vector<ShownSample>& samples) {
    const ShownUnknowns x = solve_symmetric(sums.matrix, sums.right).x;
    std::vector<double> residuals;
    for (const ShownSample& s : samples) residuals.push_back(std::abs(s.value - s.row.dot(x)));
    const double limit = kTukeyShown * std::max(1.4826 * median(residuals), 1e-12);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double r = residuals[i] / limit, w = std::max(1 - r * r, 0.0);
        samples[i].weight = w * w;
    }
}

// With standard errors by leaving out a part in turn. Nothing where a part decides.
std::optional<ShownLight> shown_light(const ShownRegression& regression) {
    const std::optional<Eigen::Vector3d> light = regression.all.light();
    if (!light) return std::nullopt;
    double side_squares = 0, zenith_squares = 0;
    int count = 0;
    for (const ShownSums& part : regression.parts) {
        if (!(part.matrix(0, 0) > 0)) continue;
        const ShownSums& all = regression.all;
        const auto without = ShownSums{all.matrix - part.matrix, all.right - part.right}.light();
        if (!without) return std::nullopt;
        const double turned = angle_between(without->head<2>(), light->head<2>());
        const double raised = zenith_of(*without) - zenith_of(*light);
        side_squares += turned * turned, zenith_squares += raised * raised, ++count;
    }
    if (count < kReliefParts) return std::nullopt;
    const double jackknife = static_cast<double>(count - 1) / count;  // (Quenouille 1956)
    return ShownLight{light->head<2>().normalized(), std::sqrt(side_squares * jackknife),
                      regression.all.explained(), zenith_of(*light), std::sqrt(zenith_squares * jackknife)};
}

}  // namespace

// The light that one photograph shows, by regression with Tukey's weights.
std::optional<ShownLight> per_photo_light(std::size_t photo, const std::vector<ReliefPixel>& pixels) {
    std::vector<ShownSample> samples = shown_samples(photo, pixels);
    if (samples.empty()) return std::nullopt;
    for (int sweep = 0; sweep + 1 < kShownSweeps; ++sweep) weigh(ShownRegression(samples).all, samples);
    return shown_light(ShownRegression(samples));
}

}  // namespace tangi
