#include "capture/spheres/sphere_candidates.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/spheres/given_outline.h"
#include "capture/spheres/highlight_clusters.h"
#include "capture/spheres/sphere_sizes.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kLeastOutline = 0.3;  // outline_score() of a circle that is taken for a sphere
constexpr double kGivenOutline = 0.2;  // of one where the user says that there is a sphere
constexpr double kClearer =
    1.5;  // by which another circle's edges must be clearer than those of what is given
// [1] By which it must also be better: patterns have circles, too.
constexpr double kClearlyBetter = 0.3;
constexpr double kHorizon =
    0.65;  // [1] of the radius; sin 45 degrees of a camera far away, less what outlines err
constexpr double kBoxError = 0.1;  // [1] of its size, by which a box is larger than what it is drawn around
constexpr double kExpectedSize = 1.2;  // ratio of radii within which circles are sought

Region within(double x0, double y0, double x1, double y1, const EdgeField& field) {
    const auto bound = [](double v, int end) { return std::clamp(static_cast<int>(std::lround(v)), 0, end); };
    return {bound(x0, field.width()), bound(y0, field.height()), bound(x1, field.width()),
            bound(y1, field.height())};
}

Circle in_full(Circle circle, const GreyPhotos& photos) {
    circle.centre_px = {photos.full(circle.centre_px.x), photos.full(circle.centre_px.y)};
    circle.radius_px *= photos.reduction;
    return circle;
}

// The best circle around a cluster of highlights. They lie within 0.71 radii for lights in front of the
// camera's plane, and anywhere in the sphere for few lights.
std::optional<Circle> circle_around(const EdgeField& field, const HighlightCluster& cluster) {
    CircleSearch search;
    search.inside = cluster.places_px;
    // A few spots may lie off the sphere.
    std::vector<double> distances;
    for (const dvec2& place : cluster.places_px) distances.push_back(glm::length(place - cluster.centre_px));
    std::sort(distances.begin(), distances.end());
    const double most = distances[(distances.size() - 1) * 4 / 5];
    search.smallest_px = std::max(5.0, 1.05 * most);
    search.largest_px = std::min(0.6 * std::min(field.width(), field.height()), 12 * cluster.radius_px + 12);
    if (search.largest_px <= search.smallest_px) return std::nullopt;
    const double reach = search.largest_px;
    search.centres = within(cluster.centre_px.x - reach, cluster.centre_px.y - reach,
                            cluster.centre_px.x + reach, cluster.centre_px.y + reach, field);
    const std::vector<Circle> circles = find_circles(field, search);
    if (circles.empty() || circles.front().score < kLeastOutline) return std::nullopt;
    return circles.front();
}

SphereImage image_of(const Circle& circle) {
    return {.centre_px = circle.centre_px,
            .radius_px = circle.radius_px,
            .centre_sigma_px = 0.02 * circle.radius_px,
            .radius_sigma_px = 0.02 * circle.radius_px};
}

// Circles anywhere in the picture of a radius [px] within a factor of `loose`.
std::vector<SphereCandidate> circles_of_size(double radius_px, double loose, const GreyPhotos& photos,
                                             const EdgeField& field) {
    CircleSearch search;
    const double radius = radius_px / photos.reduction;
    search.smallest_px = std::max(4.0, radius / loose);
    search.largest_px = loose * radius;
    search.centres = {0, 0, field.width(), field.height()};
    std::vector<SphereCandidate> candidates;
    for (const Circle& circle : find_circles(field, search)) {
        if (circle.score < kLeastOutline) break;
        candidates.push_back({.image = image_of(in_full(circle, photos)), .score = circle.score});
    }
    return candidates;
}

}  // namespace

std::vector<SphereCandidate> sought(const GreyPhotos& photos, const EdgeField& field) {
    const auto& peaks = photos.reduction == 1 ? photos.mean : photos.brightest;
    const Image<float> median = median_of(peaks);
    std::vector<std::vector<HighlightSpot>> spots;
    for (const Image<float>& photo : peaks) spots.push_back(highlight_spots(photo, median));
    std::vector<SphereCandidate> candidates;
    for (const HighlightCluster& cluster : highlight_clusters(spots, median.width(), median.height()))
        if (const auto circle = circle_around(field, cluster))
            candidates.push_back({.image = image_of(in_full(*circle, photos)), .score = circle->score});
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    std::vector<SphereCandidate> apart;
    for (const SphereCandidate& candidate : candidates)
        if (std::none_of(apart.begin(), apart.end(),
                         [&](const auto& other) { return cannot_both_be(other.image, candidate.image); }))
            apart.push_back(candidate);
    return apart;
}

std::vector<SphereCandidate> sought_where_given(const GreyPhotos& photos, const EdgeField& field,
                                                std::span<const GivenSphere> given,
                                                std::vector<std::string>& warnings) {
    std::vector<SphereCandidate> candidates;
    for (const GivenSphere& sphere : given) {
        require_in_picture(sphere, photos.width, photos.height);
        std::string contradiction;
        const auto circle = circle_near(field, photos, sphere, contradiction);
        SphereCandidate candidate{
            .image = image_of(circle.value_or(Circle{sphere.centre_px, sphere.radius_px, 0})),
            .before = before_of(sphere, circle.has_value(), contradiction),
            .given = &sphere,
            .score = circle ? circle->score : 0,
            .contradiction = std::move(contradiction)};
        const auto same =
            std::find_if(candidates.begin(), candidates.end(), [&](const SphereCandidate& other) {
                return cannot_both_be(other.before.value_or(other.image),
                                      candidate.before.value_or(candidate.image));
            });
        if (same == candidates.end())
            candidates.push_back(std::move(candidate));
        else
            warnings.push_back(fmt::format("--sphere {}: is the same sphere as --sphere {}; rejected",
                                           sphere.text, same->given->text));
    }
    return candidates;
}

