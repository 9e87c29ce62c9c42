#include "retouch/inpaint/line_colours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

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

struct MarkCounts {
    int marks = 0, bare = 0, painted = 0;  // of the last two, pixels
    double bare_share() const { return bare / static_cast<double>(bare + painted); }
};

MarkCounts counted(const LinesToColour& lines) {
    MarkCounts counts;
    for (std::size_t i = 0; i < lines.owner.size(); ++i) {
        if (lines.mask.pixels()[i] < 0.5f) continue;
        ++(lines.owner.pixels()[i] < 0 ? counts.bare : counts.painted);
        counts.marks = std::max(counts.marks, lines.owner.pixels()[i] + 1);
    }
    if (counts.painted == 0)
        fail("no line lies in the mask, which is narrower than --pitch-mm; give a finer one");
    return counts;
}

glm::dvec3 xyz_under_d65(const Spectrum& s) { return xyz_of(s, Illuminant::d65); }

// A pile for each mark: first by the shares of its group, then as its neighbours leave least to be desired.
class LineColouring {
public:
    LineColouring(const LinesToColour& lines, const Spectrum& below, int marks)
        : lines_(lines),
          below_(below),
          marks_(static_cast<std::size_t>(marks)),
          errors_(lines.mask.width(), lines.mask.height(), std::max(static_cast<int>(lines.blur_px / 2), 1)) {
        result_.piles = lines.gaps;
        for (const Rgb& group : lines.groups) group_xyz_.push_back(xyz_under_d65(reflectance_of_rgb(group)));
    }

    // Pure colours of each group, of which `bare_share` of the area is left.
    void offer_pure(const std::vector<Pile>& offered, std::span<const Illuminant> illuminants,
                    double bare_share) {
        std::vector<Spectrum> looks;
        for (const Pile& pile : offered) looks.push_back(pile.look);
        std::map<int, int> number_of_offered;
        for (std::size_t group = 0; group < lines_.groups.size(); ++group) {
            const Spectrum wanted = reflectance_of_rgb(lines_.groups[group]);
            const Juxtaposition pure =
                juxtapose(looks, wanted, illuminants, lines_.gaps.empty() ? below_ : lines_.gaps[group].look,
                          bare_share);
            piles_of_group_.emplace_back();
            for (std::size_t i = 0; i < pure.looks.size(); ++i) {
                const int look = pure.looks[i];
                const auto [at, added] =
                    number_of_offered.try_emplace(look, static_cast<int>(result_.piles.size()));
                if (added) {
                    result_.piles.push_back(offered[static_cast<std::size_t>(look)]);
                    result_.piles.back().target = wanted;
                }
                piles_of_group_.back().emplace_back(at->second, pure.shares[i]);
            }
        }
        for (const Pile& pile : result_.piles) pile_xyz_.push_back(xyz_under_d65(pile.look));
    }

    // What is wanted where they are, and how far off what lies between them is.
    void look_at_marks() {
        const Mask& mask = lines_.mask;
        result_.pile = Image<int>(mask.width(), mask.height(), -1);
        const glm::dvec3 below_xyz = xyz_under_d65(below_);
        const bool bare = lines_.gaps.empty();
        for (int y = 0; y < mask.height(); ++y)
            for (int x = 0; x < mask.width(); ++x) {
                if (mask(x, y) < 0.5f) continue;
                const glm::dvec3 wanted = xyz_under_d65(reflectance_of_rgb(lines_.target(x, y)));
                if (lines_.owner(x, y) >= 0) {
                    add_to_mark(x, y, wanted);
                    continue;
                }
                if (!bare) result_.pile(x, y) = static_cast<int>(group_of(wanted));
                errors_.add(x, y, (bare ? below_xyz : pile_xyz_[group_of(wanted)]) - wanted);
            }
        for (MarkShares& mark : marks_)
            mark.group = group_of(mark.whole.target / std::max(static_cast<double>(mark.whole.pixels), 1.0));
    }

