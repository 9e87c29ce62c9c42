#include "capture/radiometry/colour_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr int kLineRounds = 8;
constexpr double kBisquare = 4.685;      // 95 % of the efficiency of least squares (Tukey's biweight)
constexpr double kMadOfNormal = 0.6745;  // median of |x| of a normal distribution of deviation 1
constexpr double kLeastPart = 1e-3;      // [1] of the weight

// Weighted sums of a line's normal equations.
struct LineSums {
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    void add(double weight, double at, double value) {
        w += weight, x += weight * at, y += weight * value;
        xx += weight * at * at, xy += weight * at * value;
    }
    void take(const LineSums& o) { w -= o.w, x -= o.x, y -= o.y, xx -= o.xx, xy -= o.xy; }
    double mean() const { return x / w; }
    double spread() const { return std::max(xx / w - mean() * mean(), 0.0); }
    double slope(double prior) const {
        const double all = spread() + prior;
        return all > 0 ? (xy / w - mean() * y / w) / all : 0;
    }
    double at_zero(double prior) const { return y / w - slope(prior) * mean(); }
};

// Of each say: its part, and of its part's the quarter that it belongs to by its veil.
std::vector<std::size_t> groups_of(std::span<const ColourSay> says) {
    std::array<std::vector<std::size_t>, kColourParts> parts;
    for (std::size_t i = 0; i < says.size(); ++i) parts[says[i].part].push_back(i);
    std::vector<std::size_t> groups(says.size());
    for (std::size_t p = 0; p < kColourParts; ++p) {
        std::stable_sort(parts[p].begin(), parts[p].end(),
                         [&](std::size_t a, std::size_t b) { return says[a].veil < says[b].veil; });
        for (std::size_t n = 0; n < parts[p].size(); ++n)
            groups[parts[p][n]] = p * kColourStrata + n * kColourStrata / parts[p].size();
    }
    return groups;
}

// Variance of the value at white, by leaving out what `kind` makes one of, in turn; 0 where that is nothing.
template <class Kind>
double jackknife(const std::array<LineSums, kColourGroups>& groups, const LineSums& all, double prior,
                 const Kind& kind) {
    std::array<LineSums, kColourGroups> rest;
    rest.fill(all);
    for (std::size_t g = 0; g < kColourGroups; ++g) rest[kind(g)].take(groups[g]);
    double count = 0, mean = 0, squares = 0;
    const auto told = [&](const LineSums& r) {  // something is left out, and something is left
        return r.w < (1 - kLeastPart) * all.w && r.w > kLeastPart * all.w;
    };
    for (const LineSums& r : rest)
        if (told(r)) mean += r.at_zero(prior), ++count;
    if (count < 2) return 0;
    mean /= count;
    for (const LineSums& r : rest)
        if (told(r)) squares += (r.at_zero(prior) - mean) * (r.at_zero(prior) - mean);
    return squares * (count - 1) / count;
}

// The line that the sums say, and what is left at a say, in units of the usual one's scatter.
struct WeightedLine {
    double at_white = 0, slope = 0;
    double rest(const ColourSay& say, double usual_min_gain) const {
        return (say.off - at_white - slope * say.veil) * std::sqrt(say.worth / usual_min_gain);
    }
};

double usual_min_gain(std::span<const ColourSay> says) {
    std::vector<double> worths;
    for (const ColourSay& say : says) worths.push_back(say.worth);
    return median(std::move(worths));
}

}  // namespace

ColourLine colour_line(std::span<const ColourSay> says, double veil_sigma) {
    const double usual = usual_min_gain(says);
    if (!(usual > 0)) return {};
    const std::vector<std::size_t> group = groups_of(says);
    std::array<LineSums, kColourGroups> groups;
    LineSums all;
    WeightedLine line;
    double sigma = 0, prior = 0;  // none yet: all count
    std::vector<double> rests(says.size());
    for (int round = 0; round < kLineRounds; ++round) {
        groups = {};
        all = {};
        for (std::size_t i = 0; i < says.size(); ++i) {
            const double u = sigma > 0 ? line.rest(says[i], usual) / (kBisquare * sigma) : 0;
            if (std::abs(u) >= 1) continue;
            const double w = says[i].worth / usual * (1 - u * u) * (1 - u * u);
            groups[group[i]].add(w, says[i].veil, says[i].off);
            all.add(w, says[i].veil, says[i].off);
        }
        if (!(all.w > 0)) return {};
        line = {all.at_zero(prior), all.slope(prior)};
        for (std::size_t i = 0; i < says.size(); ++i) rests[i] = std::abs(line.rest(says[i], usual));
        sigma = std::max(median(rests) / kMadOfNormal, kHalfCode);
        prior = sigma * sigma / (veil_sigma * veil_sigma * static_cast<double>(kColourParts * kColourStrata));
    }
    const double by_parts = jackknife(groups, all, prior, [](std::size_t g) { return g / kColourStrata; });
    const double by_strata = jackknife(groups, all, prior, [](std::size_t g) { return g % kColourStrata; });
    // What is left of the veil's own uncertainty where the pixels do not tell it; and what strong veils bend,
    // which the line takes for straight: the second term of ln(1 + v).
    const double of_veil = all.mean() * all.mean() * veil_sigma * veil_sigma * prior / (all.spread() + prior);
    const double of_bend = kMostVeil / 2 * line.slope * all.mean();
    const double alike = (by_parts + by_strata > 0 ? by_strata : sigma * sigma) + of_veil +
                         of_bend * of_bend + kHalfCode * kHalfCode;
    // A part's variance is that of the mean of all, times their number.
    constexpr double parts = static_cast<double>(kColourParts);
    return {line.at_white, std::sqrt(by_parts + alike), std::sqrt(parts * by_parts),
            std::sqrt(parts * alike)};
}

double largest_veil(const Vec3& direction) {
    // Of Ward's lobe, rho_s exp(-t^2 / alpha^2) / (4 pi alpha^2), t the tangent of the half vector's angle,
    // over matt paint's rho_d / pi: largest where alpha = t.
    constexpr double gloss = 0.04;     // [1] Fresnel's reflectance of an index of 1.5, straight down
    constexpr double middling = 0.18;  // [1] reflectance of the photographers' grey card
    const double z = std::clamp(static_cast<double>(direction.z), -0.99, 1.0);
    const double t2 = std::max((1 - z) / (1 + z), 1e-6);
    return std::min(gloss / (4 * std::numbers::e * middling * t2), kMostVeil);
}

}  // namespace tangi
