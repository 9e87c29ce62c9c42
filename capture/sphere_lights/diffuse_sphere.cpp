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

// The fit of value = brightness * n.l + ambient to a sphere's samples, with Tukey's weights.
class ShadingFit {
public:
    explicit ShadingFit(const std::vector<Sample>& samples) : samples_(samples) {
        std::vector<double> sorted;
        for (const Sample& sample : samples) sorted.push_back(sample.value);
        std::sort(sorted.begin(), sorted.end());
        bright_ = sorted[sorted.size() * 95 / 100];
        sigma_ = bright_;
    }
    double bright() const { return bright_; }
    // False where too little of the sphere is lit.
    bool solve() {
        for (int iteration = 0; iteration < 25; ++iteration)
            if (!improve(iteration == 0)) return false;
        return true;
    }
    // Nothing where it is none.
    std::optional<MattShading> shading(float step) const;

private:
    bool improve(bool first);

    const std::vector<Sample>& samples_;
    double bright_ = 0;  // value that 5 % exceed
    dvec4 fit_{0};       // brightness * direction, ambient
    double sigma_ = 0;   // of the residuals
    glm::dmat4 inverse_{0};
    double used_ = 0;  // samples, as they weigh
};

bool ShadingFit::improve(bool first) {
    glm::dmat4 normal(0);
    dvec4 right(0);
    used_ = 0;
    std::vector<double> residuals;
    const double length = glm::length(dvec3(fit_));
    for (const Sample& sample : samples_) {
        const bool lit =
            first ? sample.value > 0.3 * bright_ : glm::dot(sample.normal, dvec3(fit_)) > kLit * length;
        if (!lit) continue;
        const dvec4 row(sample.normal, 1);
        const double residual = sample.value - glm::dot(row, fit_);
        const double u = first ? 0 : residual / (4.685 * sigma_);
        if (!first) residuals.push_back(std::abs(residual));
        if (std::abs(u) >= 1) continue;
        const double weight = (1 - u * u) * (1 - u * u);
        normal += weight * glm::outerProduct(row, row);
        right += weight * sample.value * row;
        used_ += weight;
    }
    if (used_ < 0.05 * static_cast<double>(samples_.size()) || used_ < 30) return false;
    // A touch of damping: where only a small cap is lit, ambient light and brightness look alike.
    normal[3][3] += 1e-3 * used_;
    if (!(std::abs(glm::determinant(normal)) > 1e-12 * std::pow(used_, 4))) return false;
    inverse_ = glm::inverse(normal);
    fit_ = inverse_ * right;
    if (!residuals.empty()) sigma_ = std::max(median_of_values(residuals) / 0.6745, 1e-3 * bright_);
    return true;
}

std::optional<MattShading> ShadingFit::shading(float step) const {
    MattShading shading;
    shading.brightness = glm::length(dvec3(fit_));
    if (!(shading.brightness > 0)) return std::nullopt;
    shading.direction = dvec3(fit_) / shading.brightness;
    shading.ambient = fit_.w;
    // What shows no shade is no sphere under a light.
    if (std::abs(shading.ambient) > 0.5 * shading.brightness || shading.brightness < 10 * step)
        return std::nullopt;
    shading.residual = sigma_ / std::max(shading.brightness, bright_);
    shading.lit = used_ / static_cast<double>(samples_.size());
    const dvec3 l = shading.direction;
    double trace = 0;  // of the covariance across the direction
    for (int i = 0; i < 3; ++i) trace += inverse_[i][i];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) trace -= l[i] * inverse_[i][j] * l[j];
    shading.sigma_rad = sigma_ * std::sqrt(kPatchPx * std::max(trace, 0.0) / 2) / shading.brightness;
    return shading;
}

}  // namespace

std::optional<MattShading> shading_of(const SphereCrops& crops, std::size_t photo, const SphereImage& sphere,
                                      const SphereCamera& camera, const Transfer& transfer) {
    const std::vector<Sample> samples = samples_of(crops, photo, sphere, camera, transfer);
    if (samples.size() < 50) return std::nullopt;
    ShadingFit fit(samples);
    if (!(fit.bright() > 4 * crops.step * 0.05) || !fit.solve()) return std::nullopt;
    std::optional<MattShading> shading = fit.shading(crops.step);
    // The normals are as wrong as the sphere's place in the picture is.
    if (shading)
        shading->sigma_rad =
            std::hypot(shading->sigma_rad,
                       std::hypot(sphere.centre_sigma_px, sphere.radius_sigma_px / 2) / sphere.radius_px);
    return shading;
}

namespace {

// The search for the circle whose shading fits best.
class DiffuseSphereSearch {
public:
    DiffuseSphereSearch(const SphereStack& scene, const std::optional<Transfer>& transfer) : scene_(scene) {
        if (transfer) curves_ = {*transfer};
    }
    void find_circles();
    void shade_circles(const Progress& progress);
    // Throws Error where there is none.
    DiffuseSphere found();

private:
    // Its curve and shadings are those that fit best; how well they do.
    Quality shade(DiffuseSphere& candidate) const;
    void try_circle(const Circle& circle, const SphereImage& image, SphereCrops crops);

