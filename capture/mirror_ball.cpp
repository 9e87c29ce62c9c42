#include "capture/mirror_ball.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/highlight_clusters.h"
#include "capture/light_plausibility.h"
#include "surface/error.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kLeastOutline = 0.3;      // outline_score() of a circle that is taken for a ball
constexpr double kGivenOutline = 0.2;      // of one where the user says that there is a ball
constexpr double kLeastFound = 0.65;       // [1] part of the photographs that must show a highlight on a ball
constexpr double kLeastFoundGiven = 0.25;  // likewise, where the user gives the ball
constexpr double kLeastFoundTwin = 0.1;    // likewise, of one that shows the same lamps as another does
constexpr double kMostBelow = 0.1;  // [1] of the highlights that may come from lamps behind the painting
constexpr double kClearer =
    1.5;  // by which another circle's edges must be clearer than those of what is given
constexpr double kSameLamp = 0.6;  // [rad] between what two balls say of a near lamp

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
    std::string contradiction{};
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
                                          std::span<const GivenBall> given,
                                          std::vector<std::string>& warnings) {
    std::vector<Candidate> candidates;
    for (const GivenBall& ball : given) {
        require_in_picture(ball, photos.width, photos.height);
        std::string contradiction;
        const auto circle = circle_near(field, photos, ball, contradiction);
        Candidate candidate{.image = image_of(circle.value_or(Circle{ball.centre_px, ball.radius_px, 0})),
                            .given = &ball,
                            .score = circle ? circle->score : 0,
                            .outline_seen = circle.has_value(),
                            .contradiction = std::move(contradiction)};
        const auto same = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& other) {
            return overlap(other.image, candidate.image);
        });
        if (same == candidates.end())
            candidates.push_back(std::move(candidate));
        else
            warnings.push_back(fmt::format("--sphere {}: is the same ball as --sphere {}; left out",
                                           ball.text, same->given->text));
    }
    return candidates;
}

// Measures outline and highlights. A ball that the user gave is kept as given where its outline does not
// show.
FoundBall measured(const Candidate& candidate, BallCrops crops, const BallCamera& camera,
                   std::vector<std::string>& warnings) {
    FoundBall ball{.image = candidate.image,
                   .circle = candidate.image,
                   .name = {},
                   .given = candidate.given != nullptr,
                   .crops = std::move(crops)};
    auto outline =
        candidate.outline_seen ? refine_outline(ball.crops, candidate.image, camera) : std::nullopt;
    // The lens that is given may be wrong.
    if (candidate.outline_seen && !outline && camera.focal_px)
        outline = refine_outline(ball.crops, candidate.image, {{}, camera.principal_px});
    if (outline) {
        ball.image = outline->ball;
        ball.outline_coverage = outline->coverage;
        ball.outline_residual_px = outline->residual_px;
        ball.elongation = outline->elongation;
    } else if (candidate.given) {
        warnings.push_back(
            fmt::format("--sphere {}: the ball's outline does not show in the photographs; it is taken "
                        "as given, to 2 % of its radius",
                        candidate.given->text));
    }
    ball.highlights = find_highlights(ball.crops, ball.image, camera);
    return ball;
}

std::vector<std::optional<glm::dvec3>> mirrored_directions(const FoundBall& ball, const BallCamera& camera) {
    std::vector<std::optional<glm::dvec3>> directions(ball.highlights.size());
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (ball.highlights[i].state != HighlightState::found) continue;
        if (const auto point = ball_point(ball.image, camera, ball.highlights[i].place_px))
            directions[i] = point->mirrored();
    }
    return directions;
}

// How many highlights would come from lamps behind the painting; such lie beyond 0.71 radii.
int from_below(const FoundBall& ball, const BallCamera& camera) {
    return static_cast<int>(
        std::count_if(ball.highlights.begin(), ball.highlights.end(), [&](const Highlight& h) {
            if (h.state != HighlightState::found) return false;
            const auto point = ball_point(ball.image, camera, h.place_px);
            return point && !(point->mirrored().z > 0);
        }));
}

