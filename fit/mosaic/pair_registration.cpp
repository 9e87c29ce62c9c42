#include "fit/mosaic/pair_registration.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "capture/registration/motion.h"
#include "fit/mosaic/patch_shift.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

using glm::dvec2;

constexpr double kInlierPx = 3;     // [pixels of what features are sought in], as register_pictures() has it
constexpr int kLeastFeatures = 15;  // likewise
constexpr int kLeastTies = 4;       // a homography's
constexpr int kPatch = 48;          // [pixels of the level] side of a patch
constexpr int kLeastPatch = 16;
constexpr int kMostPatches = 12;  // along a side of the overlap
constexpr int kReach = 8;         // [pixels of the level] that a patch may be off
constexpr double kStrayPx = 1;    // [pixels of the level] of a patch against the homography of all
constexpr double kLeastCorrelation = 0.5;
constexpr double kLargestScale = 4;

// All features that look alike, in pixels of the positions.
struct Candidates {
    std::vector<dvec2> from, to;
    void add(const PictureFeatures& first, int first_reduction, const PictureFeatures& second,
             int second_reduction) {
        const FeatureMatches matches = matches_of(first, second);
        const Homography a = enlarging(first_reduction) * enlarging(1 / first.scale),
                         b = enlarging(second_reduction) * enlarging(1 / second.scale);
        for (const dvec2& p : matches.from) from.push_back(mapped(a, p));
        for (const dvec2& p : matches.to) to.push_back(mapped(b, p));
    }
};

// [1] sqrt of the area that a pixel in the middle becomes, < 0 where it is mirrored.
double scale_of(const Homography& h, const MosaicPosition& position) {
    const dvec2 p = dvec2(position.width - 1, position.height - 1) / 2.0;
    const double area = cross(mapped(h, p + dvec2(0.5, 0)) - mapped(h, p - dvec2(0.5, 0)),
                              mapped(h, p + dvec2(0, 0.5)) - mapped(h, p - dvec2(0, 0.5)));
    return area > 0 ? std::sqrt(area) : -1;
}

bool is_in(const dvec2& p, const MosaicPosition& position, double margin) {
    return p.x >= margin && p.y >= margin && p.x <= position.width - 1 - margin &&
           p.y <= position.height - 1 - margin;
}

// Patches of the first position that lie in the second, in pixels of the first.
struct PatchGrid {
    int side = 0;  // [pixels]
    std::vector<dvec2> centres;
};

// What of the first the second shows: its bounds, and what part of it.
struct Overlap {
    dvec2 low{0}, high{0};
    double part = 0;
};
Overlap overlap_of(const MosaicPosition& a, const MosaicPosition& b, const Homography& h) {
    constexpr int kSamples = 64;
    Overlap overlap{dvec2(1e30), dvec2(-1e30), 0};
    for (int j = 0; j <= kSamples; ++j)
        for (int i = 0; i <= kSamples; ++i) {
            const dvec2 p = dvec2(i, j) / double(kSamples) * dvec2(a.width - 1, a.height - 1);
            if (!is_in(mapped(h, p), b, 0)) continue;
            overlap.low = glm::min(overlap.low, p), overlap.high = glm::max(overlap.high, p);
            overlap.part += 1.0 / ((kSamples + 1) * (kSamples + 1));
        }
    return overlap;
}

PatchGrid patches_in(const Overlap& overlap, const MosaicPosition& a, const MosaicPosition& b,
                     const Homography& h, int reduction) {
    PatchGrid grid;
    const dvec2 size = overlap.high - overlap.low;
    const int fits = static_cast<int>(std::min(size.x, size.y)) / reduction - 4;
    grid.side = reduction * std::clamp(fits / 3, kLeastPatch, kPatch);
    const auto count = [&](double along) {
        return std::clamp(static_cast<int>(along / grid.side), 1, kMostPatches);
    };
    const int columns = count(size.x), rows = count(size.y);
    const double half = grid.side / 2.0;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const dvec2 centre = overlap.low + size * (dvec2(i, j) + 0.5) / dvec2(columns, rows);
            const bool inside = std::ranges::all_of(
                std::array{dvec2(-half), dvec2(half, -half), dvec2(half), dvec2(-half, half)},
                [&](const dvec2& corner) {
                    return is_in(centre + corner, a, 0) && is_in(mapped(h, centre + corner), b, 0);
                });
            if (inside) grid.centres.push_back(centre);
        }
    return grid;
}

Region around(const dvec2& low, const dvec2& high, int margin) {
    return {static_cast<int>(std::floor(low.x)) - margin, static_cast<int>(std::floor(low.y)) - margin,
            static_cast<int>(std::ceil(high.x)) + margin + 1,
            static_cast<int>(std::ceil(high.y)) + margin + 1};
}