    const SphereStack& scene_;
    std::vector<Transfer> curves_ = {Transfer{}, {Transfer::Kind::srgb}, {Transfer::Kind::gamma, 2.2}};
    std::vector<Circle> circles_;
    std::optional<SphereImage> before_;
    DiffuseSphere best_;
    double best_score_ = -1;
};

void DiffuseSphereSearch::find_circles() {
    const EdgeField field = edge_field(scene_.photos.mean, scene_.photos.step);
    if (scene_.given.empty()) {
        circles_ = candidates(field, scene_.photos);
        return;
    }
    const GivenSphere& given = scene_.given[0];
    require_in_picture(given, scene_.photos.width, scene_.photos.height);
    std::string contradiction;
    const auto circle = circle_near(field, scene_.photos, given, contradiction);
    if (!contradiction.empty()) best_.poor.push_back(contradiction);
    before_ = before_of(given, circle.has_value(), contradiction);
    circles_ = {circle.value_or(Circle{given.centre_px, given.radius_px, 0})};
}

void DiffuseSphereSearch::shade_circles(const Progress& progress) {
    std::vector<SphereImage> images;
    for (const Circle& circle : circles_)
        images.push_back(
            {circle.centre_px, circle.radius_px, 0.02 * circle.radius_px, 0.02 * circle.radius_px});
    std::vector<SphereCrops> crops =
        read_sphere_crops(scene_.set, scene_.photos, scene_.drifts, images, progress);
    for (std::size_t i = 0; i < circles_.size(); ++i) try_circle(circles_[i], images[i], std::move(crops[i]));
}

Quality DiffuseSphereSearch::shade(DiffuseSphere& candidate) const {
    Quality quality;
    for (const Transfer& curve : curves_) {
        std::vector<std::optional<MattShading>> shadings;
        const Quality q =
            shade_all(candidate.sphere.crops, candidate.sphere.image, scene_.camera, curve, shadings);
        if (q.shaded < quality.shaded || !(q.residual < quality.residual)) continue;
        quality = q;
        candidate.transfer = curve;
        candidate.photos = std::move(shadings);
    }
    return quality;
}

void DiffuseSphereSearch::try_circle(const Circle& circle, const SphereImage& image, SphereCrops crops) {
    const bool given = !scene_.given.empty();
    FoundSphere sphere{.image = image,
                       .circle = image,
                       .before = before_,
                       .name = {},
                       .given = given,
                       .crops = std::move(crops)};
    std::vector<std::string> notes = best_.warnings;
    if (!find_outline(sphere, scene_.camera, given ? scene_.given[0].text : "", notes) && !given) return;
    DiffuseSphere candidate{.sphere = std::move(sphere),
                            .transfer = {},
                            .photos = {},
                            .warnings = std::move(notes),
                            .poor = best_.poor};
    const Quality quality = shade(candidate);
    if (2 * quality.shaded < static_cast<int>(scene_.set.size()) || quality.residual > kLargestMattResidual)
        return;
    // Of circles that shade alike the one with the clearest outline; a part of a sphere shades as well as all
    // of it.
    const double score = (circle.score + 0.1) * candidate.sphere.image.radius_px / (quality.residual + 0.02);
    if (score <= best_score_) return;
    best_score_ = score;
    candidate.residual = quality.residual;
    best_ = std::move(candidate);
}

DiffuseSphere DiffuseSphereSearch::found() {
    const std::span<const GivenSphere> given = scene_.given;
    if (best_score_ < 0)
        fail(
            "{}: no diffuse sphere {} whose shading fits a light's; give it with --sphere X,Y,R (pixels from "
            "the "
            "top left)",
            scene_.set.folder().string(), given.empty() ? "found" : "at --sphere " + given[0].text);
    const dvec2 at = best_.sphere.image.centre_px;
    best_.sphere.name = fmt::format("diffuse sphere at ({:.0f}, {:.0f})", at.x, at.y);
    for (const GivenSphere& more : given.subspan(std::min<std::size_t>(1, given.size())))
        best_.warnings.push_back(
            fmt::format("--sphere {}: only the first diffuse sphere is used", more.text));
    return std::move(best_);
}

}  // namespace

DiffuseSphere find_diffuse_sphere(const SphereStack& scene, const std::optional<Transfer>& transfer,
                                  const Progress& progress) {
    DiffuseSphereSearch search(scene, transfer);
    report(progress, "find spheres", 0);
    search.find_circles();
    report(progress, "find spheres", 1);
    search.shade_circles(progress);
    return search.found();
}

std::optional<DiffuseSphere> clear_diffuse_sphere(const SphereStack& scene,
                                                  const std::optional<Transfer>& transfer) {
    try {
        DiffuseSphere matt = find_diffuse_sphere(scene, transfer);
        if (matt.residual > kClearResidual || matt.sphere.outline_coverage < kClearOutline)
            return std::nullopt;
        return matt;
    } catch (const Error&) {
        return std::nullopt;
    }
}

}  // namespace tangi
