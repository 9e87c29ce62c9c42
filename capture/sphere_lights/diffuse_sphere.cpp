#include "capture/sphere_lights/diffuse_sphere.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <limits>

#include "capture/stack/survey.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

namespace {

constexpr double kInner = 0.93;  // [1] of the radius: outside, a pixel is not of the sphere alone
constexpr double kLit = 0.12;    // n.l from which on a normal is taken for lit, clear of the terminator
constexpr double kPatchPx = 25;  // pixels that count as one independent sample: the sphere's own texture
constexpr double kLargestMattResidual = 0.15;
constexpr double kClearResidual = 0.04;  // of a diffuse sphere that nobody spoke of
constexpr double kClearOutline = 0.25;   // [1] part of its outline that shows

struct Sample {
    dvec3 normal;
    double value = 0;
};

std::vector<Sample> samples_of(const SphereCrops& crops, std::size_t photo, const SphereImage& sphere,
                               const SphereCamera& camera, const Transfer& transfer) {
    std::vector<Sample> samples;
    for (int y = crops.region.y0; y < crops.region.y1; ++y)
        for (int x = crops.region.x0; x < crops.region.x1; ++x) {
            const float stored = crops.photos[photo](x - crops.region.x0, y - crops.region.y0);
            if (stored >= kClipped) continue;
            const dvec2 place = crops.to_common(photo, dvec2(x, y));
            if (outside_px(sphere, camera, place) > (kInner - 1) * sphere.radius_px) continue;
            if (const auto point = sphere_point(sphere, camera, place))
                samples.push_back({point->normal, transfer.decode(stored)});
        }
    return samples;
}

double median_of_values(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

struct Quality {
    double residual = std::numeric_limits<double>::infinity();  // mean, in the stored encoding
    int shaded = 0;
};

Quality shade_all(const SphereCrops& crops, const SphereImage& sphere, const SphereCamera& camera,
                  const Transfer& transfer, std::vector<std::optional<MattShading>>& shadings) {
    Quality quality;
    double sum = 0;
    shadings.clear();
    for (std::size_t i = 0; i < crops.photos.size(); ++i) {
        shadings.push_back(shading_of(crops, i, sphere, camera, transfer));
        if (!shadings.back() || !(shadings.back()->direction.z > 0)) continue;  // lights stand in front
        ++quality.shaded;
        sum += shadings.back()->residual;
    }
    if (quality.shaded > 0) quality.residual = sum / quality.shaded;
    return quality;
}

std::vector<Circle> candidates(const EdgeField& field, const GreyPhotos& photos) {
    CircleSearch search;
    const double shorter = std::min(field.width(), field.height());
    search.smallest_px = std::max(8.0, 0.04 * shorter);
    search.largest_px = 0.5 * shorter;
    search.centres = field.tensor.region();
    search.most = 10;
    std::vector<Circle> circles = find_circles(field, search);
    for (Circle& circle : circles) {
        circle.centre_px = {photos.full(circle.centre_px.x), photos.full(circle.centre_px.y)};
        circle.radius_px *= photos.reduction;
    }
    return circles;
}

}  // namespace

std::optional<MattShading> shading_of(const SphereCrops& crops, std::size_t photo, const SphereImage& sphere,
                                      const SphereCamera& camera, const Transfer& transfer) {
    const std::vector<Sample> samples = samples_of(crops, photo, sphere, camera, transfer);
    if (samples.size() < 50) return std::nullopt;
    std::vector<double> sorted;
    for (const Sample& sample : samples) sorted.push_back(sample.value);
    std::sort(sorted.begin(), sorted.end());
    const double bright = sorted[sorted.size() * 95 / 100];
    if (!(bright > 4 * crops.step * 0.05)) return std::nullopt;
    dvec4 fit(0);  // brightness * direction, ambient
    double sigma = bright;
    std::vector<double> residuals;
    glm::dmat4 inverse(0);
    double used = 0;
    for (int iteration = 0; iteration < 25; ++iteration) {
        glm::dmat4 normal(0);
        dvec4 right(0);
        used = 0;
        residuals.clear();
        const double length = glm::length(dvec3(fit));
        for (const Sample& sample : samples) {
            const bool lit = iteration == 0 ? sample.value > 0.3 * bright
                                            : glm::dot(sample.normal, dvec3(fit)) > kLit * length;
            if (!lit) continue;
            const dvec4 row(sample.normal, 1);
            const double residual = sample.value - glm::dot(row, fit);
            const double u = iteration == 0 ? 0 : residual / (4.685 * sigma);
            if (iteration > 0) residuals.push_back(std::abs(residual));
            if (std::abs(u) >= 1) continue;
            const double weight = (1 - u * u) * (1 - u * u);
            normal += weight * glm::outerProduct(row, row);
            right += weight * sample.value * row;
            used += weight;
        }
        if (used < 0.05 * static_cast<double>(samples.size()) || used < 30) return std::nullopt;
        // A touch of damping: where only a small cap is lit, ambient light and brightness look alike.
        normal[3][3] += 1e-3 * used;
        if (!(std::abs(glm::determinant(normal)) > 1e-12 * std::pow(used, 4))) return std::nullopt;
        inverse = glm::inverse(normal);
        fit = inverse * right;
        if (!residuals.empty()) sigma = std::max(median_of_values(residuals) / 0.6745, 1e-3 * bright);
    }
    MattShading shading;
    shading.brightness = glm::length(dvec3(fit));
    if (!(shading.brightness > 0)) return std::nullopt;
    shading.direction = dvec3(fit) / shading.brightness;
    shading.ambient = fit.w;
    // What shows no shade is no sphere under a light.
    if (std::abs(shading.ambient) > 0.5 * shading.brightness || shading.brightness < 10 * crops.step)
        return std::nullopt;
    shading.residual = sigma / std::max(shading.brightness, bright);
    shading.lit = used / static_cast<double>(samples.size());
    const dvec3 l = shading.direction;
    double trace = 0;  // of the covariance across the direction
    for (int i = 0; i < 3; ++i) trace += inverse[i][i];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) trace -= l[i] * inverse[i][j] * l[j];
    shading.sigma_rad = sigma * std::sqrt(kPatchPx * std::max(trace, 0.0) / 2) / shading.brightness;
    // The normals are as wrong as the sphere's place in the picture is.
    shading.sigma_rad = std::hypot(
        shading.sigma_rad, std::hypot(sphere.centre_sigma_px, sphere.radius_sigma_px / 2) / sphere.radius_px);
    return shading;
}

