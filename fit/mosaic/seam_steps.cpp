#include "fit/mosaic/seam_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "surface/image/colour.h"

namespace tangi {

namespace {

using Cell = glm::ivec2;

constexpr int kPiece = 8;          // [cells] a side
constexpr double kLeastPairs = 4;  // of cells, in a piece

// Sums over a piece of a seam, from the first position to the second.
struct PieceSum {
    double height = 0, error2 = 0, count = 0;
    glm::dvec3 wall{0}, expected{0};  // rho_d behind the seam
};

// [pixels of the wall] Height of `to` above `from` as a position has it, its camera's tilt taken out.
double rise(const CellMaps& maps, const PositionScale& scale, const CellGrid& grid, const Cell& from,
            const Cell& to) {
    const glm::dvec2 level = slope_on_wall(scale, {0, 0});  // of what the position takes for level
    const glm::dvec2 way(to.x - from.x, from.y - to.y);     // y up
    const double own =
        static_cast<double>(value_at(maps.height, maps, to) - value_at(maps.height, maps, from));
    return own + grid.size * glm::dot(level, way);
}

// rho_d that the wall would have at `to` if it changed from `from` as the position does.
glm::dvec3 expected_at(const CellMaps& maps, const CellMaps& wall, const Cell& from, const Cell& to) {
    const Rgb least(1e-4f);
    const Rgb change =
        (value_at(maps.diffuse, maps, to) + least) / (value_at(maps.diffuse, maps, from) + least);
    return glm::dvec3(glm::max(change * (value_at(wall.diffuse, wall, from) + least) - least, Rgb(0)));
}

using Pieces = std::map<std::array<int, 4>, PieceSum>;  // by both positions and place

// Of two cells beside each other, from the first position to the second.
class StepCollector {
public:
    StepCollector(const std::vector<CellMaps>& maps, const MosaicScales& scales, const CellGrid& grid,
                  const Image<int>& owner, const CellMaps& wall, const Image<float>& height_error)
        : maps_(maps), scales_(scales), grid_(grid), owner_(owner), wall_(wall), error_(height_error) {}

    void take(Cell from, Cell to) {
        if (owner_(from.x, from.y) > owner_(to.x, to.y)) std::swap(from, to);
        const int a = owner_(from.x, from.y), b = owner_(to.x, to.y);
        if (a < 0 || a == b || !wall_.covers(from.x, from.y) || !wall_.covers(to.x, to.y)) return;
        double rises = 0;
        glm::dvec3 expected(0);
        for (const int i : {a, b}) {
            const CellMaps& own = maps_[static_cast<std::size_t>(i)];
            if (!own.covers(from.x, from.y) || !own.covers(to.x, to.y)) return;
            rises += rise(own, scales_.positions[static_cast<std::size_t>(i)], grid_, from, to) / 2;
            expected += expected_at(own, wall_, from, to) / 2.0;
        }
        const auto squared = [](float value) {
            return static_cast<double>(value) * static_cast<double>(value);
        };
        PieceSum& piece = pieces_[{a, b, from.x / kPiece, from.y / kPiece}];
        piece.height +=
            static_cast<double>(value_at(wall_.height, wall_, to) - value_at(wall_.height, wall_, from)) -
            rises;
        piece.error2 += (squared(error_(from.x, from.y)) + squared(error_(to.x, to.y))) / 2;
        piece.wall += glm::dvec3(value_at(wall_.diffuse, wall_, to)), piece.expected += expected;
        ++piece.count;
    }
    const Pieces& pieces() const { return pieces_; }

private:
    const std::vector<CellMaps>& maps_;
    const MosaicScales& scales_;
    const CellGrid& grid_;
    const Image<int>& owner_;
    const CellMaps& wall_;
    const Image<float>& error_;
    Pieces pieces_;
};

}  // namespace

std::vector<SeamSteps> seam_steps(const std::vector<CellMaps>& maps, const MosaicScales& scales,
                                  const CellGrid& grid, const Image<int>& owner, const CellMaps& wall,
                                  const Image<float>& height_error) {
    StepCollector collector(maps, scales, grid, owner, wall, height_error);
    for (int y = 0; y < owner.height(); ++y)
        for (int x = 0; x < owner.width(); ++x) {
            if (x + 1 < owner.width()) collector.take({x, y}, {x + 1, y});
            if (y + 1 < owner.height()) collector.take({x, y}, {x, y + 1});
        }
    std::vector<SeamSteps> steps;
    for (const auto& [key, piece] : collector.pieces()) {  // in the order of positions
        if (piece.count < kLeastPairs) continue;
        const auto a = static_cast<std::size_t>(key[0]), b = static_cast<std::size_t>(key[1]);
        if (steps.empty() || steps.back().first != a || steps.back().second != b) steps.push_back({a, b});
        SeamSteps& seam = steps.back();
        const double height = piece.height / piece.count;
        seam.height_rms += height * height, seam.height_error += piece.error2 / piece.count, ++seam.pieces;
        seam.delta_e_2000 += delta_e_2000(lab_from_linear(piece.wall / piece.count),
                                          lab_from_linear(piece.expected / piece.count));
    }
    for (SeamSteps& seam : steps) {
        const auto pieces = static_cast<double>(seam.pieces);
        seam.height_rms = std::sqrt(seam.height_rms / pieces);
        seam.height_error = std::sqrt(seam.height_error / pieces);
        seam.delta_e_2000 /= pieces;
    }
    return steps;
}

}  // namespace tangi
