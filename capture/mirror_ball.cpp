#include "capture/mirror_ball.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/highlight_clusters.h"
#include "surface/error.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kLeastOutline = 0.3;      // outline_score() of a circle that is taken for a ball
constexpr double kGivenOutline = 0.2;      // of one where the user says that there is a ball
constexpr double kLeastFound = 0.5;        // [1] part of the photographs that must show a highlight on a ball
constexpr double kLeastFoundGiven = 0.25;  // likewise, where the user gives the ball

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

// The best circle around a cluster of highlights. They lie within 0.71 radii for lamps in front of the
// camera's plane, and anywhere in the ball for few lamps.
std::optional<Circle> circle_around(const EdgeField& field, const HighlightCluster& cluster) {
    CircleSearch search;
    search.inside = cluster.places_px;
    // A few spots may lie off the ball.
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

BallImage image_of(const Circle& circle) {
    return {.centre_px = circle.centre_px,
            .radius_px = circle.radius_px,
            .centre_sigma_px = 0.02 * circle.radius_px,
            .radius_sigma_px = 0.02 * circle.radius_px};
}

bool overlap(const BallImage& a, const BallImage& b) {
    return glm::length(a.centre_px - b.centre_px) < 0.7 * (a.radius_px + b.radius_px);
}

struct Candidate {
    BallImage image;
    const GivenBall* given = nullptr;
    double score = 0;
    bool outline_seen = true;
};

std::vector<Candidate> sought(const GreyPhotos& photos, const EdgeField& field) {
    const auto& peaks = photos.reduction == 1 ? photos.mean : photos.brightest;
    const Image<float> median = median_of(peaks);
    std::vector<std::vector<HighlightSpot>> spots;
    for (const Image<float>& photo : peaks) spots.push_back(highlight_spots(photo, median));
    std::vector<Candidate> candidates;
    for (const HighlightCluster& cluster : highlight_clusters(spots, median.width(), median.height()))
        if (const auto circle = circle_around(field, cluster))
            candidates.push_back({.image = image_of(in_full(*circle, photos)), .score = circle->score});
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    std::vector<Candidate> apart;
    for (const Candidate& candidate : candidates)
        if (std::none_of(apart.begin(), apart.end(),
                         [&](const auto& other) { return overlap(other.image, candidate.image); }))
            apart.push_back(candidate);
    return apart;
}

std::vector<Candidate> sought_where_given(const GreyPhotos& photos, const EdgeField& field,
                                          std::span<const GivenBall> given) {
    std::vector<Candidate> candidates;
    for (const GivenBall& ball : given) {
        require_in_picture(ball, photos.width, photos.height);
        const auto circle = circle_near(field, photos, ball);
        candidates.push_back({.image = image_of(circle.value_or(Circle{ball.centre_px, ball.radius_px, 0})),
                              .given = &ball,
                              .score = circle ? circle->score : 0,
                              .outline_seen = circle.has_value()});
    }
    return candidates;
}

// Measures outline and highlights. A ball that the user gave is kept as given where its outline does not
// show.
FoundBall measured(const Candidate& candidate, BallCrops crops, const BallCamera& camera,
                   std::vector<std::string>& warnings) {
    FoundBall ball{
        .image = candidate.image, .name = {}, .given = candidate.given != nullptr, .crops = std::move(crops)};
    const auto outline =
        candidate.outline_seen ? refine_outline(ball.crops, candidate.image, camera) : std::nullopt;
    if (outline) {
        ball.image = outline->ball;
        ball.outline_coverage = outline->coverage;
        ball.outline_residual_px = outline->residual_px;
    } else if (candidate.given) {
        warnings.push_back(
            fmt::format("--sphere {}: the ball's outline does not show in the photographs; it is taken "
                        "as given, to 2 % of its radius",
                        candidate.given->text));
    }
    ball.highlights = find_highlights(ball.crops, ball.image, camera);
    return ball;
}

}  // namespace

