#include "capture/uncalibrated.h"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "capture/relative_shading.h"
#include "surface/error.h"
#include "surface/median.h"

namespace tangi {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr std::size_t kFewestPhotos = 8;
constexpr double kStrengthScale = 0.15;                  // [1] ln strength by which lamps differ at ease
constexpr double kMiddlingSigma = 0.2;                   // [1] of l.xy / l.z
constexpr double kFalloffTells = 0.6, kCurlTells = 0.3;  // [1] as UncalibratedLights has them

// What takes the factors r of the photographs to l.xy / l.z, but for a rotation and a mirror image: g r +
// shift, g upper triangular.
struct Upgrade {
    Matrix2d g;
    Vector2d shift;
    VectorXd log_strengths;  // of the photographs, less the common one
};

// ln of the strength that a photograph's level and its factor mean, less the common one.
struct EqualStrength {
    double log_level;
    Vector2d r;
    template <class T>
    bool operator()(const T* g, const T* log_strength, T* residual) const {
        const T x = g[0] * r[0] + g[1] * r[1] + g[3], y = g[2] * r[1] + g[4];
        residual[0] = (log_level + 0.5 * log(1.0 + x * x + y * y) - log_strength[0]) / kStrengthScale;
        return true;
    }
};

// Each pixel was divided by what it shows under a middling lamp, which shifts l.xy / l.z by that lamp's: near
// 0, as lamps stand all around.
struct MiddlingLamp {
    template <class T>
    bool operator()(const T* g, T* residual) const {
        residual[0] = g[3] / kMiddlingSigma;
        residual[1] = g[4] / kMiddlingSigma;
        return true;
    }
};

Upgrade upgrade(const MatrixXd& right, const VectorXd& log_level) {
    const double spread = std::sqrt(right.array().square().sum() / static_cast<double>(right.rows()) / 2);
    double least = std::numeric_limits<double>::infinity();
    Upgrade best{Matrix2d::Identity() / spread, Vector2d::Zero(), log_level};
    for (const double size : {0.3, 1.0, 2.0}) {  // [1] of l.xy / l.z to start from
        double g[5] = {size / spread, 0, size / spread, 0, 0}, common = log_level.mean();
        ceres::Problem problem;
        auto* robust = new ceres::CauchyLoss(2);
        for (Index j = 0; j < right.rows(); ++j)
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EqualStrength, 1, 5, 1>(
                                         new EqualStrength{log_level[j], right.row(j).transpose()}),
                                     robust, g, &common);
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<MiddlingLamp, 2, 5>(new MiddlingLamp),
                                 nullptr, g);
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = 200;
        options.num_threads = 1;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        if (!summary.IsSolutionUsable() || !(summary.final_cost < least) || !(std::abs(g[0] * g[2]) > 1e-12))
            continue;
        least = summary.final_cost;
        best.g << g[0], g[1], 0, g[2];
        best.shift << g[3], g[4];
        for (Index j = 0; j < right.rows(); ++j) {
            const Vector2d t = best.g * right.row(j).transpose() + best.shift;
            best.log_strengths[j] = log_level[j] + 0.5 * std::log(1 + t.squaredNorm()) - common;
        }
    }
    return best;
}

// Robust sums over the picture of products of c = p_y - q_x and d = p_x + q_y, from central differences.
struct Curl {
    double cc = 0, cd = 0, dd = 0;
};

template <class Visit>
void visit_derivatives(const MatrixXd& slopes, int width, int height, Visit&& visit) {
    const auto at = [&](int x, int y) { return static_cast<Index>(y) * width + x; };
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x) {
            const auto dx = (slopes.row(at(x + 1, y)) - slopes.row(at(x - 1, y))) / 2;
            const auto dy = (slopes.row(at(x, y - 1)) - slopes.row(at(x, y + 1))) / 2;  // y up
            visit(dx(0), dy(0), dx(1), dy(1));
        }
}

