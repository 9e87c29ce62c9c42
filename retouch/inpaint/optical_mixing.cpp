#include "retouch/inpaint/optical_mixing.h"

#include <algorithm>
#include <cmath>

#include "retouch/colour_match/simplex_subsets.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr int kMostLooks = 60;      // of which all sets of four are looked at
constexpr std::size_t kKept = 200;  // sets of looks that are compared exactly
// Squares of L*a*b* by which looks differ from the target, against squares of CIEDE2000 by which their mean
// does: 15 beside it on average are worth 1.
constexpr double kContrastPart = 1.0 / 225;
constexpr double kColourPart =
    0.5;  // of differences in colour: they fuse from nearer than those in lightness

// The best sets of four; of many looks, only those count that do best in pairs.
std::vector<SubsetFit> best_of(const std::vector<double>& gram, int n) {
    if (n <= kMostLooks) return best_subsets(gram, n, kMostPaints, kKept);
    std::vector<int> chosen;
    for (const SubsetFit& pair : best_subsets(gram, n, 2, static_cast<std::size_t>(n * (n + 1) / 2)))
        for (int i = 0; i < pair.count && static_cast<int>(chosen.size()) < kMostLooks; ++i) {
            const int look = pair.columns[static_cast<std::size_t>(i)];
            if (std::find(chosen.begin(), chosen.end(), look) == chosen.end()) chosen.push_back(look);
        }
    std::vector<double> part;
    for (const int i : chosen)
        for (const int j : chosen) part.push_back(gram[static_cast<std::size_t>(i * n + j)]);
    auto fits = best_subsets(part, static_cast<int>(chosen.size()), kMostPaints, kKept);
    for (SubsetFit& fit : fits)
        for (int i = 0; i < fit.count; ++i) {
            int& look = fit.columns[static_cast<std::size_t>(i)];
            look = chosen[static_cast<std::size_t>(look)];
        }
    return fits;
}

// What may lie side by side, and what it is to look like.
struct Offer {
    std::span<const Spectrum> looks;
    const Spectrum& target;
    std::span<const Illuminant> illuminants;
    const Spectrum& bare;
    float painted;  // [1] of the area; the rest stays bare
};

// What each look alone would be off by, in colour under each illuminant, linearised at the target.
std::vector<std::vector<double>> columns_of(const Offer& offer) {
    const auto& [looks, target, illuminants, bare, painted] = offer;
    std::vector<std::vector<double>> columns(looks.size());
    for (const Illuminant illuminant : illuminants) {
        const Lab there = lab_under(target, illuminant);
        std::array<glm::dvec3, kBands> slope;
        for (std::size_t band = 0; band < kBands; ++band) {
            Spectrum moved = target;
            moved[band] += 1e-3f;
            slope[band] = delta_e_2000_parts(there, lab_under(moved, illuminant)) * 1e3;
        }
        for (std::size_t k = 0; k < looks.size(); ++k) {
            glm::dvec3 off(0);
            for (std::size_t band = 0; band < kBands; ++band)
                off += slope[band] * static_cast<double>(painted * looks[k][band] +
                                                         (1 - painted) * bare[band] - target[band]);
            for (int i = 0; i < 3; ++i) columns[k].push_back(off[i]);
        }
    }
    return columns;
}

// How far each look is from the target.
std::vector<double> apart_from(const Spectrum& target, std::span<const Spectrum> looks) {
    const Lab wanted = lab_under(target);
    std::vector<double> apart;
    for (const Spectrum& look : looks) {
        const Lab lab = lab_under(look);
        const glm::dvec3 off(lab.l - wanted.l, kColourPart * (lab.a - wanted.a),
                             kColourPart * (lab.b - wanted.b));
        apart.push_back(kContrastPart * glm::dot(off, off));
    }
    return apart;
}

// As shares sum to 1, a sum of shares times numbers is a quadratic form too, and so is a constant, which
// keeps the matrix positive definite.
std::vector<double> gram_of(const std::vector<std::vector<double>>& columns,
                            const std::vector<double>& apart) {
    const double constant = 2 * *std::max_element(apart.begin(), apart.end()) + 1;
    const auto n = columns.size();
    std::vector<double> gram(n * n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            gram[i * n + j] = (apart[i] + apart[j]) / 2 + constant;
            for (std::size_t r = 0; r < columns[i].size(); ++r)
                gram[i * n + j] += columns[i][r] * columns[j][r];
        }
    return gram;
}

// The set whose mean is nearest to the target, by CIEDE2000 itself, and whose looks differ from it least.
Juxtaposition exact_best(const Offer& offer, const std::vector<SubsetFit>& fits,
                         const std::vector<double>& apart) {
    const auto& [looks, target, illuminants, bare, painted] = offer;
    const SubsetFit* best = nullptr;
    double least = 1e300;
    Juxtaposition result;
    for (const SubsetFit& fit : fits) {
        Spectrum mean;
        for (std::size_t band = 0; band < kBands; ++band) mean[band] = (1 - painted) * bare[band];
        double contrast = 0, worst = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(fit.count); ++i) {
            const auto look = static_cast<std::size_t>(fit.columns[i]);
            contrast += fit.weights[i] * apart[look];
            for (std::size_t band = 0; band < kBands; ++band)
                mean[band] += painted * static_cast<float>(fit.weights[i]) * looks[look][band];
        }
        for (const Illuminant illuminant : illuminants)
            worst = std::max(worst, delta_e_2000(lab_under(mean, illuminant), lab_under(target, illuminant)));
        if (worst * worst + contrast < least)
            least = worst * worst + contrast, best = &fit, result.delta_e = worst;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(best->count); ++i) {
        result.looks.push_back(best->columns[i]);
        result.shares.push_back(best->weights[i]);
    }
    return result;
}

}  // namespace

Juxtaposition juxtapose(std::span<const Spectrum> looks, const Spectrum& target,
                        std::span<const Illuminant> illuminants, const Spectrum& bare, double bare_share) {
    TP_REQUIRE(!looks.empty() && !illuminants.empty(), "looks and illuminants");
    TP_REQUIRE(bare_share >= 0 && bare_share < 1, "a part of the area is painted");
    const Offer offer{looks, target, illuminants, bare, static_cast<float>(1 - bare_share)};
    const std::vector<double> apart = apart_from(target, looks);
    const auto fits = best_of(gram_of(columns_of(offer), apart), static_cast<int>(looks.size()));
    TP_REQUIRE(!fits.empty(), "each look alone is a set");
    return exact_best(offer, fits, apart);
}

}  // namespace tangi
