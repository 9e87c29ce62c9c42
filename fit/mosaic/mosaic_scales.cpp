#include "fit/mosaic/mosaic_scales.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "surface/base/median.h"
#include "surface/image/colour.h"

namespace tangi {

namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr std::size_t kLeastCells = 6;      // of a pair that says anything
constexpr int kTiltRounds = 4;              // rotations are not quite sums of slopes
constexpr float kLeastReflectance = 1e-3f;  // [1] whose ratios say something
constexpr double kDegree = std::numbers::pi / 180;

// Two positions and the cells that both cover.
struct SharedCells {
    std::size_t first, second;
    std::vector<glm::ivec2> cells;
};

std::vector<SharedCells> shared_cells(const MosaicLayout& layout, const std::vector<CellMaps>& maps) {
    std::vector<SharedCells> all;
    for (std::size_t j = 0; j < maps.size(); ++j)
        for (std::size_t i = 0; i < j; ++i) {
            if (!layout.positions[i].joined || !layout.positions[j].joined) continue;
            SharedCells shared{i, j, {}};
            const Region &a = maps[i].cells, &b = maps[j].cells;
            for (int y = std::max(a.y0, b.y0); y < std::min(a.y1, b.y1); ++y)
                for (int x = std::max(a.x0, b.x0); x < std::min(a.x1, b.x1); ++x)
                    if (maps[i].covers(x, y) && maps[j].covers(x, y)) shared.cells.emplace_back(x, y);
            if (shared.cells.size() >= kLeastCells) all.push_back(std::move(shared));
        }
    return all;
}

// What is to be added to each position so that the differences of pairs, first less second, vanish: least
// squares, their sum being 0. Positions that no pair is about get 0.
struct Difference {
    std::size_t first, second;
    double value, weight;
};
std::vector<double> levelled(std::size_t count, const std::vector<Difference>& differences) {
    const auto n = static_cast<Eigen::Index>(count);
    // A weak condition on each fixes the sum, and those of no pair.
    Eigen::MatrixXd normal = 1e-6 * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (const Difference& d : differences) {
        const auto i = static_cast<Eigen::Index>(d.first), j = static_cast<Eigen::Index>(d.second);
        normal(i, i) += d.weight, normal(j, j) += d.weight;
        normal(i, j) -= d.weight, normal(j, i) -= d.weight;
        right(i) -= d.weight * d.value, right(j) += d.weight * d.value;
    }
    const Eigen::VectorXd x = normal.ldlt().solve(right);
    return {x.data(), x.data() + n};
}

// Of pairs with anything to say: the median of what `of` makes of each cell they share.
using OfCell = std::function<std::optional<double>(const SharedCells&, const glm::ivec2&)>;
std::vector<Difference> medians(const std::vector<SharedCells>& shared, const OfCell& of) {
    std::vector<Difference> result;
    for (const SharedCells& pair : shared) {
        std::vector<double> values;
        for (const glm::ivec2& cell : pair.cells)
            if (const auto value = of(pair, cell)) values.push_back(*value);
        if (values.size() < kLeastCells) continue;
        const auto weight = static_cast<double>(values.size());
        result.push_back({pair.first, pair.second, median(std::move(values)), weight});
    }
    return result;
}

std::optional<double> log_ratio(float a, float b) {
    if (!(a > kLeastReflectance && b > kLeastReflectance)) return std::nullopt;
    return std::log(static_cast<double>(a) / b);
}

// The smallest rotation that takes z to the normal of a plane of this slope.
dmat3 rotation_to(const dvec2& slope) {
    const double length = glm::length(slope);
    if (!(length > 0)) return dmat3(1);
    const double angle = std::atan(length);
    const dvec3 axis(slope.y / length, -slope.x / length, 0);  // z x normal, normal = (-slope, 1)
    const double c = std::cos(angle), s = std::sin(angle);
    const dmat3 cross_axis(0, axis.z, -axis.y, -axis.z, 0, axis.x, axis.y, -axis.x, 0);
    return c * dmat3(1) + s * cross_axis + (1 - c) * glm::outerProduct(axis, axis);
}

class ScaleSolver {
public:
    ScaleSolver(const MosaicLayout& layout, const std::vector<CellMaps>& maps)
        : maps_(maps), shared_(shared_cells(layout, maps)) {
        result_.positions.resize(maps.size());
        for (std::size_t i = 0; i < maps.size(); ++i) result_.positions[i].frame = layout.positions[i].turn();
    }

    MosaicScales solve() {
        solve_reflectance();
        const std::vector<double> before = tilts_between();
        for (int round = 0; round < kTiltRounds; ++round) solve_tilts();
        level_wall();
        measure(before);
        return std::move(result_);
    }

private:
    template <class Map>
    std::vector<double> factors(const Map& map) const {
        return levelled(maps_.size(), medians(shared_, [&](const SharedCells& pair, const glm::ivec2& cell) {
                            return log_ratio(map(pair.first, cell), map(pair.second, cell));
                        }));
    }

