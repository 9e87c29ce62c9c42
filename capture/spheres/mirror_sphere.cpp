#include "capture/spheres/mirror_sphere.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/spheres/given_outline.h"
#include "capture/spheres/light_plausibility.h"
#include "capture/spheres/sphere_candidates.h"
#include "capture/spheres/sphere_sizes.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kLeastFound = 0.65;  // [1] part of the photographs that must show a highlight on a sphere
constexpr double kLeastFoundGiven = 0.25;  // likewise, where the user gives the sphere
constexpr double kLeastFoundTwin = 0.1;    // likewise, of one that shows the same lights as another does
constexpr double kMostBelow = 0.1;  // [1] of the highlights that may come from lights behind the painting
constexpr double kSameLight = 0.6;  // [rad] between what two spheres say of a near light

// Measures outline and highlights.
FoundSphere measured(const SphereCandidate& candidate, SphereCrops crops, const SphereCamera& camera,
                     std::vector<std::string>& notes) {
    FoundSphere sphere{.image = candidate.image,
                       .circle = candidate.image,
                       .before = candidate.before,
                       .name = {},
                       .given = candidate.given != nullptr,
                       .crops = std::move(crops)};
    const std::string text = candidate.given ? candidate.given->text : "";
    // The lens that is given may be wrong.
    if (!find_outline(sphere, camera, text, notes) && camera.focal_px)
        (void)find_outline(sphere, {{}, camera.principal_px}, text, notes);
    sphere.highlights = find_highlights(sphere.crops, sphere.image, camera);
    return sphere;
}

std::vector<std::optional<glm::dvec3>> mirrored_directions(const FoundSphere& sphere,
                                                           const SphereCamera& camera) {
    std::vector<std::optional<glm::dvec3>> directions(sphere.highlights.size());
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (sphere.highlights[i].state != HighlightState::found) continue;
        if (const auto point = sphere_point(sphere.image, camera, sphere.highlights[i].place_px))
            directions[i] = point->mirrored();
    }
    return directions;
}

// How many highlights would come from lights behind the painting; such lie beyond 0.71 radii.
int from_below(const FoundSphere& sphere, const SphereCamera& camera) {
    return static_cast<int>(
        std::count_if(sphere.highlights.begin(), sphere.highlights.end(), [&](const Highlight& h) {
            if (h.state != HighlightState::found) return false;
            const auto point = sphere_point(sphere.image, camera, h.place_px);
            return point && !(point->mirrored().z > 0);
        }));
}

// How many photographs show the light, where that is too few, and what the others show instead.
std::string too_few(const FoundSphere& sphere) {
    std::string text = fmt::format("only {} of {} photographs show a highlight on it",
                                   sphere.highlights_found(), sphere.highlights.size());
    const std::pair<HighlightState, const char*> others[] = {
        {HighlightState::ambiguous,
         "show two that are about equally bright: leave one light on, or cover the mirror "
         "image of it"},
        {HighlightState::smeared, "show one that covers too much of it"},
        {HighlightState::off_sphere, "show one across its outline"}};
    for (const auto& [state, words] : others)
        if (const int count = sphere.highlights_in(state); count > 0)
            text += fmt::format("; {} {}", count, words);
    return text;
}

bool may_be_given(const FoundSphere& sphere) {
    return sphere.highlights_found() >=
           std::max(1.0, kLeastFoundGiven * static_cast<double>(sphere.highlights.size()));
}

// Why something that was found and not given is no mirror sphere.
struct Objection {
    std::string reason{};         // empty where it may be one
    bool to_its_outline = false;  // what shows in the circle contradicts that it is a sphere's outline
};

Objection objection_to(const FoundSphere& sphere, const SphereCamera& camera, const GreyPhotos& photos,
                       const CameraMotions& drifts) {
    const int found = sphere.highlights_found(), below = from_below(sphere, camera);
    const auto count = static_cast<double>(sphere.highlights.size());
    if (found < kLeastFound * count) return {too_few(sphere)};
    if (below >= 2 && below > kMostBelow * found)
        return {fmt::format("{} of {} highlights would come from lights behind the painting", below, found),
                true};
    const std::vector<std::optional<glm::dvec3>> directions = mirrored_directions(sphere, camera);
    const ShadedCircle itself{sphere.image.centre_px, 1.5 * sphere.image.radius_px};
    if (const auto chance = chance_of_directions(photos, drifts, directions, {&itself, 1});
        chance && *chance > kLargestChance)
        return {"the photographs are not shaded as the lights that it shows would shade them", true};
    return {};
}

