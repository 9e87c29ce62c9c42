#include "retouch/inpaint/line_colours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "paint/optics/drawdown_card.h"
#include "paint/optics/kubelka_munk.h"
#include "retouch/inpaint/optical_mixing.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr int kSweeps = 6;

// The paints by themselves, and let down with white and with black (the paint nearest to it) in
// easy measures.
std::vector<Pile> pure_piles(const Palette& palette, const Spectrum& below, const RetouchOptions& options) {
    const int white = palette.find(white_of(palette).name);
    int black = 0;
    const auto from_black = [&](int paint) {
        const Pigment& p = palette.paints[static_cast<std::size_t>(paint)];
        if (is_clear(p)) return std::numeric_limits<double>::max();
        const Lab lab = lab_under(opaque_look({p.k, p.s}));
        return std::hypot(lab.l, lab.a, lab.b);
    };
    for (int paint = 1; paint < static_cast<int>(palette.paints.size()); ++paint)
        if (from_black(paint) < from_black(black)) black = paint;
    // How many measures of what go with one of the paint, or with how many.
    const std::array<std::array<int, 3>, 6> ways = {
        {{-1, 0, 1}, {white, 1, 1}, {white, 3, 1}, {white, 8, 1}, {black, 1, 3}, {black, 1, 1}}};
    const std::size_t n = palette.paints.size();
    const auto may_come_together = [&](int a, int b) {
        return options.match.allowed.empty() ||
               options.match.allowed[static_cast<std::size_t>(a) * n + static_cast<std::size_t>(b)];
    };
    std::vector<Pile> piles;
    for (int paint = 0; paint < static_cast<int>(palette.paints.size()); ++paint)
        for (const auto& [other, of_other, of_paint] : ways) {
            if (of_other > 0 && (other < 0 || paint == other || !may_come_together(other, paint))) continue;
            Pile pile;
            if (of_other == 0)
                pile.steps = {{paint, 0, 1}};
            else
                pile.steps = {{other, 0, 1}, {paint, of_other, of_paint}};
            pile.mixture = mixture_of(pile.steps);
            std::vector<Pigment> pigments;
            std::vector<float> volumes;
            for (std::size_t i = 0; i < static_cast<std::size_t>(pile.mixture.count); ++i) {
                pigments.push_back(palette.paints[static_cast<std::size_t>(pile.mixture.paints[i])]);
                volumes.push_back(static_cast<float>(pile.mixture.volumes[i]));
            }
            pile.look = film_look(mix(pigments, volumes), static_cast<float>(options.thickness_mm), below);
            piles.push_back(pile);
        }
    return piles;
}

// A mark's pixels and the sum of XYZ that is wanted there: in all, and in each square that it touches.
struct Share {
    int pixels = 0;
    glm::dvec3 target{0};
    glm::dvec3 error(const glm::dvec3& pile) const { return static_cast<double>(pixels) * pile - target; }
};
struct MarkShares {
    Share whole;
    std::map<std::size_t, Share> by_square;
    std::size_t group = 0;
};

// Sums of the error of XYZ in overlapping squares, each `step` pixels from the next and twice as wide.
class Errors {
public:
    Errors(int width, int height, int step)
        : step_(step),
          columns_(width / step + 2),
          rows_(height / step + 2),
          sums_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), glm::dvec3(0)) {}

    void add(int x, int y, const glm::dvec3& error) {
        for (const std::size_t square : squares_of(x, y)) sums_[square] += error;
    }
    // The squares that a pixel lies in.
    std::array<std::size_t, 4> squares_of(int x, int y) const {
        const int u = x / step_, v = y / step_;
        return {at(u, v), at(u + 1, v), at(u, v + 1), at(u + 1, v + 1)};
    }
    glm::dvec3& operator[](std::size_t square) { return sums_[square]; }

private:
    std::size_t at(int u, int v) const {
        return static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(u);
    }
    int step_, columns_, rows_;
    std::vector<glm::dvec3> sums_;
};