    void solve_reflectance() {
        for (int c = 0; c < 3; ++c) {
            const auto ln = factors([&](std::size_t i, const glm::ivec2& cell) {
                return value_at(maps_[i].diffuse, maps_[i], cell)[c];
            });
            for (std::size_t i = 0; i < ln.size(); ++i)
                result_.positions[i].diffuse[c] = static_cast<float>(std::exp(ln[i]));
        }
        const auto specular = factors([&](std::size_t i, const glm::ivec2& cell) {
            return value_at(maps_[i].specular, maps_[i], cell);
        });
        const auto roughness = factors([&](std::size_t i, const glm::ivec2& cell) {
            return std::exp(value_at(maps_[i].ln_alpha, maps_[i], cell));
        });
        for (std::size_t i = 0; i < maps_.size(); ++i) {
            result_.positions[i].specular = static_cast<float>(std::exp(specular[i]));
            result_.positions[i].roughness = static_cast<float>(std::exp(roughness[i]));
        }
    }

    dvec2 slope_at(std::size_t i, const glm::ivec2& cell) const {
        return slope_on_wall(result_.positions[i], value_at(maps_[i].slope, maps_[i], cell));
    }

    std::vector<Difference> slope_differences(int axis) const {
        return medians(shared_, [&](const SharedCells& pair, const glm::ivec2& cell) {
            return slope_at(pair.first, cell)[axis] - slope_at(pair.second, cell)[axis];
        });
    }

    // [deg] of each pair that is shared.
    std::vector<double> tilts_between() const {
        const auto x = slope_differences(0), y = slope_differences(1);
        std::vector<double> tilts;
        for (std::size_t k = 0; k < x.size(); ++k)
            tilts.push_back(std::atan(std::hypot(x[k].value, y[k].value)) / kDegree);
        return tilts;
    }

    void solve_tilts() {
        const auto x = levelled(maps_.size(), slope_differences(0)),
                   y = levelled(maps_.size(), slope_differences(1));
        for (std::size_t i = 0; i < maps_.size(); ++i)
            result_.positions[i].frame = rotation_to({x[i], y[i]}) * result_.positions[i].frame;
    }

    // Turns all so that the mean slope of the wall is 0; where positions overlap, they share a cell's weight.
    void level_wall() {
        for (int round = 0; round < kTiltRounds; ++round) {
            dvec3 sum(0);
            for (std::size_t i = 0; i < maps_.size(); ++i)
                for (int y = maps_[i].cells.y0; y < maps_[i].cells.y1; ++y)
                    for (int x = maps_[i].cells.x0; x < maps_[i].cells.x1; ++x)
                        if (maps_[i].covers(x, y))
                            sum += static_cast<double>(value_at(maps_[i].distance, maps_[i], {x, y})) *
                                   dvec3(slope_at(i, {x, y}), 1) / distance_of_all(x, y);
            if (!(sum.z > 0)) return;
            for (PositionScale& p : result_.positions) p.frame = rotation_to(-dvec2(sum) / sum.z) * p.frame;
        }
        for (PositionScale& p : result_.positions)
            p.tilt_deg = std::acos(std::clamp(p.frame[2].z, -1.0, 1.0)) / kDegree;
    }
    double distance_of_all(int x, int y) const {
        double sum = 0;
        for (const CellMaps& maps : maps_)
            if (maps.covers(x, y)) sum += static_cast<double>(value_at(maps.distance, maps, {x, y}));
        return std::max(sum, 1e-9);
    }

    void measure(const std::vector<double>& tilts_before) {
        for (std::size_t k = 0; k < shared_.size(); ++k) {
            const SharedCells& pair = shared_[k];
            PairDifference d{pair.first, pair.second, pair.cells.size(), 0, 0, tilts_before[k], 0};
            std::vector<double> colours;
            double squares = 0;
            for (const glm::ivec2& cell : pair.cells) {
                const auto lab = [&](std::size_t i) {
                    return lab_from_linear(glm::dvec3(value_at(maps_[i].diffuse, maps_[i], cell) *
                                                      result_.positions[i].diffuse));
                };
                colours.push_back(delta_e_2000(lab(pair.first), lab(pair.second)));
                const dvec2 off = slope_at(pair.first, cell) - slope_at(pair.second, cell);
                squares += glm::dot(off, off) / 2;
                d.delta_e_2000 += colours.back() / static_cast<double>(pair.cells.size());
            }
            std::ranges::sort(colours);
            d.delta_e_2000_p95 = colours[colours.size() * 95 / 100];
            d.slope_rms = std::sqrt(squares / static_cast<double>(pair.cells.size()));
            result_.pairs.push_back(d);
        }
    }

    const std::vector<CellMaps>& maps_;
    std::vector<SharedCells> shared_;
    MosaicScales result_;
};

}  // namespace

dvec2 slope_on_wall(const PositionScale& scale, const glm::vec2& slope) {
    const dvec3 n = scale.frame * dvec3(-dvec2(slope), 1);
    return -dvec2(n) / n.z;
}

MosaicScales solve_scales(const MosaicLayout& layout, const std::vector<CellMaps>& maps) {
    return ScaleSolver(layout, maps).solve();
}

}  // namespace tangi