// Why something that was found and not given is no mirror ball; empty where it may be one.
std::string why_none(const FoundBall& ball, const BallCamera& camera, const GreyPhotos& photos,
                     const CameraShakes& drifts) {
    const int found = ball.highlights_found(), below = from_below(ball, camera);
    const auto count = static_cast<double>(ball.highlights.size());
    if (found < kLeastFound * count)
        return fmt::format("only {} of {} photographs show a highlight on it", found, count);
    if (below >= 2 && below > kMostBelow * found)
        return fmt::format("{} of {} highlights would come from lamps behind the painting", below, found);
    const std::vector<std::optional<glm::dvec3>> directions = mirrored_directions(ball, camera);
    const ShadedCircle itself{ball.image.centre_px, 1.5 * ball.image.radius_px};
    if (const auto chance = chance_of_directions(photos, drifts, directions, {&itself, 1});
        chance && *chance > kLargestChance)
        return "the photographs are not shaded as the lamps that it shows would shade them";
    return {};
}

// A ball that nobody spoke of is one only where all speaks for it.
void take_found(FoundBall ball, const BallCamera& camera, const GreyPhotos& photos,
                const CameraShakes& drifts, BallSearch& search) {
    if (!(ball.outline_coverage > 0)) return;
    const std::string reason = why_none(ball, camera, photos, drifts);
    const dvec2 at = ball.image.centre_px;
    if (reason.empty())
        search.balls.push_back(std::move(ball));
    else
        search.warnings.push_back(fmt::format(
            "something round at ({:.0f}, {:.0f}) is taken for no mirror ball: {}; if it is one, give it "
            "with --sphere {:.0f},{:.0f},{:.0f}",
            at.x, at.y, reason, at.x, at.y, ball.image.radius_px));
}

// What the user says is believed where highlights show at all, and doubted where they cannot be a ball's.
void take_given(FoundBall ball, const Candidate& candidate, const BallCamera& camera, BallSearch& search) {
    const int found = ball.highlights_found();
    const auto count = static_cast<double>(ball.highlights.size());
    const std::string& text = candidate.given->text;
    if (found < std::max(1.0, kLeastFoundGiven * count)) {
        search.warnings.push_back(fmt::format(
            "--sphere {}: no mirror ball there: only {} of {} photographs show a highlight on it; left "
            "out{}{}",
            text, found, count, candidate.contradiction.empty() ? "" : "; ", candidate.contradiction));
        return;
    }
    if (!candidate.contradiction.empty()) search.poor.push_back(candidate.contradiction);
    if (const int below = from_below(ball, camera); below >= 2 && below > kMostBelow * found)
        search.poor.push_back(
            fmt::format("--sphere {}: {} of {} highlights would come from lamps behind the painting; is it a "
                        "mirror ball, and is "
                        "that its outline?",
                        text, below, found));
    search.balls.push_back(std::move(ball));
}

// Circles as large as a ball that was found, where it is not.
std::vector<Candidate> twins_of(const FoundBall& ball, const std::vector<BallImage>& known,
                                const GreyPhotos& photos, const EdgeField& field) {
    CircleSearch search;
    const double radius = ball.image.radius_px / photos.reduction;
    search.smallest_px = std::max(4.0, 0.88 * radius);
    search.largest_px = 1.13 * radius;
    search.centres = {0, 0, field.width(), field.height()};
    std::vector<Candidate> candidates;
    for (const Circle& circle : find_circles(field, search)) {
        if (circle.score < kLeastOutline) break;
        const Candidate candidate{.image = image_of(in_full(circle, photos)), .score = circle.score};
        if (std::none_of(known.begin(), known.end(),
                         [&](const BallImage& other) { return overlap(other, candidate.image); }))
            candidates.push_back(candidate);
    }
    return candidates;
}

// Whether a ball shows the lamps where another one does, in most photographs that both tell.
bool shows_same_lamps(const FoundBall& ball, const FoundBall& other, const BallCamera& camera) {
    const auto a = mirrored_directions(ball, camera), b = mirrored_directions(other, camera);
    int both = 0, same = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i] || !b[i]) continue;
        ++both;
        same += glm::length(glm::cross(*a[i], *b[i])) < std::sin(kSameLamp) && glm::dot(*a[i], *b[i]) > 0;
    }
    return both >= 2 && 4 * same >= 3 * both;
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

void measure_again(FoundBall& ball, const BallCamera& camera) {
    if (ball.outline_coverage > 0)
        if (const auto outline = refine_outline(ball.crops, ball.circle, camera)) {
            ball.image = outline->ball;
            ball.elongation = outline->elongation;
            ball.outline_coverage = outline->coverage;
            ball.outline_residual_px = outline->residual_px;
        }
    if (!ball.highlights.empty()) ball.highlights = find_highlights(ball.crops, ball.image, camera);
}