// The rotation (and mirror image) under which slopes have the least curl; `curl` as in UncalibratedLights.
Matrix2d least_curl(const MatrixXd& slopes, int width, int height, double& curl) {
    std::vector<double> sizes;
    visit_derivatives(slopes, width, height, [&](double px, double py, double qx, double qy) {
        sizes.push_back(px * px + py * py + qx * qx + qy * qy);
    });
    const double scale = 4 * median(std::move(sizes)) + 1e-12;
    Matrix2d best = Matrix2d::Identity();
    double least = std::numeric_limits<double>::infinity();
    for (const double mirror : {1.0, -1.0}) {
        Curl sum;
        visit_derivatives(slopes, width, height, [&](double px, double py, double qx, double qy) {
            qx *= mirror, qy *= mirror;
            const double w = 1 / (1 + (px * px + py * py + qx * qx + qy * qy) / scale);
            const double c = py - qx, d = px + qy;
            sum.cc += w * c * c, sum.cd += w * c * d, sum.dd += w * d * d;
        });
        // Turned by psi, the curl is c cos(psi) - d sin(psi): its square is least at
        const double psi = 0.5 * std::atan2(2 * sum.cd, sum.dd - sum.cc);
        for (const double a : {psi, psi + std::numbers::pi / 2}) {
            const double cosine = std::cos(a), sine = std::sin(a);
            const double energy =
                sum.cc * cosine * cosine - 2 * sum.cd * sine * cosine + sum.dd * sine * sine;
            const double all = sum.cc + sum.dd;
            if (all > 0 && energy / all < least) {
                least = energy / all;
                best << cosine, -sine * mirror, sine, cosine * mirror;
            }
        }
    }
    curl = std::isfinite(least) ? least : 1;
    return best;
}

// The rotation (and mirror image) under which photographs are brightest on the side of their lamp, as near
// lamps make them, and how well it explains all of their falloff: 1 = entirely.
Matrix2d towards_falloff(const MatrixXd& t, const MatrixXd& falloff, double& agreement) {
    MatrixXd l = t;
    for (Index j = 0; j < t.rows(); ++j) l.row(j) /= std::sqrt(1 + t.row(j).squaredNorm());
    const Matrix2d cross = falloff.transpose() * l;  // (Schoenemann 1966: orthogonal Procrustes)
    const Eigen::JacobiSVD<Matrix2d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sizes = std::sqrt(falloff.squaredNorm() * l.squaredNorm());
    agreement = sizes > 0 ? svd.singularValues().sum() / sizes : 0;
    return svd.matrixU() * svd.matrixV().transpose();
}

// [1] The same for a rotation that is given; negative: they are darkest there.
double agreement_of(const MatrixXd& t, const MatrixXd& falloff) {
    double sum = 0, squares = 0;
    for (Index j = 0; j < t.rows(); ++j) {
        const Vector2d l = t.row(j).transpose() / std::sqrt(1 + t.row(j).squaredNorm());
        sum += falloff.row(j).dot(l.transpose());
        squares += l.squaredNorm();
    }
    const double sizes = std::sqrt(falloff.squaredNorm() * squares);
    return sizes > 0 ? sum / sizes : 0;
}

// Skewness of the curvature, robust against single pixels; negative where tops are sharper than bottoms.
double skewness_of_curvature(const MatrixXd& slopes, int width, int height) {
    std::vector<double> curvature;
    visit_derivatives(slopes, width, height,
                      [&](double px, double, double, double qy) { curvature.push_back(px + qy); });
    std::sort(curvature.begin(), curvature.end());
    if (curvature.size() < 20) return 0;
    const std::size_t cut = curvature.size() / 100;
    double squares = 0, cubes = 0;
    for (std::size_t i = cut; i + cut < curvature.size(); ++i) {
        squares += curvature[i] * curvature[i];
        cubes += curvature[i] * curvature[i] * curvature[i];
    }
    const double n = static_cast<double>(curvature.size() - 2 * cut);
    return squares > 0 ? (cubes / n) / std::pow(squares / n, 1.5) : 0;
}

void require_usable(const std::vector<Image<float>>& pictures) {
    if (pictures.size() < kFewestPhotos)
        fail("{} photographs; without balls and without a lights file at least {} are needed",
             pictures.size(), kFewestPhotos);
    for (const Image<float>& picture : pictures)
        TP_REQUIRE(picture.region() == pictures.front().region(), "all pictures have one size");
    if (pictures.front().width() < 16 || pictures.front().height() < 16)
        fail("photographs of {} x {} are too small to find lights in", pictures.front().width(),
             pictures.front().height());
}

