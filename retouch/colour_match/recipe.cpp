#include "retouch/colour_match/recipe.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <map>
#include <set>

#include "paint/optics/spectrum_tables.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr std::size_t kSets = 60;          // of paints, of each size, that are finished in continuous parts
constexpr std::size_t kMeasuredSets = 14;  // of those, the ones that are measured out
constexpr std::size_t kWaysOfSet = 48;     // to measure one out that are looked at exactly
constexpr double kTrace = 1.0 / 3000;      // part by volume that no measure reaches
constexpr std::array<Illuminant, kIlluminants> kAllIlluminants = {
    Illuminant::a, Illuminant::d50, Illuminant::d65, Illuminant::f11, Illuminant::warm_led};
constexpr int kMostForFour = 40;  // paints of which all sets of four are looked at

Lab lab_of(const glm::dvec3& xyz, Illuminant illuminant) {
    const glm::dvec3 t = xyz / white_xyz(illuminant);
    const auto f = [](double x) {
        constexpr double epsilon = 216.0 / 24389, kappa = 24389.0 / 27;
        return x > epsilon ? std::cbrt(x) : (kappa * x + 16) / 116;
    };
    return {116 * f(t.y) - 16, 500 * (f(t.x) - f(t.y)), 200 * (f(t.y) - f(t.z))};
}

// Without paints of which there is next to nothing.
Mixture without_traces(const Mixture& m) {
    Mixture rest;
    double sum = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
        if (m.volumes[i] < kTrace) continue;
        const auto at = static_cast<std::size_t>(rest.count++);
        rest.paints[at] = m.paints[i];
        sum += rest.volumes[at] = m.volumes[i];
    }
    for (double& v : rest.volumes) v /= sum;
    return rest;
}

std::vector<int> set_of(const Mixture& m) {
    std::vector<int> set(m.paints.begin(), m.paints.begin() + m.count);
    std::sort(set.begin(), set.end());
    return set;
}

struct Candidate {
    Mixture ideal;
    MeasuredMixture measured;
    double error = 0;
};