std::optional<Circle> circle_near(const EdgeField& field, const GreyPhotos& photos, const GivenBall& given,
                                  std::string& contradiction) {
    const dvec2 centre(photos.reduced(given.centre_px.x), photos.reduced(given.centre_px.y));
    const double radius = given.radius_px / photos.reduction, loose = given.is_box ? 0.6 : 0.15;
    CircleSearch search;
    search.smallest_px = std::max(4.0, radius * (given.is_box ? 0.4 : 0.8));
    search.largest_px = radius * (given.is_box ? 1.1 : 1.2);
    search.centres = within(centre.x - loose * radius - 1, centre.y - loose * radius - 1,
                            centre.x + loose * radius + 2, centre.y + loose * radius + 2, field);
    const std::vector<Circle> circles = find_circles(field, search);
    const bool near = !circles.empty() && circles.front().score >= kGivenOutline;
    if (near && kClearer * circles.front().score >= 1) return in_full(circles.front(), photos);
    CircleSearch wide = search;
    wide.smallest_px = std::max(4.0, 0.3 * radius);
    wide.largest_px = std::min(3 * radius, 0.6 * std::min(field.width(), field.height()));
    const double reach = std::max(loose * radius, 0.5 * wide.largest_px) + 1;
    wide.centres =
        within(centre.x - reach, centre.y - reach, centre.x + reach + 1, centre.y + reach + 1, field);
    for (const Circle& circle : find_circles(field, wide)) {
        if (circle.score < std::max(kLeastOutline, kClearer * (near ? circles.front().score : 0))) break;
        if (glm::length(circle.centre_px - centre) > 0.5 * circle.radius_px) continue;
        if (circle.radius_px >= search.smallest_px && circle.radius_px <= search.largest_px) continue;
        const Circle seen = in_full(circle, photos);
        contradiction = fmt::format(
            "--sphere {}: what shows there is the outline of a circle of {:.1f} pixels around ({:.1f}, "
            "{:.1f}), and "
            "none of the size given; it is used instead. Give --sphere {:.0f},{:.0f},{:.0f} if that is the "
            "ball",
            given.text, seen.radius_px, seen.centre_px.x, seen.centre_px.y, seen.centre_px.x,
            seen.centre_px.y, seen.radius_px);
        return seen;
    }
    if (!near) return std::nullopt;
    return in_full(circles.front(), photos);
}

BallSearch find_mirror_balls(const PhotoSet& set, const GreyPhotos& photos, const CameraShakes& drifts,
                             const BallCamera& camera, std::span<const GivenBall> given,
                             const Progress& progress) {
    report(progress, "find balls", 0);
    const EdgeField field = edge_field(photos.mean, photos.step);
    report(progress, "find balls", 0.5);
    BallSearch search;
    const std::vector<Candidate> candidates =
        given.empty() ? sought(photos, field) : sought_where_given(photos, field, given, search.warnings);
    report(progress, "find balls", 1);
    const auto measured_all = [&](const std::vector<Candidate>& all) {
        std::vector<BallImage> images;
        for (const Candidate& candidate : all) images.push_back(candidate.image);
        std::vector<BallCrops> crops = read_ball_crops(set, photos, drifts, images, progress);
        std::vector<FoundBall> balls;
        for (std::size_t i = 0; i < all.size(); ++i)
            balls.push_back(measured(all[i], std::move(crops[i]), camera, search.warnings));
        return balls;
    };
    std::vector<FoundBall> measured_balls = measured_all(candidates);
    std::vector<BallImage> known;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        FoundBall& ball = measured_balls[i];
        known.push_back(ball.image);
        if (ball.given)
            take_given(std::move(ball), candidates[i], camera, search);
        else
            take_found(std::move(ball), camera, photos, drifts, search);
    }
    if (given.empty() && !search.balls.empty()) {
        const FoundBall first = search.balls.front();
        for (FoundBall& ball : measured_all(twins_of(first, known, photos, field))) {
            const int found = ball.highlights_found();
            if (found < std::max(2.0, kLeastFoundTwin * static_cast<double>(set.size())) ||
                !(ball.outline_coverage > 0) || !shows_same_lamps(ball, first, camera))
                continue;
            const dvec2 at = ball.image.centre_px;
            search.warnings.push_back(fmt::format(
                "ball at ({:.0f}, {:.0f}): shows the lamp in {} of {} photographs only; it is used in these",
                at.x, at.y, found, set.size()));
            search.balls.push_back(std::move(ball));
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