// A pile for every mark, each in its group's shares of the area, spread evenly over the marks as they come.
std::vector<int> by_shares(const std::vector<MarkShares>& marks,
                           const std::vector<std::vector<std::pair<int, double>>>& piles_of_group) {
    std::vector<int> chosen(marks.size(), piles_of_group[0][0].first);
    std::vector<double> area(piles_of_group.size());
    std::vector<std::vector<double>> painted;
    for (const auto& piles : piles_of_group) painted.emplace_back(piles.size());
    for (std::size_t m = 0; m < marks.size(); ++m) {
        const std::size_t g = marks[m].group;
        area[g] += marks[m].whole.pixels;
        std::size_t most = 0;
        const auto missing = [&](std::size_t i) {
            return piles_of_group[g][i].second * area[g] - painted[g][i];
        };
        for (std::size_t i = 1; i < painted[g].size(); ++i)
            if (missing(i) > missing(most)) most = i;
        painted[g][most] += marks[m].whole.pixels;
        chosen[m] = piles_of_group[g][most].first;
    }
    return chosen;
}

}  // namespace

LineColours line_colours(const Image<int>& owner, const Mask& mask, const Image<Rgb>& target,
                         const std::vector<Rgb>& groups, const std::vector<Pile>& gaps,
                         const Palette& palette, const Spectrum& below, const RetouchOptions& options,
                         double blur_px) {
    TP_REQUIRE(owner.region() == mask.region() && target.region() == mask.region(), "of the same region");
    TP_REQUIRE(!groups.empty() && (gaps.empty() || gaps.size() == groups.size()), "a group of colours");
    const auto xyz = [](const Spectrum& s) { return xyz_of(s, Illuminant::d65); };
    int count = 0, bare = 0, painted = 0;
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (mask.pixels()[i] < 0.5f) continue;
        ++(owner.pixels()[i] < 0 ? bare : painted);
        count = std::max(count, owner.pixels()[i] + 1);
    }
    if (painted == 0) fail("no line lies in the mask, which is narrower than --pitch-mm; give a finer one");
    const double bare_share = bare / static_cast<double>(bare + painted);

    // Pure colours of each group.
    const std::vector<Pile> offered = pure_piles(palette, below, options);
    std::vector<Spectrum> looks;
    for (const Pile& pile : offered) looks.push_back(pile.look);
    LineColours result;
    result.piles = gaps;
    std::vector<std::vector<std::pair<int, double>>> piles_of_group;  // with their shares
    std::map<int, int> number_of_offered;
    for (std::size_t group = 0; group < groups.size(); ++group) {
        const Spectrum wanted = reflectance_of_rgb(groups[group]);
        const Juxtaposition pure = juxtapose(looks, wanted, options.match.illuminants,
                                             gaps.empty() ? below : gaps[group].look, bare_share);
        piles_of_group.emplace_back();
        for (std::size_t i = 0; i < pure.looks.size(); ++i) {
            const int look = pure.looks[i];
            const auto [at, added] =
                number_of_offered.try_emplace(look, static_cast<int>(result.piles.size()));
            if (added) {
                result.piles.push_back(offered[static_cast<std::size_t>(look)]);
                result.piles.back().target = wanted;
            }
            piles_of_group.back().emplace_back(at->second, pure.shares[i]);
        }
    }

    // Marks, and what is wanted where they are.
    std::vector<MarkShares> marks(static_cast<std::size_t>(count));
    Errors errors(mask.width(), mask.height(), std::max(static_cast<int>(blur_px / 2), 1));
    std::vector<glm::dvec3> group_xyz, pile_xyz;
    for (const Rgb& group : groups) group_xyz.push_back(xyz(reflectance_of_rgb(group)));
    for (const Pile& pile : result.piles) pile_xyz.push_back(xyz(pile.look));
    const auto group_of = [&](const glm::dvec3& wanted) {
        std::size_t best = 0;
        for (std::size_t g = 1; g < group_xyz.size(); ++g)
            if (glm::length(group_xyz[g] - wanted) < glm::length(group_xyz[best] - wanted)) best = g;
        return best;
    };
    result.pile = Image<int>(mask.width(), mask.height(), -1);
    const glm::dvec3 below_xyz = xyz(below);
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            if (mask(x, y) < 0.5f) continue;
            const glm::dvec3 wanted = xyz(reflectance_of_rgb(target(x, y)));
            if (owner(x, y) < 0) {
                if (!gaps.empty()) result.pile(x, y) = static_cast<int>(group_of(wanted));
                errors.add(x, y, (gaps.empty() ? below_xyz : pile_xyz[group_of(wanted)]) - wanted);
                continue;
            }
            MarkShares& mark = marks[static_cast<std::size_t>(owner(x, y))];
            ++mark.whole.pixels, mark.whole.target += wanted;
            for (const std::size_t square : errors.squares_of(x, y)) {
                Share& share = mark.by_square[square];
                ++share.pixels, share.target += wanted;
            }
        }
    for (MarkShares& mark : marks)
        mark.group = group_of(mark.whole.target / std::max(static_cast<double>(mark.whole.pixels), 1.0));
    std::vector<int> chosen = by_shares(marks, piles_of_group);
    for (std::size_t m = 0; m < marks.size(); ++m)
        for (const auto& [square, share] : marks[m].by_square)
            errors[square] += share.error(pile_xyz[static_cast<std::size_t>(chosen[m])]);
    bool changed = true;
    for (int sweep = 0; sweep < kSweeps && changed; ++sweep) {
        changed = false;
        for (std::size_t m = 0; m < marks.size(); ++m) {
            if (marks[m].whole.pixels == 0) continue;
            const int before = chosen[m];
            for (const auto& [square, share] : marks[m].by_square)
                errors[square] -= share.error(pile_xyz[static_cast<std::size_t>(before)]);
            double least = 1e300;
            for (const auto& [pile, share_of_area] : piles_of_group[marks[m].group]) {
                double energy = 0;
                for (const auto& [square, share] : marks[m].by_square) {
                    const glm::dvec3 e =
                        errors[square] + share.error(pile_xyz[static_cast<std::size_t>(pile)]);
                    energy += glm::dot(e, e);
                }
                if (energy < least) least = energy, chosen[m] = pile;
            }
            for (const auto& [square, share] : marks[m].by_square)
                errors[square] += share.error(pile_xyz[static_cast<std::size_t>(chosen[m])]);
            changed = changed || chosen[m] != before;
        }
    }
    for (std::size_t i = 0; i < owner.size(); ++i)
        if (owner.pixels()[i] >= 0 && mask.pixels()[i] >= 0.5f)
            result.pile.pixels()[i] = chosen[static_cast<std::size_t>(owner.pixels()[i])];
    return result;
}