std::vector<SphereCandidate> twins_of(const FoundSphere& sphere, const std::vector<SphereImage>& known,
                                      const GreyPhotos& photos, const EdgeField& field) {
    std::vector<SphereCandidate> candidates =
        circles_of_size(sphere.image.radius_px, kTwinSize, photos, field);
    std::erase_if(candidates, [&](const SphereCandidate& candidate) {
        return std::any_of(known.begin(), known.end(), [&](const SphereImage& other) {
            return is_of_size(other.radius_px, sphere.image.radius_px) &&
                   cannot_both_be(other, candidate.image);
        });
    });
    return candidates;
}

std::vector<SphereCandidate> of_expected_size(double radius_px, const std::vector<FoundSphere>& found,
                                              const GreyPhotos& photos, const EdgeField& field) {
    std::vector<SphereCandidate> candidates = circles_of_size(radius_px, kExpectedSize, photos, field);
    std::erase_if(candidates, [&](const SphereCandidate& candidate) {
        return std::any_of(found.begin(), found.end(), [&](const FoundSphere& other) {
            const dvec2 centre(photos.reduced(other.image.centre_px.x),
                               photos.reduced(other.image.centre_px.y));
            return cannot_both_be(other.image, candidate.image) &&
                   kClearer * candidate.score <
                       outline_score(field, centre, other.image.radius_px / photos.reduction);
        });
    });
    return candidates;
}

std::optional<SphereImage> before_of(const GivenSphere& given, bool circle_seen,
                                     const std::string& contradiction) {
    const SphereImage circle{.centre_px = given.centre_px, .radius_px = given.radius_px};
    if (!contradiction.empty() || (given.is_box && circle_seen)) return std::nullopt;
    SphereImage before = with_click_errors(circle);
    if (given.is_box) before.centre_sigma_px = before.radius_sigma_px = kBoxError * given.radius_px;
    return before;
}

void require_in_picture(const GivenSphere& given, int width, int height) {
    if (given.centre_px.x < 0 || given.centre_px.y < 0 || given.centre_px.x > width - 1 ||
        given.centre_px.y > height - 1)
        fail("--sphere {}: its centre does not lie in the photographs, which are {} x {}", given.text, width,
             height);
    if (given.radius_px < 4 || given.radius_px > std::max(width, height))
        fail("--sphere {}: a sphere must have a radius between 4 and {} pixels", given.text,
             std::max(width, height));
}

std::optional<Circle> circle_near(const EdgeField& field, const GreyPhotos& photos, const GivenSphere& given,
                                  std::string& contradiction) {
    const dvec2 centre(photos.reduced(given.centre_px.x), photos.reduced(given.centre_px.y));
    const double radius = given.radius_px / photos.reduction, loose = given.is_box ? 0.6 : 0.15;
    CircleSearch search;
    search.smallest_px = std::max(4.0, radius * (given.is_box ? 0.4 : 0.8));
    search.largest_px = radius * (given.is_box ? 1.1 : 1.2);
    search.centres = within(centre.x - loose * radius - 1, centre.y - loose * radius - 1,
                            centre.x + loose * radius + 2, centre.y + loose * radius + 2, field);
    const std::vector<Circle> circles = find_circles(field, search);
    const double here = circles.empty() ? 0 : circles.front().score;
    const bool near = !circles.empty() && here >= kGivenOutline;
    if (near && kClearer * here >= 1) return in_full(circles.front(), photos);
    CircleSearch wide = search;
    wide.smallest_px = std::max(4.0, 0.3 * radius);
    wide.largest_px = std::min(3 * radius, 0.6 * std::min(field.width(), field.height()));
    const double reach = std::max(loose * radius, 0.5 * wide.largest_px) + 1;
    wide.centres =
        within(centre.x - reach, centre.y - reach, centre.x + reach + 1, centre.y + reach + 1, field);
    for (const Circle& circle : find_circles(field, wide)) {
        if (circle.score < std::max(here + kClearlyBetter, kClearer * here)) break;
        if (glm::length(circle.centre_px - centre) > 0.5 * circle.radius_px) continue;
        if (circle.radius_px >= search.smallest_px && circle.radius_px <= search.largest_px) continue;
        // A mirror's horizon, and what lies before it, are rings inside its outline.
        if (circle.radius_px < search.smallest_px && circle.radius_px > kHorizon * radius) continue;
        const Circle seen = in_full(circle, photos);
        contradiction = fmt::format(
            "--sphere {}: what shows there is the outline of a circle of {:.1f} pixels around ({:.1f}, "
            "{:.1f}), and "
            "none of the size given; it is used instead. Give --sphere {:.0f},{:.0f},{:.0f} if that is the "
            "sphere",
            given.text, seen.radius_px, seen.centre_px.x, seen.centre_px.y, seen.centre_px.x,
            seen.centre_px.y, seen.radius_px);
        return seen;
    }
    if (!near) return std::nullopt;
    return in_full(circles.front(), photos);
}

}  // namespace tangi