    void choose() {
        chosen_ = by_shares(marks_, piles_of_group_);
        for (std::size_t m = 0; m < marks_.size(); ++m) lay(m);
        bool changed = true;
        for (int sweep = 0; sweep < kSweeps && changed; ++sweep) {
            changed = false;
            for (std::size_t m = 0; m < marks_.size(); ++m)
                if (marks_[m].whole.pixels > 0) changed = improve(m) || changed;
        }
    }

    LineColours result() {
        for (std::size_t i = 0; i < lines_.owner.size(); ++i)
            if (lines_.owner.pixels()[i] >= 0 && lines_.mask.pixels()[i] >= 0.5f)
                result_.pile.pixels()[i] = chosen_[static_cast<std::size_t>(lines_.owner.pixels()[i])];
        return std::move(result_);
    }

private:
    std::size_t group_of(const glm::dvec3& wanted) const {
        std::size_t best = 0;
        for (std::size_t g = 1; g < group_xyz_.size(); ++g)
            if (glm::length(group_xyz_[g] - wanted) < glm::length(group_xyz_[best] - wanted)) best = g;
        return best;
    }

    void add_to_mark(int x, int y, const glm::dvec3& wanted) {
        MarkShares& mark = marks_[static_cast<std::size_t>(lines_.owner(x, y))];
        ++mark.whole.pixels, mark.whole.target += wanted;
        for (const std::size_t square : errors_.squares_of(x, y)) {
            Share& share = mark.by_square[square];
            ++share.pixels, share.target += wanted;
        }
    }

    const glm::dvec3& xyz_of_chosen(std::size_t m) const {
        return pile_xyz_[static_cast<std::size_t>(chosen_[m])];
    }
    void lay(std::size_t m) {
        for (const auto& [square, share] : marks_[m].by_square)
            errors_[square] += share.error(xyz_of_chosen(m));
    }
    void lift(std::size_t m) {
        for (const auto& [square, share] : marks_[m].by_square)
            errors_[square] -= share.error(xyz_of_chosen(m));
    }

    // Takes that pile of the mark's group with which least error is left; true where it is another one.
    bool improve(std::size_t m) {
        const int before = chosen_[m];
        lift(m);
        double least = 1e300;
        for (const auto& [pile, share_of_area] : piles_of_group_[marks_[m].group]) {
            double energy = 0;
            for (const auto& [square, share] : marks_[m].by_square) {
                const glm::dvec3 e = errors_[square] + share.error(pile_xyz_[static_cast<std::size_t>(pile)]);
                energy += glm::dot(e, e);
            }
            if (energy < least) least = energy, chosen_[m] = pile;
        }
        lay(m);
        return chosen_[m] != before;
    }

    const LinesToColour& lines_;
    const Spectrum& below_;
    std::vector<MarkShares> marks_;
    Errors errors_;
    std::vector<glm::dvec3> group_xyz_, pile_xyz_;
    std::vector<std::vector<std::pair<int, double>>> piles_of_group_;  // with their shares
    std::vector<int> chosen_;                                          // of each mark
    LineColours result_;
};

}  // namespace

LineColours line_colours(const LinesToColour& lines, const Palette& palette, const Spectrum& below,
                         const RetouchOptions& options) {
    TP_REQUIRE(lines.owner.region() == lines.mask.region() && lines.target.region() == lines.mask.region(),
               "of the same region");
    TP_REQUIRE(!lines.groups.empty() && (lines.gaps.empty() || lines.gaps.size() == lines.groups.size()),
               "a group of colours");
    const MarkCounts counts = counted(lines);
    LineColouring colouring(lines, below, counts.marks);
    colouring.offer_pure(pure_piles(palette, below, options), options.match.illuminants, counts.bare_share());
    colouring.look_at_marks();
    colouring.choose();
    return colouring.result();
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