FusedDifference::FusedDifference(const Mask& mask, int cell_px) : cell_px_(std::max(cell_px, 1)) {
    TP_REQUIRE(!mask.empty(), "a mask");
}

void FusedDifference::add(int x, int y, const Spectrum& look, const Spectrum& target) {
    Cell& cell = cells_[{y / cell_px_, x / cell_px_}];
    for (std::size_t band = 0; band < kBands; ++band) {
        cell.look[band] += static_cast<double>(look[band]);
        cell.target[band] += static_cast<double>(target[band]);
    }
    ++cell.pixels;
}

std::array<double, kIlluminants> FusedDifference::means() const {
    std::array<double, kIlluminants> sums{};
    double weights = 0;
    // Small masks have no whole cell: then what there is counts.
    int largest = 0;
    for (const auto& [at, cell] : cells_) largest = std::max(largest, cell.pixels);
    for (const auto& [at, cell] : cells_) {
        if (2 * cell.pixels < std::min(largest, cell_px_ * cell_px_)) continue;
        Spectrum look, target;
        for (std::size_t band = 0; band < kBands; ++band) {
            look[band] = static_cast<float>(cell.look[band] / cell.pixels);
            target[band] = static_cast<float>(cell.target[band] / cell.pixels);
        }
        for (std::size_t illuminant = 0; illuminant < kIlluminants; ++illuminant) {
            const auto light = static_cast<Illuminant>(illuminant);
            sums[illuminant] += cell.pixels * delta_e_2000(lab_under(look, light), lab_under(target, light));
        }
        weights += cell.pixels;
    }
    for (double& sum : sums) sum /= std::max(weights, 1.0);
    return sums;
}

}  // namespace tangi