int FoundBall::highlights_found() const {
    return static_cast<int>(std::count_if(highlights.begin(), highlights.end(), [](const Highlight& h) {
        return h.state == HighlightState::found;
    }));
}

void require_in_picture(const GivenBall& given, int width, int height) {
    if (given.centre_px.x < 0 || given.centre_px.y < 0 || given.centre_px.x > width - 1 ||
        given.centre_px.y > height - 1)
        fail("--sphere {}: its centre does not lie in the photographs, which are {} x {}", given.text, width,
             height);
    if (given.radius_px < 4 || given.radius_px > std::max(width, height))
        fail("--sphere {}: a ball must have a radius between 4 and {} pixels", given.text,
             std::max(width, height));
}

std::optional<Circle> circle_near(const EdgeField& field, const GreyPhotos& photos, const GivenBall& given) {
    const dvec2 centre(photos.reduced(given.centre_px.x), photos.reduced(given.centre_px.y));
    const double radius = given.radius_px / photos.reduction, loose = given.is_box ? 0.6 : 0.15;
    CircleSearch search;
    search.smallest_px = std::max(4.0, radius * (given.is_box ? 0.4 : 0.8));
    search.largest_px = radius * (given.is_box ? 1.1 : 1.2);
    search.centres = within(centre.x - loose * radius - 1, centre.y - loose * radius - 1,
                            centre.x + loose * radius + 2, centre.y + loose * radius + 2, field);
    const std::vector<Circle> circles = find_circles(field, search);
    if (circles.empty() || circles.front().score < kGivenOutline) return std::nullopt;
    return in_full(circles.front(), photos);
}

BallSearch find_mirror_balls(const PhotoSet& set, const GreyPhotos& photos, const CameraShakes& drifts,
                             const BallCamera& camera, std::span<const GivenBall> given,
                             const Progress& progress) {
    report(progress, "find balls", 0);
    const EdgeField field = edge_field(photos.mean, photos.step);
    report(progress, "find balls", 0.5);
    const std::vector<Candidate> candidates =
        given.empty() ? sought(photos, field) : sought_where_given(photos, field, given);
    report(progress, "find balls", 1);
    std::vector<BallImage> images;
    for (const Candidate& candidate : candidates) images.push_back(candidate.image);
    std::vector<BallCrops> crops = read_ball_crops(set, photos, drifts, images, progress);
    BallSearch search;
    const double count = static_cast<double>(set.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        FoundBall ball = measured(candidates[i], std::move(crops[i]), camera, search.warnings);
        const int found = ball.highlights_found();
        if (found >= std::max(1.0, (ball.given ? kLeastFoundGiven : kLeastFound) * count) &&
            (ball.given || ball.outline_coverage > 0)) {
            search.balls.push_back(std::move(ball));
        } else if (ball.given) {
            search.warnings.push_back(
                fmt::format("--sphere {}: no mirror ball there: only {} of {} photographs show a highlight "
                            "on it; left out",
                            candidates[i].given->text, found, set.size()));
        }
    }
    if (search.balls.empty()) {
        std::string tried;
        for (const std::string& warning : search.warnings) tried += " " + warning + ".";
        const std::string message = fmt::format(
            "{}: no mirror ball found in the {} photographs.{} Give balls with --sphere X,Y,R (pixels from "
            "the top left), or add --uncalibrated: lights from the photographs of a nearly flat object alone",
            set.folder().string(), set.size(), tried);
        if (given.empty()) throw NoBallError(message);
        throw Error(message);
    }
    std::stable_sort(search.balls.begin(), search.balls.end(),
                     [](const auto& a, const auto& b) { return a.image.centre_px.y < b.image.centre_px.y; });
    for (std::size_t i = 0; i < search.balls.size(); ++i) {
        const dvec2 at = search.balls[i].image.centre_px;
        search.balls[i].name = fmt::format("ball {} at ({:.0f}, {:.0f})", i + 1, at.x, at.y);
    }
    return search;
}

}  // namespace tangi
