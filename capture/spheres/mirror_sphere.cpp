#include "capture/spheres/mirror_sphere.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/spheres/ball_candidates.h"
#include "capture/spheres/ball_sizes.h"
#include "capture/spheres/given_outline.h"
#include "capture/spheres/light_plausibility.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kLeastFound = 0.65;       // [1] part of the photographs that must show a highlight on a ball
constexpr double kLeastFoundGiven = 0.25;  // likewise, where the user gives the ball
constexpr double kLeastFoundTwin = 0.1;    // likewise, of one that shows the same lamps as another does
constexpr double kMostBelow = 0.1;  // [1] of the highlights that may come from lamps behind the painting
constexpr double kSameLamp = 0.6;   // [rad] between what two balls say of a near lamp

// Measures outline and highlights.
FoundBall measured(const BallCandidate& candidate, BallCrops crops, const BallCamera& camera,
                   std::vector<std::string>& notes) {
    FoundBall ball{.image = candidate.image,
                   .circle = candidate.image,
                   .before = candidate.before,
                   .name = {},
                   .given = candidate.given != nullptr,
                   .crops = std::move(crops)};
    const std::string text = candidate.given ? candidate.given->text : "";
    // The lens that is given may be wrong.
    if (!find_outline(ball, camera, text, notes) && camera.focal_px)
        (void)find_outline(ball, {{}, camera.principal_px}, text, notes);
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

// How many photographs show the lamp, where that is too few, and what the others show instead.
std::string too_few(const FoundBall& ball) {
    std::string text = fmt::format("only {} of {} photographs show a highlight on it",
                                   ball.highlights_found(), ball.highlights.size());
    const std::pair<HighlightState, const char*> others[] = {
        {HighlightState::ambiguous,
         "show two that are about equally bright: leave one lamp on, or cover the mirror "
         "image of it"},
        {HighlightState::smeared, "show one that covers too much of it"},
        {HighlightState::off_ball, "show one across its outline"}};
    for (const auto& [state, words] : others)
        if (const int count = ball.highlights_in(state); count > 0)
            text += fmt::format("; {} {}", count, words);
    return text;
}

bool may_be_given(const FoundBall& ball) {
    return ball.highlights_found() >=
           std::max(1.0, kLeastFoundGiven * static_cast<double>(ball.highlights.size()));
}

// Why something that was found and not given is no mirror ball.
struct Objection {
    std::string reason{};         // empty where it may be one
    bool to_its_outline = false;  // what shows in the circle contradicts that it is a ball's outline
};

Objection objection_to(const FoundBall& ball, const BallCamera& camera, const GreyPhotos& photos,
                       const CameraShakes& drifts) {
    const int found = ball.highlights_found(), below = from_below(ball, camera);
    const auto count = static_cast<double>(ball.highlights.size());
    if (found < kLeastFound * count) return {too_few(ball)};
    if (below >= 2 && below > kMostBelow * found)
        return {fmt::format("{} of {} highlights would come from lamps behind the painting", below, found),
                true};
    const std::vector<std::optional<glm::dvec3>> directions = mirrored_directions(ball, camera);
    const ShadedCircle itself{ball.image.centre_px, 1.5 * ball.image.radius_px};
    if (const auto chance = chance_of_directions(photos, drifts, directions, {&itself, 1});
        chance && *chance > kLargestChance)
        return {"the photographs are not shaded as the lamps that it shows would shade them", true};
    return {};
}

// A ball that nobody spoke of is one only where all speaks for it.
void take_found(FoundBall ball, const BallCamera& camera, const GreyPhotos& photos,
                const CameraShakes& drifts, BallSearch& search) {
    if (!(ball.outline_coverage > 0)) return;
    const Objection objection = objection_to(ball, camera, photos, drifts);
    const dvec2 at = ball.image.centre_px;
    if (objection.reason.empty()) {
        search.balls.push_back(std::move(ball));
        return;
    }
    // No circle is recommended that would be refused, or that is none of a mirror ball.
    const std::string advice =
        objection.to_its_outline ? "; if there is a ball, give its outline with --sphere X,Y,R"
        : may_be_given(ball) ? fmt::format("; if it is one, give it with --sphere {:.0f},{:.0f},{:.0f}", at.x,
                                           at.y, ball.image.radius_px)
                             : "";
    search.warnings.push_back(
        fmt::format("something round at ({:.0f}, {:.0f}) is taken for no mirror ball: {}{}", at.x, at.y,
                    objection.reason, advice));
}

// What the user says is believed where highlights show at all, and doubted where they cannot be a ball's.
void take_given(FoundBall ball, const BallCandidate& candidate, std::vector<std::string> notes,
                const BallCamera& camera, BallSearch& search) {
    const int found = ball.highlights_found();
    const std::string& text = candidate.given->text;
    if (!may_be_given(ball)) {
        const bool shows_two =
            2 * ball.highlights_in(HighlightState::ambiguous) > std::ssize(ball.highlights);
        search.warnings.push_back(fmt::format(
            "--sphere {}: {}{}: {}; left out", text,
            shows_two ? "no lamp is told from the other there" : "no mirror ball there",
            candidate.contradiction.empty() ? "" : ", nor in the circle that shows", too_few(ball)));
        return;
    }
    const auto same = std::find_if(search.balls.begin(), search.balls.end(), [&](const FoundBall& other) {
        return cannot_both_be(other.image, ball.image);
    });
    if (same != search.balls.end()) {
        search.warnings.push_back(
            fmt::format("--sphere {}: is the same ball as the one at ({:.0f}, {:.0f}); left out", text,
                        same->image.centre_px.x, same->image.centre_px.y));
        return;
    }
    search.warnings.insert(search.warnings.end(), notes.begin(), notes.end());
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

int FoundBall::highlights_found() const { return highlights_in(HighlightState::found); }

int FoundBall::highlights_in(HighlightState state) const {
    return static_cast<int>(std::count_if(highlights.begin(), highlights.end(),
                                          [&](const Highlight& h) { return h.state == state; }));
}

bool find_outline(FoundBall& ball, const BallCamera& camera, const std::string& given_text,
                  std::vector<std::string>& warnings) {
    std::optional<BallOutline> outline = refine_outline(ball.crops, ball.circle, camera);
    if (ball.before) {
        const GivenOutline judged = judge_outline(ball.crops, *ball.before, outline, camera);
        ball.image = judged.ball;
        if (judged.verdict == OutlineVerdict::given) outline.reset();
        if (judged.verdict == OutlineVerdict::given && !given_text.empty())
            warnings.push_back(fmt::format(
                "--sphere {}: the ball's outline does not stand out from what is around it; the circle is "
                "taken as given{}, and taken to be right to {:.1f} pixels",
                given_text,
                judged.moved_px > 0 ? fmt::format(", but for {:.1f} pixels that edges tell", judged.moved_px)
                                    : "",
                std::max(ball.image.centre_sigma_px, ball.image.radius_sigma_px)));
        if (judged.verdict == OutlineVerdict::beside && !given_text.empty())
            warnings.push_back(fmt::format(
                "--sphere {}: the ball's outline is {:.1f} pixels from it, and is used: {:.1f},{:.1f},{:.1f}",
                given_text, judged.moved_px, ball.image.centre_px.x, ball.image.centre_px.y,
                ball.image.radius_px));
    } else if (outline) {
        widen_errors(ball.crops, *outline, camera);
        ball.image = outline->ball;
    }
    ball.outline_coverage = outline ? outline->coverage : 0;
    ball.outline_residual_px = outline ? outline->residual_px : 0;
    ball.elongation = outline ? outline->elongation : std::nullopt;
    return outline.has_value() || ball.before.has_value();
}

void measure_again(FoundBall& ball, const BallCamera& camera) {
    std::vector<std::string> told;
    if (ball.before || ball.outline_coverage > 0) {
        FoundBall again = ball;
        if (find_outline(again, camera, {}, told)) ball = std::move(again);
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
        std::vector<std::vector<std::string>> notes(candidates.size());
        std::vector<FoundBall> balls = measured_all(candidates, &notes);
        for (std::size_t i = 0; i < candidates.size(); ++i)
            take_given(std::move(balls[i]), candidates[i], std::move(notes[i]), camera_, search);
    }
    void find(const std::optional<double>& expected_px);

    BallSearch search;

private:
    // `notes`: for the user, on each of them.
    std::vector<FoundBall> measured_all(const std::vector<BallCandidate>& all,
                                        std::vector<std::vector<std::string>>* notes = nullptr) {
        std::vector<BallImage> images;
        for (const BallCandidate& candidate : all) images.push_back(candidate.image);
        std::vector<BallCrops> crops = read_ball_crops(set_, photos_, drifts_, images, progress_);
        std::vector<FoundBall> balls;
        std::vector<std::string> unsaid;
        for (std::size_t i = 0; i < all.size(); ++i)
            balls.push_back(measured(all[i], std::move(crops[i]), camera_, notes ? (*notes)[i] : unsaid));
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

// Keeps of balls that cannot all be there those that most speaks for.
void keep_solid(std::vector<FoundBall>& balls) {
    std::stable_sort(balls.begin(), balls.end(),
                     [](const FoundBall& a, const FoundBall& b) { return weight_of(a) > weight_of(b); });
    std::vector<FoundBall> apart;
    for (FoundBall& ball : balls)
        if (std::none_of(apart.begin(), apart.end(),
                         [&](const FoundBall& other) { return cannot_both_be(other.image, ball.image); }))
            apart.push_back(std::move(ball));
    balls = std::move(apart);
}

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
    keep_solid(search.balls);
    if (!search.balls.empty()) add_twins(known);
}

void BallFinder::add_twins(const std::vector<BallImage>& known) {
    const FoundBall first = search.balls.front();
    std::vector<BallImage> there = known;
    for (const FoundBall& ball : search.balls) there.push_back(ball.image);
    std::vector<FoundBall> twins = measured_all(twins_of(first, there, photos_, field_));
    std::stable_sort(twins.begin(), twins.end(),
                     [](const FoundBall& a, const FoundBall& b) { return weight_of(a) > weight_of(b); });
    for (FoundBall& ball : twins) {
        const int found = ball.highlights_found();
        if (found < std::max(2.0, kLeastFoundTwin * static_cast<double>(set_.size())) ||
            !(ball.outline_coverage > 0) || !is_twin_size(ball.image.radius_px, first.image.radius_px) ||
            !shows_same_lamps(ball, first, camera_))
            continue;
        if (std::any_of(search.balls.begin(), search.balls.end(),
                        [&](const FoundBall& other) { return cannot_both_be(other.image, ball.image); }))
            continue;
        const dvec2 at = ball.image.centre_px;
        if (found < std::ssize(ball.highlights))
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
            "{}: no mirror ball found in the {} photographs.{} {} --uncalibrated: lights from the "
            "photographs of a "
            "nearly flat object alone",
            set.folder().string(), set.size(), tried,
            given.empty() ? "Give balls with --sphere X,Y,R (pixels from the top left), or add"
                          : "If there is none, leave out --sphere and add");
        if (given.empty()) throw NoBallError(message);
        throw Error(message);
    }
    std::stable_sort(search.balls.begin(), search.balls.end(),
                     [](const auto& a, const auto& b) { return a.image.centre_px.y < b.image.centre_px.y; });
    for (std::size_t i = 0; i < search.balls.size(); ++i) {
        const dvec2 at = search.balls[i].image.centre_px;
        search.balls[i].name = fmt::format("ball {} at ({:.0f}, {:.0f})", i + 1, at.x, at.y);
        const std::vector<Highlight>& highlights = search.balls[i].highlights;
        const auto several = std::count_if(highlights.begin(), highlights.end(), [](const Highlight& h) {
            return h.state == HighlightState::found && h.weaker > 0;
        });
        if (4 * several >= std::ssize(highlights))
            search.warnings.push_back(
                fmt::format("{}: {} of {} photographs show more than one bright spot on it, as of a "
                            "reflector or a window; "
                            "the brightest is taken for the lamp",
                            search.balls[i].name, several, highlights.size()));
    }
    return search;
}

}  // namespace tangi
