#include "capture/uncalibrated/uncalibrated.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "capture/radiometry/equal_intensity.h"
#include "capture/uncalibrated/relative_shading.h"
#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr std::size_t kFewestUncalibrated = 8;
constexpr double kFalloffTells = 0.6, kCurlTells = 0.3;  // [1] as UncalibratedLights has them
constexpr double kAnyAzimuth_deg = 52;  // standard deviation of what lies anywhere in a half turn
constexpr double kAlong = 0.5;          // [1] of what two factors do not explain that may go along with them
constexpr double kUncertain_deg = 5;    // [deg] what the user is told of

bool tells_azimuths(double curl, double falloff) { return curl <= kCurlTells || falloff >= kFalloffTells; }

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

// The rotation (and mirror image) under which photographs are brightest on the side of their light, as near
// lights make them, and how well it explains all of their falloff: 1 = entirely.
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

// What photographs, or a part of them, say.
struct StereoSolution {
    ShadingFactors factors;
    EqualStrength lights;
    MatrixXd t, slopes;  // turned, so that slopes are those of a surface
    double curl = 0, falloff = 0;
};

StereoSolution upgraded(const RelativeShading& shading, const ShadingFactors& factors, bool glossy) {
    StereoSolution s{.factors = factors, .lights = {}, .t = {}, .slopes = {}};
    s.lights =
        by_equal_strength(factors.right, shading.log_level + factors.level.array().log().matrix(), glossy);
    // 1 + value = 1 - slopes . t with t = g right: the shift is in the pixels' albedo.
    s.slopes = -factors.left * s.lights.g.inverse();
    s.t = s.lights.t;
    Matrix2d turn = least_curl(s.slopes, shading.width, shading.height, s.curl);
    const Matrix2d by_falloff = towards_falloff(s.t, shading.falloff, s.falloff);
    if (s.falloff > kFalloffTells && s.curl > kCurlTells) turn = by_falloff;
    s.slopes = s.slopes * turn.transpose();
    s.t = s.t * turn.transpose();
    return s;
}

StereoSolution solved(const RelativeShading& shading, bool glossy, const Progress& progress = {}) {
    return upgraded(shading, factored(shading, progress), glossy);
}

// Quarters of the picture, each by itself.
std::vector<StereoSolution> parts_solved(const RelativeShading& s) {
    std::vector<StereoSolution> parts;
    for (const int top : {0, s.height / 2})
        for (const int left : {0, s.width / 2}) {
            RelativeShading part = s;
            part.width = s.width / 2, part.height = s.height / 2;
            part.value.resize(static_cast<Index>(part.width) * part.height, s.value.cols());
            part.weight.resize(part.value.rows(), s.value.cols());
            for (Index y = 0; y < part.height; ++y) {
                const Index from = (top + y) * s.width + left;
                part.value.middleRows(y * part.width, part.width) = s.value.middleRows(from, part.width);
                part.weight.middleRows(y * part.width, part.width) = s.weight.middleRows(from, part.width);
            }
            parts.push_back(solved(part, true));
        }
    return parts;
}

glm::dvec3 direction_of(const Eigen::RowVector2d& t) { return glm::normalize(glm::dvec3(t(0), t(1), 1)); }