void add_warnings(UncalibratedLights& result) {
    if (result.explained < 0.5)
        result.warnings.push_back(fmt::format(
            "only {:.0f} % of the shading goes with distant lights on a matt relief: the directions are "
            "doubtful (shiny or flat object, or the camera moved)",
            100 * result.explained));
    if (result.strength_scatter > 0.25)
        result.warnings.push_back(fmt::format(
            "the lamps seem to differ in strength by {:.0f} % (rms), though they are taken to be equal: "
            "elevations, and with them the strength of the relief, are doubtful",
            100 * result.strength_scatter));
    if (result.curl > kCurlTells && result.falloff < kFalloffTells)
        result.warnings.push_back(
            "the slopes found do not fit together into a surface well: azimuths are doubtful");
    if (result.falloff < kFalloffTells && std::abs(result.convexity) < 0.05)
        result.warnings.push_back(
            "nothing in the relief tells hills from valleys: compare both readings in the report");
}

}  // namespace

UncalibratedLights uncalibrated_lights(const std::vector<Image<float>>& pictures, float clipped,
                                       const UncalibratedOptions& options, const Progress& progress) {
    require_usable(pictures);
    const RelativeShading shading = shading_of(pictures, clipped);
    const double known = shading.weight.sum() / static_cast<double>(shading.weight.size());
    if (known < 0.2)
        fail("only {:.0f} % of the pixels are lit and not clipped; the lights can't be told", 100 * known);
    const ShadingFactors factors = factored(shading, progress);
    if (!(factors.left.array().square().mean() * factors.right.array().square().mean() > 1e-7))
        fail("the photographs show no relief, from which alone the lights could be told");

    UncalibratedLights result;
    const Upgrade u = upgrade(factors.right, shading.log_level);
    // value = -slopes . t with t = g right: the shift is in the pixels' albedo.
    MatrixXd slopes = -factors.left * u.g.inverse();
    MatrixXd t = (factors.right * u.g.transpose()).rowwise() + u.shift.transpose();
    Matrix2d turn = least_curl(slopes, shading.width, shading.height, result.curl);
    const Matrix2d by_falloff = towards_falloff(t, shading.falloff, result.falloff);
    const bool near = result.falloff > kFalloffTells;
    if (near && result.curl > kCurlTells) turn = by_falloff;
    slopes = slopes * turn.transpose();
    t = t * turn.transpose();
    const double skewness = -skewness_of_curvature(slopes, shading.width, shading.height);
    const bool as_it_is = near ? agreement_of(t, shading.falloff) > 0 : skewness >= 0;
    result.convexity = as_it_is ? skewness : -skewness;
    if (as_it_is == options.inverted) {
        slopes = -slopes, t = -t;
    }
    if (options.inverted) result.convexity = -result.convexity;

    double squares = 0;
    for (Index j = 0; j < t.rows(); ++j) {
        const glm::dvec3 l = glm::normalize(glm::dvec3(t(j, 0), t(j, 1), 1));
        result.directions.push_back(l);
        result.strengths.push_back(std::exp(u.log_strengths[j]));
        squares += u.log_strengths[j] * u.log_strengths[j];
    }
    const double middle = median(result.strengths);
    for (double& strength : result.strengths) strength /= middle;
    result.strength_scatter = std::sqrt(squares / static_cast<double>(t.rows()));
    // A lamp's strength, off by the scatter, moves l.z by that part.
    for (const glm::dvec3& l : result.directions)
        result.sigma_deg.push_back(result.strength_scatter * l.z / std::max(std::hypot(l.x, l.y), 0.2) /
                                   std::sqrt(static_cast<double>(t.rows()) / 4) * 180 / std::numbers::pi);
    result.residual = factors.residual;
    result.explained = factors.explained;
    result.slopes = Image<glm::vec2>(shading.width, shading.height);
    for (Index i = 0; i < slopes.rows(); ++i)
        result.slopes.pixels()[static_cast<std::size_t>(i)] = {static_cast<float>(slopes(i, 0)),
                                                               static_cast<float>(slopes(i, 1))};
    add_warnings(result);
    report(progress, "lights", 1);
    return result;
}

Image<float> relief_picture(const Image<glm::vec2>& slopes) {
    Image<float> picture(slopes.width(), slopes.height());
    const glm::vec3 light = glm::normalize(glm::vec3(-1, 1, 1.2f));
    for (std::size_t i = 0; i < slopes.size(); ++i) {
        const glm::vec2& s = slopes.pixels()[i];
        picture.pixels()[i] =
            std::clamp(glm::dot(light, glm::normalize(glm::vec3(-2.0f * s, 1))), 0.0f, 1.0f);
    }
    return picture;
}

}  // namespace tangi