// A sphere that nobody spoke of is one only where all speaks for it.
void take_found(FoundSphere sphere, const SphereCamera& camera, const GreyPhotos& photos,
                const CameraMotions& drifts, SphereSearch& search) {
    if (!(sphere.outline_coverage > 0)) return;
    const Objection objection = objection_to(sphere, camera, photos, drifts);
    const dvec2 at = sphere.image.centre_px;
    if (objection.reason.empty()) {
        search.spheres.push_back(std::move(sphere));
        return;
    }
    // No circle is recommended that would be refused, or that is none of a mirror sphere.
    const std::string advice =
        objection.to_its_outline ? "; if there is a sphere, give its outline with --sphere X,Y,R"
        : may_be_given(sphere)   ? fmt::format("; if it is one, give it with --sphere {:.0f},{:.0f},{:.0f}",
                                               at.x, at.y, sphere.image.radius_px)
                                 : "";
    search.warnings.push_back(
        fmt::format("something round at ({:.0f}, {:.0f}) is taken for no mirror sphere: {}{}", at.x, at.y,
                    objection.reason, advice));
}

// What the user says is believed where highlights show at all, and doubted where they cannot be a sphere's.
void take_given(FoundSphere sphere, const SphereCandidate& candidate, std::vector<std::string> notes,
                const SphereCamera& camera, SphereSearch& search) {
    const int found = sphere.highlights_found();
    const std::string& text = candidate.given->text;
    if (!may_be_given(sphere)) {
        const bool shows_two =
            2 * sphere.highlights_in(HighlightState::ambiguous) > std::ssize(sphere.highlights);
        search.warnings.push_back(fmt::format(
            "--sphere {}: {}{}: {}; rejected", text,
            shows_two ? "no light is told from the other there" : "no mirror sphere there",
            candidate.contradiction.empty() ? "" : ", nor in the circle that shows", too_few(sphere)));
        return;
    }
    const auto same =
        std::find_if(search.spheres.begin(), search.spheres.end(),
                     [&](const FoundSphere& other) { return cannot_both_be(other.image, sphere.image); });
    if (same != search.spheres.end()) {
        search.warnings.push_back(
            fmt::format("--sphere {}: is the same sphere as the one at ({:.0f}, {:.0f}); rejected", text,
                        same->image.centre_px.x, same->image.centre_px.y));
        return;
    }
    search.warnings.insert(search.warnings.end(), notes.begin(), notes.end());
    if (!candidate.contradiction.empty()) search.poor.push_back(candidate.contradiction);
    if (const int below = from_below(sphere, camera); below >= 2 && below > kMostBelow * found)
        search.poor.push_back(fmt::format(
            "--sphere {}: {} of {} highlights would come from lights behind the painting; is it a "
            "mirror sphere, and is "
            "that its outline?",
            text, below, found));
    search.spheres.push_back(std::move(sphere));
}

// Whether a sphere shows the lights where another one does, in most photographs that both tell.
bool shows_same_lights(const FoundSphere& sphere, const FoundSphere& other, const SphereCamera& camera) {
    const auto a = mirrored_directions(sphere, camera), b = mirrored_directions(other, camera);
    int both = 0, same = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i] || !b[i]) continue;
        ++both;
        same += glm::length(glm::cross(*a[i], *b[i])) < std::sin(kSameLight) && glm::dot(*a[i], *b[i]) > 0;
    }
    return both >= 2 && 4 * same >= 3 * both;
}

}  // namespace

int FoundSphere::highlights_found() const { return highlights_in(HighlightState::found); }

int FoundSphere::highlights_in(HighlightState state) const {
    return static_cast<int>(std::count_if(highlights.begin(), highlights.end(),
                                          [&](const Highlight& h) { return h.state == state; }));
}