// [deg] Of each light: how much quarters of the picture differ from the whole, which is no better for being
// larger: what bends one quarter (gloss, light between relief, a tone curve) bends all; all that gloss makes
// of it, since that is told by the levels alone, what its own strength may have turned it by, the azimuth
// where nothing tells it, and what the shading that two factors do not explain would make of the elevations
// if it went along with them. What is wrong in all of it alike is not seen otherwise.
std::vector<double> errors_deg(const StereoSolution& all, const StereoSolution& matt,
                               const std::vector<StereoSolution>& parts, double strength_scatter) {
    const auto square_deg = [&](const StereoSolution& other, Index j) {
        const double side = (other.t.array() * all.t.array()).sum() < 0 ? -1 : 1;  // either reading
        const glm::dvec3 a = direction_of(all.t.row(j)), b = direction_of(side * other.t.row(j));
        const double deg = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
        return deg * deg;
    };
    const double photos = static_cast<double>(all.t.rows()), count = static_cast<double>(parts.size());
    // Of t = l.xy / l.z, the same for all lights, as shading is.
    const double explained = std::clamp(all.factors.explained, 0.1, 1.0);
    const double unexplained = kAlong * std::sqrt((1 - explained) / explained * all.t.squaredNorm() / photos);
    std::vector<double> sigmas;
    for (Index j = 0; j < all.t.rows(); ++j) {
        const glm::dvec3 l = direction_of(all.t.row(j));
        const double across = std::hypot(l.x, l.y);
        double spread = 0;
        for (const StereoSolution& part : parts) spread += square_deg(part, j);
        const double strength_deg =
            strength_scatter * l.z / std::max(across, 0.2) / std::sqrt(photos / 4) * 180 / std::numbers::pi;
        const double unexplained_deg =
            unexplained * l.z * std::sqrt((1 + l.z * l.z) / 2) * 180 / std::numbers::pi;
        const double azimuth_deg = tells_azimuths(all.curl, all.falloff) ? 0 : kAnyAzimuth_deg * across;
        sigmas.push_back(std::sqrt(spread / count + square_deg(matt, j) + strength_deg * strength_deg +
                                   azimuth_deg * azimuth_deg + unexplained_deg * unexplained_deg));
    }
    return sigmas;
}

void require_usable(const std::vector<Image<float>>& pictures) {
    if (pictures.size() < kFewestUncalibrated)
        fail("{} photographs; without spheres and without a lights file at least {} are needed",
             pictures.size(), kFewestUncalibrated);
    for (const Image<float>& picture : pictures)
        TP_REQUIRE(picture.region() == pictures.front().region(), "all pictures have one size");
    if (pictures.front().width() < 16 || pictures.front().height() < 16)
        fail("photographs of {} x {} are too small to find lights in", pictures.front().width(),
             pictures.front().height());
}

void add_warnings(UncalibratedLights& result) {
    if (const double middle = median(result.sigma_deg); middle > kUncertain_deg)
        result.warnings.push_back(fmt::format(
            "the directions are uncertain by {:.0f} degrees (median standard error), and the strength of the "
            "relief with their elevations; a mirror sphere would tell them",
            middle));
    if (result.explained < 0.5)
        result.warnings.push_back(fmt::format(
            "only {:.0f} % of the shading goes with distant lights on a matt relief: the directions are "
            "doubtful (shiny or flat object, or the camera moved)",
            100 * result.explained));
    if (result.strength_scatter > 0.25)
        result.warnings.push_back(fmt::format(
            "the lights seem to differ in strength by {:.0f} % (rms), though they are taken to be equal: "
            "elevations, and with them the strength of the relief, are doubtful",
            100 * result.strength_scatter));
    if (!tells_azimuths(result.curl, result.falloff))
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
    const StereoSolution matt = solved(shading, false, progress);
    if (!(matt.factors.left.array().square().mean() * matt.factors.right.array().square().mean() > 1e-7))
        fail("the photographs show no relief, from which alone the lights could be told");
    const StereoSolution glossy = upgraded(shading, matt.factors, true);
    const std::vector<StereoSolution> parts = parts_solved(shading);

    UncalibratedLights result;
    MatrixXd slopes = glossy.slopes, t = glossy.t;
    result.curl = glossy.curl, result.falloff = glossy.falloff;
    result.gloss = glossy.lights.gloss;
    const double skewness = -skewness_of_curvature(slopes, shading.width, shading.height);
    const bool as_it_is =
        glossy.falloff > kFalloffTells ? agreement_of(t, shading.falloff) > 0 : skewness >= 0;
    result.convexity = as_it_is ? skewness : -skewness;
    if (as_it_is == options.inverted) {
        slopes = -slopes, t = -t;
    }
    if (options.inverted) result.convexity = -result.convexity;

    for (Index j = 0; j < t.rows(); ++j) {
        result.directions.push_back(direction_of(t.row(j)));
        result.strengths.push_back(std::exp(glossy.lights.log_strengths[j]));
    }
    const double middle = median(result.strengths);
    for (double& strength : result.strengths) strength /= middle;
    result.strength_scatter =
        std::sqrt(glossy.lights.log_strengths.squaredNorm() / static_cast<double>(t.rows()));
    result.sigma_deg = errors_deg(glossy, matt, parts, result.strength_scatter);
    result.residual = glossy.factors.residual;
    result.explained = glossy.factors.explained;
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
