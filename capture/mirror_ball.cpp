#include "capture/mirror_ball.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/ball_candidates.h"
#include "capture/ball_sizes.h"
#include "capture/light_plausibility.h"
#include "surface/error.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kLeastFound = 0.65;       // [1] part of the photographs that must show a highlight on a ball
constexpr double kLeastFoundGiven = 0.25;  // likewise, where the user gives the ball
constexpr double kLeastFoundTwin = 0.1;    // likewise, of one that shows the same lamps as another does
constexpr double kMostBelow = 0.1;  // [1] of the highlights that may come from lamps behind the painting
constexpr double kSameLamp = 0.6;   // [rad] between what two balls say of a near lamp

// Measures outline and highlights. A ball that the user gave is kept as given where its outline does not
// show.
FoundBall measured(const BallCandidate& candidate, BallCrops crops, const BallCamera& camera,
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
void take_given(FoundBall ball, const BallCandidate& candidate, const BallCamera& camera,
                BallSearch& search) {
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

namespace {

// Balls of a stack, as they are found.
class BallFinder {
public:
    BallFinder(const PhotoSet& set, const GreyPhotos& photos, const CameraShakes& drifts,
               const BallCamera& camera, const Progress& progress)
        : set_(set),
          photos_(photos),
          drifts_(drifts),
          camera_(camera),
          progress_(progress),
          field_(edge_field(photos.mean, photos.step)) {}

    void find_given(std::span<const GivenBall> given) {
        const std::vector<BallCandidate> candidates =
            sought_where_given(photos_, field_, given, search.warnings);
        std::vector<FoundBall> balls = measured_all(candidates);
        for (std::size_t i = 0; i < candidates.size(); ++i)
            take_given(std::move(balls[i]), candidates[i], camera_, search);
    }
    void find(const std::optional<double>& expected_px);

    BallSearch search;

private:
    std::vector<FoundBall> measured_all(const std::vector<BallCandidate>& all) {
        std::vector<BallImage> images;
        for (const BallCandidate& candidate : all) images.push_back(candidate.image);
        std::vector<BallCrops> crops = read_ball_crops(set_, photos_, drifts_, images, progress_);
        std::vector<FoundBall> balls;
        for (std::size_t i = 0; i < all.size(); ++i)
            balls.push_back(measured(all[i], std::move(crops[i]), camera_, search.warnings));
        return balls;
    }
    void add_twins(const std::vector<BallImage>& known);

    const PhotoSet& set_;
    const GreyPhotos& photos_;
    const CameraShakes& drifts_;
    const BallCamera& camera_;
    const Progress& progress_;
    const EdgeField field_;
};

void BallFinder::find(const std::optional<double>& expected_px) {
    std::vector<BallImage> known;
    for (FoundBall& ball : measured_all(sought(photos_, field_))) {
        known.push_back(ball.image);
        take_found(std::move(ball), camera_, photos_, drifts_, search);
    }
    const auto as_expected = [&](const FoundBall& ball) {
        return is_of_size(ball.image.radius_px, *expected_px);
    };
    if (expected_px && std::none_of(search.balls.begin(), search.balls.end(), as_expected)) {
        std::vector<std::string> told = search.warnings;  // of circles that nothing but a number speaks for
        for (FoundBall& ball : measured_all(of_expected_size(*expected_px, search.balls, photos_, field_)))
            take_found(std::move(ball), camera_, photos_, drifts_, search);
        search.warnings = std::move(told);
    }
    keep_one_size(search, expected_px);
    if (!search.balls.empty()) add_twins(known);
}

void BallFinder::add_twins(const std::vector<BallImage>& known) {
    const FoundBall first = search.balls.front();
    std::vector<BallImage> there = known;
    for (const FoundBall& ball : search.balls) there.push_back(ball.image);
    for (FoundBall& ball : measured_all(twins_of(first, there, photos_, field_))) {
        const int found = ball.highlights_found();
        if (found < std::max(2.0, kLeastFoundTwin * static_cast<double>(set_.size())) ||
            !(ball.outline_coverage > 0) || !shows_same_lamps(ball, first, camera_))
            continue;
        const dvec2 at = ball.image.centre_px;
        search.warnings.push_back(fmt::format(
            "ball at ({:.0f}, {:.0f}): shows the lamp in {} of {} photographs only; it is used in these",
            at.x, at.y, found, set_.size()));
        search.balls.push_back(std::move(ball));
    }
}

}  // namespace

BallSearch find_mirror_balls(const PhotoSet& set, const GreyPhotos& photos, const CameraShakes& drifts,
                             const BallCamera& camera, std::span<const GivenBall> given,
                             const std::optional<double>& expected_px, const Progress& progress) {
    report(progress, "find balls", 0);
    BallFinder finder(set, photos, drifts, camera, progress);
    report(progress, "find balls", 0.5);
    if (given.empty())
        finder.find(expected_px);
    else
        finder.find_given(given);
    report(progress, "find balls", 1);
    BallSearch search = std::move(finder.search);
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
