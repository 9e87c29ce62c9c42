// film_match.h: how far a mixture of paints is from a colour to be matched, under several illuminants at
// once; what the search for recipes minimises.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "paint/optics/kubelka_munk.h"
#include "retouch/colour_match/simplex_subsets.h"

namespace tangi {

// What the paint is laid as: a film of this thickness over what lies below (outside, as it looks by itself),
// or, without, one that hides.
struct FilmOnGround {
    double thickness_mm = 0.05;
    Spectrum below{};
};

// A few paints of a box by volume. The first `count` count; volumes sum to 1.
struct Mixture {
    std::array<int, kMostPaints> paints{};
    std::array<double, kMostPaints> volumes{};
    int count = 0;
};

// What the error of a recipe is: the worst of its differences under the illuminants, or their mean.
enum class MatchGoal { worst, mean };

// A target, a box of paints, illuminants. Immutable; any number of threads may use one.
class FilmMatch {
public:
    // Throws ContractError without paints or illuminants, Error naming the film's thickness where it is
    // outside of (0, 10].
    FilmMatch(std::span<const Pigment> paints, const Spectrum& target,
              std::span<const Illuminant> illuminants, const std::optional<FilmOnGround>& film);

    int paints() const { return static_cast<int>(k_.size()); }
    int illuminants() const { return static_cast<int>(illuminants_.size()); }

    Spectrum look(const Mixture& mixture) const;  // outside
    // CIEDE2000 under each illuminant, and the goal of them.
    std::vector<double> differences(const Mixture& mixture) const;
    double error(const Mixture& mixture, MatchGoal goal) const;

    // A^T A of the linearised problem: for weights w = volume * mean S (of all bands), |A w|^2 is nearly the
    // sum of squares of CIEDE2000 under these illuminants. In each band, what is left of K - q S, q that K/S
    // of the target (two-constant theory solved for ratios: Walowit, McCarthy, Berns 1988), times dR/dq,
    // times the derivatives of colour.
    std::vector<double> gram() const;
    Mixture from_weights(const SubsetFit& fit) const;  // volumes in place of weights

    // Finishes in continuous parts (Levenberg-Marquardt on the logarithms of parts; ceres::TinySolver): the
    // sum of squares under the illuminants, then, for the goal `worst`, the sum of eighth powers. Never worse
    // than the start.
    Mixture refined(const Mixture& start, MatchGoal goal) const;

    // Half of the second derivatives of the sum of squares by the logarithms of the parts, count x count.
    std::array<double, kMostPaints * kMostPaints> curvature(const Mixture& mixture) const;

    static constexpr int kResiduals = 3 * kIlluminants;
    // Three parts of CIEDE2000 a illuminant, 0 behind them.
    void residuals(const Mixture& mixture, double* parts) const;

private:
    using Bands = std::array<double, kBands>;
    void look_of(const Mixture& mixture, Bands& reflectance) const;
    Lab lab_of(const Bands& reflectance, std::size_t illuminant) const;

    std::vector<Bands> k_, s_;
    std::vector<double> mean_s_;
    std::vector<Illuminant> illuminants_;
    std::vector<std::array<Bands, 3>> weights_;  // XYZ relative to white, by illuminant
    std::vector<Lab> target_lab_;
    Bands target_{}, below_inside_{};
    std::optional<double> film_mm_;
};

}  // namespace tangi