// The tie of one patch; of correlation 0 where there is none.
TiePoint tie_at(const dvec2& centre, int side, const MosaicPosition& a, const MosaicPosition& b,
                const Homography& h, int reduction) {
    const double half = side / 2.0;
    const int blur = kLookMargin * reduction;
    const PositionLook own = look_at(a, around(centre - half, centre + half, blur), reduction);
    dvec2 low(1e30), high(-1e30);
    for (const dvec2& corner : {dvec2(-half), dvec2(half, -half), dvec2(half), dvec2(-half, half)}) {
        const dvec2 q = mapped(h, centre + corner);
        low = glm::min(low, q), high = glm::max(high, q);
    }
    const PositionLook other = look_at(b, around(low, high, blur + kReach * reduction), reduction);
    TiePoint tie{centre, mapped(h, centre)};
    if (own.part.empty() || other.part.empty()) return tie;
    // Pixels of one look to those of the other.
    const auto to_look = [](const PositionLook& look) {
        return glm::inverse(enlarging(look.reduction)) *
               Homography(1, 0, 0, 0, 1, 0, -look.part.x0, -look.part.y0, 1);
    };
    const Homography between = to_look(other) * h * glm::inverse(to_look(own));
    const PatchShift shift = patch_shift({own.paint, own.relief}, {other.paint, other.relief},
                                         own.reduced(centre), half / reduction, between, kReach);
    if (!shift.found) return tie;
    tie.second = mapped(glm::inverse(to_look(other)), mapped(between, own.reduced(centre)) + shift.shift);
    tie.sigma_px = shift.sigma * reduction;
    tie.correlation = shift.correlation;
    return tie;
}

void take_homography(PairRegistration& pair, double stray) {
    std::vector<dvec2> from, to;
    for (const TiePoint& tie : pair.ties) from.push_back(tie.first), to.push_back(tie.second);
    if (const auto h = homography_through(from, to, stray)) pair.to_second = normalised(*h);
    std::erase_if(pair.ties, [&](const TiePoint& tie) {
        return glm::distance(mapped(pair.to_second, tie.first), tie.second) > 2 * stray;
    });
}

void refine(PairRegistration& pair, const MosaicPosition& a, const MosaicPosition& b, double coarseness) {
    for (int level = std::max(static_cast<int>(std::ceil(std::log2(coarseness))), 0); level >= 0; --level) {
        const int reduction = 1 << level;
        const Overlap overlap = overlap_of(a, b, pair.to_second);
        pair.overlap = overlap.part;
        const PatchGrid grid = patches_in(overlap, a, b, pair.to_second, reduction);
        pair.ties.clear();
        for (const dvec2& centre : grid.centres)
            if (const TiePoint tie = tie_at(centre, grid.side, a, b, pair.to_second, reduction);
                tie.correlation > kLeastCorrelation)
                pair.ties.push_back(tie);
        take_homography(pair, kStrayPx * reduction);
    }
}

}  // namespace

PositionFeatures features_of(const MosaicPosition& position) {
    const PositionOverview overview = overview_of(position);
    return {overview.reduction, features_of(overview.paint), features_of(overview.relief)};
}

PairRegistration register_pair(const std::vector<MosaicPosition>& positions,
                               const std::vector<PositionFeatures>& features, std::size_t first,
                               std::size_t second) {
    const MosaicPosition &a = positions[first], &b = positions[second];
    const PositionFeatures &of_a = features[first], &of_b = features[second];
    PairRegistration pair;
    pair.first = first, pair.second = second;
    Candidates all;
    all.add(of_a.paint, of_a.reduction, of_b.paint, of_b.reduction);
    all.add(of_a.relief, of_a.reduction, of_b.relief, of_b.reduction);
    const double coarseness = std::max(of_a.reduction / of_a.paint.scale, of_b.reduction / of_b.paint.scale);
    const double stray = kInlierPx * of_b.reduction / of_b.paint.scale;
    const auto h = homography_through(all.from, all.to, stray);
    if (h) {
        pair.to_second = normalised(*h);
        for (std::size_t i = 0; i < all.from.size(); ++i)
            pair.features += glm::distance(mapped(*h, all.from[i]), all.to[i]) < stray;
    }
    if (pair.features < kLeastFeatures) {
        pair.why = fmt::format("{} features of one are found in the other", pair.features);
        return pair;
    }
    const double scale = scale_of(pair.to_second, a);
    if (!(scale > 1 / kLargestScale && scale < kLargestScale)) {
        pair.why = scale < 0 ? "one is mirrored" : "one is more than four times as large as the other";
        return pair;
    }
    refine(pair, a, b, coarseness);
    if (pair.ties.size() < kLeastTies)
        pair.why = fmt::format("{} features fit, but {} patches of paint and relief do", pair.features,
                               pair.ties.size());
    return pair;
}

}  // namespace tangi