bool find_outline(FoundSphere& sphere, const SphereCamera& camera, const std::string& given_text,
                  std::vector<std::string>& warnings) {
    std::optional<SphereOutline> outline = refine_outline(sphere.crops, sphere.circle, camera);
    if (sphere.before) {
        const GivenOutline judged = judge_outline(sphere.crops, *sphere.before, outline, camera);
        sphere.image = judged.sphere;
        if (judged.verdict == OutlineVerdict::given) outline.reset();
        if (judged.verdict == OutlineVerdict::given && !given_text.empty())
            warnings.push_back(fmt::format(
                "--sphere {}: the sphere's outline does not stand out from what is around it; the circle is "
                "taken as given{}, and taken to be right to {:.1f} pixels",
                given_text,
                judged.moved_px > 0 ? fmt::format(", but for {:.1f} pixels that edges tell", judged.moved_px)
                                    : "",
                std::max(sphere.image.centre_sigma_px, sphere.image.radius_sigma_px)));
        if (judged.verdict == OutlineVerdict::beside && !given_text.empty())
            warnings.push_back(
                fmt::format("--sphere {}: the sphere's outline is {:.1f} pixels from it, and is used: "
                            "{:.1f},{:.1f},{:.1f}",
                            given_text, judged.moved_px, sphere.image.centre_px.x, sphere.image.centre_px.y,
                            sphere.image.radius_px));
    } else if (outline) {
        widen_errors(sphere.crops, *outline, camera);
        sphere.image = outline->sphere;
    }
    sphere.outline_coverage = outline ? outline->coverage : 0;
    sphere.outline_residual_px = outline ? outline->residual_px : 0;
    sphere.elongation = outline ? outline->elongation : std::nullopt;
    return outline.has_value() || sphere.before.has_value();
}

void measure_again(FoundSphere& sphere, const SphereCamera& camera) {
    std::vector<std::string> told;
    if (sphere.before || sphere.outline_coverage > 0) {
        FoundSphere again = sphere;
        if (find_outline(again, camera, {}, told)) sphere = std::move(again);
    }
    if (!sphere.highlights.empty()) sphere.highlights = find_highlights(sphere.crops, sphere.image, camera);
}

namespace {

// Spheres of a stack, as they are found.
class SphereFinder {
public:
    SphereFinder(const SphereStack& scene, const Progress& progress)
        : set_(scene.set),
          photos_(scene.photos),
          drifts_(scene.drifts),
          camera_(scene.camera),
          progress_(progress),
          field_(edge_field(photos_.mean, photos_.step)) {}

    void find_given(std::span<const GivenSphere> given) {
        const std::vector<SphereCandidate> candidates =
            sought_where_given(photos_, field_, given, search.warnings);
        std::vector<std::vector<std::string>> notes(candidates.size());
        std::vector<FoundSphere> spheres = measured_all(candidates, &notes);
        for (std::size_t i = 0; i < candidates.size(); ++i)
            take_given(std::move(spheres[i]), candidates[i], std::move(notes[i]), camera_, search);
    }
    void find(const std::optional<double>& expected_px);

    SphereSearch search;

private:
    // `notes`: for the user, on each of them.
    std::vector<FoundSphere> measured_all(const std::vector<SphereCandidate>& all,
                                          std::vector<std::vector<std::string>>* notes = nullptr) {
        std::vector<SphereImage> images;
        for (const SphereCandidate& candidate : all) images.push_back(candidate.image);
        std::vector<SphereCrops> crops = read_sphere_crops(set_, photos_, drifts_, images, progress_);
        std::vector<FoundSphere> spheres;
        std::vector<std::string> unsaid;
        for (std::size_t i = 0; i < all.size(); ++i)
            spheres.push_back(measured(all[i], std::move(crops[i]), camera_, notes ? (*notes)[i] : unsaid));
        return spheres;
    }
    void add_twins(const std::vector<SphereImage>& known);

