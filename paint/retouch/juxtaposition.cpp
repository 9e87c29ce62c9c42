#include "paint/retouch/juxtaposition.h"

#include <algorithm>
#include <cmath>

#include "paint/retouch/simplex_subsets.h"
#include "surface/error.h"

namespace tangi {

namespace {

constexpr std::size_t kKept = 1500;  // sets of looks that are compared exactly
constexpr double kColourPart =
    0.5;                        // of differences in colour: they fuse from nearer than those in lightness
constexpr double kAlike = 0.5;  // CIEDE2000 that nobody sees at a distance

struct Judged {
    const SubsetFit* fit;
    double delta_e, contrast;
};

}  // namespace

Juxtaposition juxtapose(std::span<const Spectrum> looks, const Spectrum& target,
                        std::span<const Illuminant> lamps, const Spectrum& bare, double bare_share) {
    TP_REQUIRE(!looks.empty() && !lamps.empty(), "looks and lamps");
    TP_REQUIRE(bare_share >= 0 && bare_share < 1, "a part of the area is painted");
    const auto painted = static_cast<float>(1 - bare_share);
    // Columns: what each look alone would be off by, in colour, linearised at the target.
    std::vector<std::vector<double>> columns(looks.size());
    for (const Illuminant lamp : lamps) {
        const Lab there = lab_under(target, lamp);
        std::array<glm::dvec3, kBands> slope;
        for (std::size_t band = 0; band < kBands; ++band) {
            Spectrum moved = target;
            moved[band] += 1e-3f;
            slope[band] = delta_e_2000_parts(there, lab_under(moved, lamp)) * 1e3;
        }
        for (std::size_t k = 0; k < looks.size(); ++k) {
            glm::dvec3 off(0);
            for (std::size_t band = 0; band < kBands; ++band)
                off += slope[band] * static_cast<double>(painted * looks[k][band] +
                                                         (1 - painted) * bare[band] - target[band]);
            for (int i = 0; i < 3; ++i) columns[k].push_back(off[i]);
        }
    }
    const auto n = looks.size();
    std::vector<double> gram(n * n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t r = 0; r < columns[i].size(); ++r)
                gram[i * n + j] += columns[i][r] * columns[j][r];
    const auto fits = best_subsets(gram, static_cast<int>(n), kMostPaints, kKept);
    std::vector<Judged> judged;
    for (const SubsetFit& fit : fits) {
        Spectrum mean;
        for (std::size_t band = 0; band < kBands; ++band) mean[band] = (1 - painted) * bare[band];
        glm::dvec3 each[kMostPaints], middle(0);
        double contrast = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(fit.count); ++i) {
            const Spectrum& look = looks[static_cast<std::size_t>(fit.columns[i])];
            for (std::size_t band = 0; band < kBands; ++band)
                mean[band] += painted * static_cast<float>(fit.weights[i]) * look[band];
            const Lab lab = lab_under(look);
            each[i] = {lab.l, kColourPart * lab.a, kColourPart * lab.b};
            middle += fit.weights[i] * each[i];
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(fit.count); ++i)
            contrast += fit.weights[i] * glm::dot(each[i] - middle, each[i] - middle);
        double worst = 0;
        for (const Illuminant lamp : lamps)
            worst = std::max(worst, delta_e_2000(lab_under(mean, lamp), lab_under(target, lamp)));
        judged.push_back({&fit, worst, contrast});
    }
    double least = 1e300;
    for (const Judged& j : judged) least = std::min(least, j.delta_e);
    const Judged* best = nullptr;
    for (const Judged& j : judged)
        if (j.delta_e <= least + kAlike && (!best || j.contrast < best->contrast)) best = &j;
    Juxtaposition result;
    result.delta_e = best->delta_e;
    for (std::size_t i = 0; i < static_cast<std::size_t>(best->fit->count); ++i) {
        result.looks.push_back(best->fit->columns[i]);
        result.shares.push_back(best->fit->weights[i]);
    }
    return result;
}

}  // namespace tangi