// Of many paints, those that come nearest in sets of two: all sets of four would be too many.
std::vector<int> useful(const std::vector<double>& gram, int n, std::span<const char> allowed) {
    std::vector<int> chosen;
    std::set<int> seen;
    const auto fits = best_subsets(gram, n, 2, static_cast<std::size_t>(n * (n + 1) / 2), allowed);
    for (const SubsetFit& fit : fits)
        for (int i = 0; i < fit.count && chosen.size() < kMostForFour; ++i) {
            const int column = fit.columns[static_cast<std::size_t>(i)];
            if (seen.insert(column).second) chosen.push_back(column);
        }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

// Sets of paints with their first mixtures: the best of each size.
std::vector<Mixture> first_mixtures(const FilmMatch& match, const MatchOptions& options) {
    const int n = match.paints();
    std::vector<double> gram = match.gram();
    std::vector<int> columns(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) columns[static_cast<std::size_t>(i)] = i;
    std::vector<char> allowed = options.allowed;
    if (n > kMostForFour) {
        columns = useful(gram, n, options.allowed);
        std::vector<double> part;
        std::vector<char> allowed_part;
        for (const int i : columns)
            for (const int j : columns) {
                part.push_back(gram[static_cast<std::size_t>(i * n + j)]);
                if (!allowed.empty()) allowed_part.push_back(allowed[static_cast<std::size_t>(i * n + j)]);
            }
        gram = part, allowed = allowed_part;
    }
    std::vector<Mixture> mixtures;
    for (int size = 1; size <= options.max_paints; ++size)
        for (SubsetFit fit : best_subsets(gram, static_cast<int>(columns.size()), size, kSets, allowed)) {
            for (int i = 0; i < fit.count; ++i) {
                int& column = fit.columns[static_cast<std::size_t>(i)];
                column = columns[static_cast<std::size_t>(column)];
            }
            mixtures.push_back(match.from_weights(fit));
        }
    return mixtures;
}

// Mixtures in continuous parts, the best of each set of paints, best first.
std::vector<std::pair<double, Mixture>> ideal_mixtures(const FilmMatch& match, const MatchOptions& options) {
    std::map<std::vector<int>, std::pair<double, Mixture>> by_set;
    std::set<std::vector<int>> started;
    for (const Mixture& start : first_mixtures(match, options)) {
        if (!started.insert(set_of(start)).second) continue;
        const Mixture found = without_traces(match.refined(start, options.goal));
        const double error = match.error(found, options.goal);
        const auto [at, added] = by_set.try_emplace(set_of(found), error, found);
        if (!added && error < at->second.first) at->second = {error, found};
    }
    std::vector<std::pair<double, Mixture>> result;
    for (const auto& [set, found] : by_set) result.push_back(found);
    std::stable_sort(result.begin(), result.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    return result;
}

// Measured mixtures: of the best sets of each size, the best each.
std::vector<Candidate> search(const FilmMatch& match, const MatchOptions& options) {
    std::vector<Candidate> result;
    std::array<std::size_t, kMostPaints + 1> taken{};
    for (const auto& [ideal_error, ideal] : ideal_mixtures(match, options)) {
        std::size_t& count = taken[static_cast<std::size_t>(ideal.count)];
        if (count == (ideal.count == options.max_paints ? kMeasuredSets : kMeasuredSets / 2)) continue;
        ++count;
        Candidate best;
        best.error = 1e300;
        for (const MeasuredMixture& measured : measurable_near(ideal, match, kWaysOfSet)) {
            const double error = match.error(measured.mixture, options.goal);
            if (error < best.error) best = {ideal, measured, error};
        }
        result.push_back(best);
    }
    return result;
}

MatchedRecipe described(const Candidate& candidate, const FilmMatch& match, const FilmMatch& all_illuminants,
                        const Spectrum& target, MatchGoal goal) {
    MatchedRecipe r;
    r.steps = candidate.measured.steps;
    r.mixture = candidate.measured.mixture;
    r.ideal = candidate.ideal;
    r.error = candidate.error;
    r.ideal_error = match.error(candidate.ideal, goal);
    r.look = match.look(r.mixture);
    const auto each = all_illuminants.differences(r.mixture);
    for (std::size_t illuminant = 0; illuminant < kIlluminants; ++illuminant) {
        r.delta_e[illuminant] = each[illuminant];
        r.metamerism[illuminant] = metamerism_index(target, r.look, static_cast<Illuminant>(illuminant));
    }
    return r;
}

void require_valid(std::span<const Pigment> paints, const MatchOptions& options) {
    validate(options);
    if (paints.empty()) fail("the paint box is empty; give a palette with a paint at least");
    if (options.illuminants.empty()) fail("no illuminant counts; name one at least, as in D65,A,F11");
    TP_REQUIRE(options.allowed.empty() || options.allowed.size() == paints.size() * paints.size(),
               "a word for every pair of paints");
}

}  // namespace

MatchResult match_spectrum(std::span<const Pigment> paints, const Spectrum& target,
                           const MatchOptions& options) {
    require_valid(paints, options);
    const FilmMatch match(paints, target, options.illuminants, options.film);
    std::vector<Candidate> candidates = search(match, options);
    if (options.illuminants.size() > 1)
        for (const Illuminant& illuminant : options.illuminants) {
            const FilmMatch alone(paints, target, std::span(&illuminant, 1), options.film);
            for (Candidate& c : search(alone, options)) {
                c.error = match.error(c.measured.mixture, options.goal);
                candidates.push_back(c);
            }
        }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
    const FilmMatch all_illuminants(paints, target, kAllIlluminants, options.film);
    MatchResult result;
    result.target = target;
    std::set<std::vector<int>> given;
    std::map<int, const Candidate*> by_count;
    for (const Candidate& c : candidates) {
        by_count.try_emplace(c.measured.mixture.count, &c);
        if (static_cast<int>(result.recipes.size()) < options.alternatives &&
            given.insert(set_of(c.measured.mixture)).second)
            result.recipes.push_back(described(c, match, all_illuminants, target, options.goal));
    }
    double least = 1e300;
    for (const auto& [count, c] : by_count) {
        if (c->error >= least) continue;
        least = c->error;
        result.by_count.push_back(described(*c, match, all_illuminants, target, options.goal));
    }
    return result;
}

Spectrum smooth_spectrum(const glm::dvec3& xyz, Illuminant illuminant) {
    const auto& weights = kXyzWeights[static_cast<std::size_t>(illuminant)];
    // The smooth reflectance of this colour, relative to white, under D65; then the least change to it, in
    // the sense of squares, that gives the colour under the illuminant, within [0, 1].
    const glm::dvec3 d65 = xyz / white_xyz(illuminant) * white_xyz(Illuminant::d65);
    const glm::dmat3 rgb_of_xyz = glm::inverse(glm::dmat3(
        0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375, 0.0721750, 0.9503041));
    Spectrum r = reflectance_of_rgb(Rgb(rgb_of_xyz * d65));
    for (int pass = 0; pass < 50; ++pass) {
        const glm::dvec3 off = xyz - xyz_of(r, illuminant);
        glm::dmat3 normal(0);
        const auto is_free = [&](std::size_t band, const glm::dvec3& along) {
            double change = 0;
            for (int c = 0; c < 3; ++c)
                change += along[c] * static_cast<double>(weights[static_cast<std::size_t>(c)][band]);
            return !((r[band] <= 0 && change < 0) || (r[band] >= 1 && change > 0));
        };
        for (std::size_t band = 0; band < kBands; ++band) {
            if (!is_free(band, off)) continue;
            const glm::dvec3 w(weights[0][band], weights[1][band], weights[2][band]);
            normal += glm::outerProduct(w, w);
        }
        if (std::abs(glm::determinant(normal)) < 1e-14) break;
        const glm::dvec3 along = glm::inverse(normal) * off;
        for (std::size_t band = 0; band < kBands; ++band) {
            if (!is_free(band, off)) continue;
            double change = 0;
            for (int c = 0; c < 3; ++c)
                change += along[c] * static_cast<double>(weights[static_cast<std::size_t>(c)][band]);
            r[band] = std::clamp(r[band] + static_cast<float>(change), 0.0f, 1.0f);
        }
    }
    const double left = delta_e_2000(lab_of(xyz, illuminant), lab_under(r, illuminant));
    if (!(left < 1))
        fail(
            "colour with X {:.3f}, Y {:.3f}, Z {:.3f} under {}: no surface has it (the nearest differs by "
            "CIEDE2000 {:.1f}); choose one less saturated or bright",
            xyz.x, xyz.y, xyz.z, name_of(illuminant), left);
    return r;
}

std::optional<LikelySpectrum> likely_spectrum(std::span<const Pigment> paints, const glm::dvec3& xyz,
                                              Illuminant illuminant, const MatchOptions& options,
                                              double tolerance) {
    require_valid(paints, options);
    MatchOptions alone = options;
    alone.illuminants = {illuminant};
    const FilmMatch match(paints, smooth_spectrum(xyz, illuminant), alone.illuminants, alone.film);
    std::vector<Spectrum> looks;
    for (const auto& [error, mixture] : ideal_mixtures(match, alone))
        if (error <= tolerance) looks.push_back(match.look(mixture));
    if (looks.empty()) return std::nullopt;
    std::optional<LikelySpectrum> best;
    double least = 1e300;
    for (const Spectrum& look : looks) {
        LikelySpectrum found{look, static_cast<int>(looks.size()), {}};
        double sum = 0;
        for (std::size_t l = 0; l < kIlluminants; ++l) {
            const Lab here = lab_under(look, kAllIlluminants[l]);
            for (const Spectrum& other : looks)
                found.spread[l] += delta_e_2000(here, lab_under(other, kAllIlluminants[l])) /
                                   static_cast<double>(looks.size());
            sum += found.spread[l];
        }
        if (sum < least) least = sum, best = found;
    }
    return best;
}

double metamerism_index(const Spectrum& target, const Spectrum& look, Illuminant illuminant,
                        Illuminant reference) {
    const glm::dvec3 here = xyz_of(look, reference), there = xyz_of(target, reference);
    glm::dvec3 corrected = xyz_of(look, illuminant);
    for (int c = 0; c < 3; ++c)
        if (here[c] > 1e-6) corrected[c] *= there[c] / here[c];
    return delta_e_2000(lab_of(xyz_of(target, illuminant), illuminant), lab_of(corrected, illuminant));
}

}  // namespace tangi