DiffuseSphere find_diffuse_sphere(const PhotoSet& set, const GreyPhotos& photos, const CameraMotions& drifts,
                                  const SphereCamera& camera, std::span<const GivenSphere> given,
                                  const std::optional<Transfer>& transfer, const Progress& progress) {
    report(progress, "find spheres", 0);
    const EdgeField field = edge_field(photos.mean, photos.step);
    std::vector<Circle> circles;
    std::optional<SphereImage> before;
    DiffuseSphere best;
    if (given.empty()) {
        circles = candidates(field, photos);
    } else {
        require_in_picture(given[0], photos.width, photos.height);
        std::string contradiction;
        const auto circle = circle_near(field, photos, given[0], contradiction);
        if (!contradiction.empty()) best.poor.push_back(contradiction);
        before = before_of(given[0], circle.has_value(), contradiction);
        circles = {circle.value_or(Circle{given[0].centre_px, given[0].radius_px, 0})};
    }
    report(progress, "find spheres", 1);
    std::vector<SphereImage> images;
    for (const Circle& circle : circles)
        images.push_back(
            {circle.centre_px, circle.radius_px, 0.02 * circle.radius_px, 0.02 * circle.radius_px});
    std::vector<SphereCrops> crops = read_sphere_crops(set, photos, drifts, images, progress);
    std::vector<Transfer> curves = {Transfer{}, {Transfer::Kind::srgb}, {Transfer::Kind::gamma, 2.2}};
    if (transfer) curves = {*transfer};
    double best_score = -1;
    for (std::size_t i = 0; i < circles.size(); ++i) {
        FoundSphere sphere{.image = images[i],
                           .circle = images[i],
                           .before = before,
                           .name = {},
                           .given = !given.empty(),
                           .crops = std::move(crops[i])};
        std::vector<std::string> notes = best.warnings;
        if (!find_outline(sphere, camera, given.empty() ? "" : given[0].text, notes) && given.empty())
            continue;
        DiffuseSphere candidate{.sphere = std::move(sphere),
                                .transfer = {},
                                .photos = {},
                                .warnings = std::move(notes),
                                .poor = best.poor};
        Quality quality;
        for (const Transfer& curve : curves) {
            std::vector<std::optional<MattShading>> shadings;
            const Quality q =
                shade_all(candidate.sphere.crops, candidate.sphere.image, camera, curve, shadings);
            if (q.shaded < quality.shaded || !(q.residual < quality.residual)) continue;
            quality = q;
            candidate.transfer = curve;
            candidate.photos = std::move(shadings);
        }
        if (2 * quality.shaded < static_cast<int>(set.size()) || quality.residual > kLargestMattResidual)
            continue;
        // Of circles that shade alike the one with the clearest outline; a part of a sphere shades as well as
        // all of it.
        const double score =
            (circles[i].score + 0.1) * candidate.sphere.image.radius_px / (quality.residual + 0.02);
        if (score <= best_score) continue;
        best_score = score;
        candidate.residual = quality.residual;
        best = std::move(candidate);
    }
    if (best_score < 0)
        fail(
            "{}: no diffuse sphere {} whose shading fits a light's; give it with --sphere X,Y,R (pixels from "
            "the "
            "top left)",
            set.folder().string(), given.empty() ? "found" : "at --sphere " + given[0].text);
    const dvec2 at = best.sphere.image.centre_px;
    best.sphere.name = fmt::format("diffuse sphere at ({:.0f}, {:.0f})", at.x, at.y);
    for (const GivenSphere& more : given.subspan(std::min<std::size_t>(1, given.size())))
        best.warnings.push_back(fmt::format("--sphere {}: only the first diffuse sphere is used", more.text));
    return best;
}

std::optional<DiffuseSphere> clear_diffuse_sphere(const PhotoSet& set, const GreyPhotos& photos,
                                                  const CameraMotions& drifts, const SphereCamera& camera,
                                                  std::span<const GivenSphere> given,
                                                  const std::optional<Transfer>& transfer) {
    try {
        DiffuseSphere matt = find_diffuse_sphere(set, photos, drifts, camera, given, transfer);
        if (matt.residual > kClearResidual || matt.sphere.outline_coverage < kClearOutline)
            return std::nullopt;
        return matt;
    } catch (const Error&) {
        return std::nullopt;
    }
}

}  // namespace tangi
