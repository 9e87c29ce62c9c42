#include "fit/mosaic/mosaic_layout.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <queue>

#include "surface/base/error.h"

namespace tangi {

namespace {

using glm::dvec2;
using Parameters = std::array<double, 8>;

// [1] Standard deviation of shear and of perspective, at the rim of a picture and relative to its size: a
// camera that is tilted by 2 degrees at a distance of two pictures.
constexpr double kPrior = 0.02;
constexpr double kRobust = 3;             // [standard deviations] of Cauchy's loss
constexpr double kMostWallPixels = 64e9;  // [pixels] more is a homography that went astray
constexpr double kMostStretch = 4;        // [1] bounds of the wall over the sum of its positions

// Pixels about the picture's middle, in half diagonals, and back.
struct Normalisation {
    dvec2 centre{0};
    double radius = 1;
    explicit Normalisation(const MosaicPosition& p)
        : centre(dvec2(p.width - 1, p.height - 1) / 2.0), radius(std::hypot(p.width, p.height) / 2) {}
    dvec2 operator()(const dvec2& p) const { return (p - centre) / radius; }
    Homography matrix() const {
        return {1 / radius, 0, 0, 0, 1 / radius, 0, -centre.x / radius, -centre.y / radius, 1};
    }
};

Parameters parameters_of(const Homography& to_wall, const Normalisation& n) {
    const Homography h = normalised(to_wall * glm::inverse(n.matrix()));
    return {h[0][0], h[1][0], h[2][0], h[0][1], h[1][1], h[2][1], h[0][2], h[1][2]};
}

Homography homography_of(const Parameters& p, const Normalisation& n) {
    return normalised(Homography(p[0], p[3], p[6], p[1], p[4], p[7], p[2], p[5], 1) * n.matrix());
}

template <class T>
void apply(const T* p, const dvec2& at, T (&wall)[2]) {
    const T z = p[6] * at.x + p[7] * at.y + 1.0;
    wall[0] = (p[0] * at.x + p[1] * at.y + p[2]) / z;
    wall[1] = (p[3] * at.x + p[4] * at.y + p[5]) / z;
}

// [standard errors] between both ends of a tie on the wall.
struct TieResidual {
    dvec2 first, second;
    double sigma;
    template <class T>
    bool operator()(const T* a, const T* b, T* residual) const {
        T from[2], to[2];
        apply(a, first, from);
        apply(b, second, to);
        residual[0] = (from[0] - to[0]) / sigma;
        residual[1] = (from[1] - to[1]) / sigma;
        return true;
    }
};

// [standard deviations] of shear and perspective.
struct StandResidual {
    double size_px;  // of the picture's half diagonal on the wall
    template <class T>
    bool operator()(const T* p, T* residual) const {
        const double sigma_px = kPrior * size_px;
        residual[0] = (p[0] - p[4]) / (2 * sigma_px);
        residual[1] = (p[1] + p[3]) / (2 * sigma_px);
        residual[2] = p[6] / kPrior;
        residual[3] = p[7] / kPrior;
        return true;
    }
};

// First places, along the pairs with the most ties, from the anchor on (Prim 1957).
void place_first(const std::vector<PairRegistration>& pairs, MosaicLayout& layout) {
    using Link = std::pair<std::size_t, std::size_t>;  // ties, pair
    std::priority_queue<Link> open;
    const auto join = [&](std::size_t i, const Homography& to_wall) {
        layout.positions[i].joined = true, layout.positions[i].to_wall = to_wall;
        for (std::size_t k = 0; k < pairs.size(); ++k)
            if (pairs[k].joined() && (pairs[k].first == i || pairs[k].second == i))
                open.push({pairs[k].ties.size(), k});
    };
    join(layout.anchor, Homography(1));
    while (!open.empty()) {
        const PairRegistration& pair = pairs[open.top().second];
        open.pop();
        const PlacedPosition &a = layout.positions[pair.first], &b = layout.positions[pair.second];
        if (a.joined && !b.joined)
            join(pair.second, normalised(a.to_wall * glm::inverse(pair.to_second)));
        else if (b.joined && !a.joined)
            join(pair.first, normalised(b.to_wall * pair.to_second));
    }
}

class LayoutProblem {
public:
    LayoutProblem(const std::vector<MosaicPosition>& positions, const std::vector<PairRegistration>& pairs,
                  MosaicLayout& layout)
        : layout_(layout) {
        for (const MosaicPosition& p : positions) normalisations_.emplace_back(p);
        for (std::size_t i = 0; i < positions.size(); ++i)
            values_.push_back(parameters_of(layout.positions[i].to_wall, normalisations_[i]));
        for (const PairRegistration& pair : pairs)
            if (pair.joined() && layout.positions[pair.first].joined) add(pair);
        for (std::size_t i = 0; i < positions.size(); ++i)
            if (layout.positions[i].joined && i != layout.anchor) hold(i);
        if (problem_.HasParameterBlock(values_[layout.anchor].data()))
            problem_.SetParameterBlockConstant(values_[layout.anchor].data());
    }