    const PhotoSet& set_;
    const GreyPhotos& photos_;
    const CameraMotions& drifts_;
    const SphereCamera& camera_;
    const Progress& progress_;
    const EdgeField field_;
};

// Keeps of spheres that cannot all be there those that most speaks for.
void keep_solid(std::vector<FoundSphere>& spheres) {
    std::stable_sort(spheres.begin(), spheres.end(),
                     [](const FoundSphere& a, const FoundSphere& b) { return weight_of(a) > weight_of(b); });
    std::vector<FoundSphere> apart;
    for (FoundSphere& sphere : spheres)
        if (std::none_of(apart.begin(), apart.end(),
                         [&](const FoundSphere& other) { return cannot_both_be(other.image, sphere.image); }))
            apart.push_back(std::move(sphere));
    spheres = std::move(apart);
}

void SphereFinder::find(const std::optional<double>& expected_px) {
    std::vector<SphereImage> known;
    for (FoundSphere& sphere : measured_all(sought(photos_, field_))) {
        known.push_back(sphere.image);
        take_found(std::move(sphere), camera_, photos_, drifts_, search);
    }
    const auto as_expected = [&](const FoundSphere& sphere) {
        return is_of_size(sphere.image.radius_px, *expected_px);
    };
    if (expected_px && std::none_of(search.spheres.begin(), search.spheres.end(), as_expected)) {
        std::vector<std::string> told = search.warnings;  // of circles that nothing but a number speaks for
        for (FoundSphere& sphere :
             measured_all(of_expected_size(*expected_px, search.spheres, photos_, field_)))
            take_found(std::move(sphere), camera_, photos_, drifts_, search);
        search.warnings = std::move(told);
    }
    keep_one_size(search, expected_px);
    keep_solid(search.spheres);
    if (!search.spheres.empty()) add_twins(known);
}

void SphereFinder::add_twins(const std::vector<SphereImage>& known) {
    const FoundSphere first = search.spheres.front();
    std::vector<SphereImage> there = known;
    for (const FoundSphere& sphere : search.spheres) there.push_back(sphere.image);
    std::vector<FoundSphere> twins = measured_all(twins_of(first, there, photos_, field_));
    std::stable_sort(twins.begin(), twins.end(),
                     [](const FoundSphere& a, const FoundSphere& b) { return weight_of(a) > weight_of(b); });
    for (FoundSphere& sphere : twins) {
        const int found = sphere.highlights_found();
        if (found < std::max(2.0, kLeastFoundTwin * static_cast<double>(set_.size())) ||
            !(sphere.outline_coverage > 0) || !is_twin_size(sphere.image.radius_px, first.image.radius_px) ||
            !shows_same_lights(sphere, first, camera_))
            continue;
        if (std::any_of(search.spheres.begin(), search.spheres.end(),
                        [&](const FoundSphere& other) { return cannot_both_be(other.image, sphere.image); }))
            continue;
        const dvec2 at = sphere.image.centre_px;
        if (found < std::ssize(sphere.highlights))
            search.warnings.push_back(
                fmt::format("sphere at ({:.0f}, {:.0f}): shows the light in {} of {} photographs only; it is "
                            "used in these",
                            at.x, at.y, found, set_.size()));
        search.spheres.push_back(std::move(sphere));
    }
}

}  // namespace

SphereSearch find_mirror_spheres(const SphereStack& scene, const std::optional<double>& expected_px,
                                 const Progress& progress) {
    const std::span<const GivenSphere> given = scene.given;
    report(progress, "find spheres", 0);
    SphereFinder finder(scene, progress);
    report(progress, "find spheres", 0.5);
    if (given.empty())
        finder.find(expected_px);
    else
        finder.find_given(given);
    report(progress, "find spheres", 1);
    SphereSearch search = std::move(finder.search);
    if (search.spheres.empty()) {
        std::string tried;
        for (const std::string& warning : search.warnings) tried += " " + warning + ".";
        const std::string message = fmt::format(
            "{}: no mirror sphere found in the {} photographs.{} {} --uncalibrated: lights from the "
            "photographs of a "
            "nearly flat object alone",
            scene.set.folder().string(), scene.set.size(), tried,
            given.empty() ? "Give spheres with --sphere X,Y,R (pixels from the top left), or add"
                          : "If there is none, leave out --sphere and add");
        if (given.empty()) throw NoSphereError(message);
        throw Error(message);
    }
    std::stable_sort(search.spheres.begin(), search.spheres.end(),
                     [](const auto& a, const auto& b) { return a.image.centre_px.y < b.image.centre_px.y; });
    for (std::size_t i = 0; i < search.spheres.size(); ++i) {
        const dvec2 at = search.spheres[i].image.centre_px;
        search.spheres[i].name = fmt::format("sphere {} at ({:.0f}, {:.0f})", i + 1, at.x, at.y);
        const std::vector<Highlight>& highlights = search.spheres[i].highlights;
        const auto several = std::count_if(highlights.begin(), highlights.end(), [](const Highlight& h) {
            return h.state == HighlightState::found && h.weaker > 0;
        });
        if (4 * several >= std::ssize(highlights))
            search.warnings.push_back(
                fmt::format("{}: {} of {} photographs show more than one bright spot on it, as of a "
                            "reflector or a window; "
                            "the brightest is taken for the light",
                            search.spheres[i].name, several, highlights.size()));
    }
    return search;
}

}  // namespace tangi
