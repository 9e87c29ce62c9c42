// recipe.h: which paints of one's own box, in which measures, match a colour; under one illuminant or under
// several.
//
// The search is global over sets of paints: the linearised problem is solved for every set of at most
// max_paints (simplex_subsets.h), the best sets are finished in continuous parts (film_match.h), and the best
// of those are searched for mixtures that can be measured out (mixing_steps.h). A search for several
// illuminants holds the searches for each illuminant alone as well, so it never ends worse than they do on
// the common goal.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "retouch/colour_match/film_match.h"
#include "retouch/colour_match/mixing_steps.h"
#include "surface/base/options.h"

namespace tangi {

struct MatchOptions {
    int max_paints = 4;
    int alternatives = 3;
    // Illuminants that count, and how.
    std::vector<Illuminant> illuminants = {Illuminant::d65, Illuminant::a, Illuminant::f11};
    MatchGoal goal = MatchGoal::worst;
    std::optional<FilmOnGround> film;  // masstone without
    // n x n, n paints: pairs that may come together (0: not); all where empty.
    std::vector<char> allowed{};

    static constexpr std::string_view name = "match";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"max_paints", 1, kMostPaints, "1", "paints of one recipe at most"}, self.max_paints);
        visit(FieldInfo{"alternatives", 1, 20, "1", "recipes to give, of different paints"},
              self.alternatives);
    }
};

struct MatchedRecipe {
    std::vector<MixingStep> steps;
    Mixture mixture;                             // that the steps lead to
    Mixture ideal;                               // of the same paints, not bound to measures
    double error = 0, ideal_error = 0;           // CIEDE2000: by the goal, under the illuminants that count
    Spectrum look{};                             // outside
    std::array<double, kIlluminants> delta_e{};  // CIEDE2000 under each, in the order of Illuminant
    // CIE's special index of metamerism (CIE 15:2018, 9.2.2.3) in CIEDE2000: what differs under the
    // illuminant once XYZ are scaled so that both agree under D65. 0 for D65.
    std::array<double, kIlluminants> metamerism{};
};

struct MatchResult {
    Spectrum target{};
    std::vector<MatchedRecipe> recipes;   // best first, `alternatives` of different paints
    std::vector<MatchedRecipe> by_count;  // the best of one paint, of two, …, as long as one more helps
};

// Throws Error where options are outside of their intervals or the box is empty; ContractError where
// `allowed` is of another size.
MatchResult match_spectrum(std::span<const Pigment> paints, const Spectrum& target,
                           const MatchOptions& options = {});

// A reflectance in [0, 1] with this colour under a illuminant (XYZ, Y of a perfect white 1): the one nearest
// to the smooth reflectance of its colour (spectrum.h). Throws Error where none comes within CIEDE2000 1: the
// colour is too saturated or bright for a surface.
Spectrum smooth_spectrum(const glm::dvec3& xyz, Illuminant illuminant);

// What a spectrum may be of which only the colour under one illuminant is known, if it is of such paints: of
// all mixtures of the box that come within `tolerance` (CIEDE2000) under that illuminant, the one that the
// others differ from least under the remaining illuminants; nothing where no mixture comes that near.
struct LikelySpectrum {
    Spectrum reflectance{};
    int mixtures = 0;                           // that were found
    std::array<double, kIlluminants> spread{};  // their mean CIEDE2000 from it under each illuminant
};
std::optional<LikelySpectrum> likely_spectrum(std::span<const Pigment> paints, const glm::dvec3& xyz,
                                              Illuminant illuminant, const MatchOptions& options = {},
                                              double tolerance = 1);

// See MatchedRecipe::metamerism.
double metamerism_index(const Spectrum& target, const Spectrum& look, Illuminant illuminant,
                        Illuminant reference = Illuminant::d65);

}  // namespace tangi