    void solve() {
        if (problem_.NumResiduals() == 0) return;
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
        options.max_num_iterations = 200;
        options.function_tolerance = 1e-12;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem_, &summary);
        for (std::size_t i = 0; i < values_.size(); ++i)
            if (layout_.positions[i].joined && i != layout_.anchor)
                layout_.positions[i].to_wall = homography_of(values_[i], normalisations_[i]);
        find_errors();
    }

private:
    void add(const PairRegistration& pair) {
        const Normalisation &a = normalisations_[pair.first], &b = normalisations_[pair.second];
        for (const TiePoint& tie : pair.ties)
            problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<TieResidual, 2, 8, 8>(
                                          new TieResidual{a(tie.first), b(tie.second), tie.sigma_px}),
                                      new ceres::CauchyLoss(kRobust), values_[pair.first].data(),
                                      values_[pair.second].data());
    }
    void hold(std::size_t i) {
        const double size = std::hypot(values_[i][0], values_[i][3]);
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<StandResidual, 4, 8>(new StandResidual{size}), nullptr,
            values_[i].data());
    }

    // Of a point of each picture, rms over nine of them.
    void find_errors() {
        ceres::Covariance::Options options;
        options.algorithm_type = ceres::DENSE_SVD;
        options.null_space_rank = -1;
        ceres::Covariance covariance(options);
        std::vector<std::pair<const double*, const double*>> blocks;
        for (std::size_t i = 0; i < values_.size(); ++i)
            if (layout_.positions[i].joined && i != layout_.anchor)
                blocks.emplace_back(values_[i].data(), values_[i].data());
        if (blocks.empty() || !covariance.Compute(blocks, &problem_)) return;
        for (std::size_t i = 0; i < values_.size(); ++i) {
            if (!layout_.positions[i].joined || i == layout_.anchor) continue;
            std::array<double, 64> c{};
            covariance.GetCovarianceBlock(values_[i].data(), values_[i].data(), c.data());
            layout_.positions[i].sigma_px = point_error(values_[i], c);
        }
    }
    static double point_error(const Parameters& p, const std::array<double, 64>& covariance) {
        double sum = 0;
        for (const double y : {-0.7, 0.0, 0.7})
            for (const double x : {-0.7, 0.0, 0.7}) {
                ceres::Jet<double, 8> jets[8], wall[2];
                for (int k = 0; k < 8; ++k)
                    jets[k] = ceres::Jet<double, 8>(p[static_cast<std::size_t>(k)], k);
                apply(jets, dvec2(x, y), wall);
                const Eigen::Map<const Eigen::Matrix<double, 8, 8, Eigen::RowMajor>> c(covariance.data());
                for (const auto& w : wall) sum += w.v.dot(c * w.v);
            }
        return std::sqrt(sum / 9);
    }

    MosaicLayout& layout_;
    std::vector<Normalisation> normalisations_;
    std::vector<Parameters> values_;
    ceres::Problem problem_;
};

// Moves the wall by whole pixels, so that it begins at (0, 0) and the anchor's pixels stay pixels.
void bound_wall(const std::vector<MosaicPosition>& positions, MosaicLayout& layout) {
    dvec2 low(std::numeric_limits<double>::max()), high(-low);
    double area = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!layout.positions[i].joined) continue;
        const double right = positions[i].width - 1, bottom = positions[i].height - 1;
        dvec2 own_low(std::numeric_limits<double>::max()), own_high(-own_low);
        for (const dvec2& corner : {dvec2(0), dvec2(right, 0), dvec2(right, bottom), dvec2(0, bottom)}) {
            const dvec2 p = mapped(layout.positions[i].to_wall, corner);
            own_low = glm::min(own_low, p), own_high = glm::max(own_high, p);
        }
        low = glm::min(low, own_low), high = glm::max(high, own_high);
        area += (own_high.x - own_low.x) * (own_high.y - own_low.y);
    }
    low = glm::floor(low + 1e-6), high = glm::ceil(high - 1e-6) + 1.0;
    const double bounds = (high.x - low.x) * (high.y - low.y);
    if (!(bounds > 0 && bounds < std::min(kMostWallPixels, kMostStretch * area + 1e6)))
        fail(
            "the overlaps of the positions contradict each other: the wall would have {:.0f} x {:.0f} "
            "pixels; give the layout with --layout, or leave out the positions that are out of place",
            high.x - low.x, high.y - low.y);
    layout.width = static_cast<int>(high.x - low.x), layout.height = static_cast<int>(high.y - low.y);
    const Homography moved(1, 0, 0, 0, 1, 0, -low.x, -low.y, 1);
    for (PlacedPosition& p : layout.positions) p.to_wall = normalised(moved * p.to_wall);
}

void measure_pairs(const std::vector<PairRegistration>& pairs, MosaicLayout& layout) {
    double all = 0, count = 0;
    for (const PairRegistration& pair : pairs) {
        const PlacedPosition &a = layout.positions[pair.first], &b = layout.positions[pair.second];
        if (!pair.joined() || !a.joined || !b.joined) continue;
        double sum = 0;
        for (const TiePoint& tie : pair.ties) {
            const dvec2 off = mapped(a.to_wall, tie.first) - mapped(b.to_wall, tie.second);
            sum += glm::dot(off, off);
        }
        const auto ties = static_cast<double>(pair.ties.size());
        layout.pairs.push_back({pair.first, pair.second, pair.ties.size(), std::sqrt(sum / ties)});
        all += sum, count += ties;
    }
    layout.rms_px = count > 0 ? std::sqrt(all / count) : 0;
}

// A picture's Jacobian in its middle is a similarity, but for what a tilt adds in second order.
void find_pixel(const MosaicPosition& position, PlacedPosition& placed) {
    const dvec2 middle = dvec2(position.width - 1, position.height - 1) / 2.0;
    const auto along = [&](const dvec2& step) {
        return mapped(placed.to_wall, middle + step / 2.0) - mapped(placed.to_wall, middle - step / 2.0);
    };
    const dvec2 right = along({1, 0}), down = along({0, 1});
    placed.pixel = std::sqrt(std::abs(cross(right, down)));
    placed.turn_rad = std::atan2(down.x - right.y, right.x + down.y);
}

}  // namespace

glm::dmat3 PlacedPosition::turn() const {
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    return {c, s, 0, -s, c, 0, 0, 0, 1};
}

MosaicLayout solve_layout(const std::vector<MosaicPosition>& positions,
                          const std::vector<PairRegistration>& pairs, std::size_t anchor) {
    TP_REQUIRE(anchor < positions.size(), "the anchor is one of the positions");
    MosaicLayout layout;
    layout.anchor = anchor;
    layout.positions.resize(positions.size());
    place_first(pairs, layout);
    LayoutProblem(positions, pairs, layout).solve();
    bound_wall(positions, layout);
    measure_pairs(pairs, layout);
    for (std::size_t i = 0; i < positions.size(); ++i) find_pixel(positions[i], layout.positions[i]);
    return layout;
}

}  // namespace tangi
