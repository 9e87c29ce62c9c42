// patch_grid.cpp: growth of grids from cell to cell.
#include "capture/colour_chart/patch_grid.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "capture/colour_chart/chart_order.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr int kReach = 6;            // cells from the first, each way
constexpr double kStray = 0.25;      // [pitch] from where the next cell is expected
constexpr double kGridStray = 0.15;  // [pitch] from where the whole grid expects it
constexpr std::size_t kNeighbours = 8;
constexpr std::size_t kMostPatches = 600;

using Place = std::pair<int, int>;

struct Node {
    std::size_t patch;
    dvec2 e1, e2;  // [px] to the next cell along u and v
};

using Nodes = std::map<Place, Node>;

bool alike(double a, double b) { return a < 1.7 * b && b < 1.7 * a; }

// Patches of about the same size around one, the nearest first, at most as far as a diagonal neighbour.
std::vector<std::size_t> neighbours_of(const std::vector<FlatPatch>& patches, std::size_t seed) {
    std::vector<std::pair<double, std::size_t>> near;
    const FlatPatch& from = patches[seed];
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const double distance = glm::length(patches[i].centre_px - from.centre_px);
        if (i != seed && alike(patches[i].width_px, from.width_px) && distance > 0.9 * from.width_px &&
            distance < 2.6 * from.width_px + 4)
            near.emplace_back(distance, i);
    }
    std::sort(near.begin(), near.end());
    if (near.size() > kNeighbours) near.resize(kNeighbours);
    std::vector<std::size_t> result;
    for (const auto& [distance, i] : near) result.push_back(i);
    return result;
}

Nodes grown(const std::vector<FlatPatch>& patches, std::size_t seed, const dvec2& e1, const dvec2& e2) {
    Nodes nodes = {{{0, 0}, {seed, e1, e2}}};
    std::set<std::size_t> used = {seed};
    std::queue<Place> open({{0, 0}});
    while (!open.empty()) {
        const Place at = open.front();
        open.pop();
        const Node node = nodes.at(at);
        for (const Place& step : {Place(1, 0), Place(-1, 0), Place(0, 1), Place(0, -1)}) {
            const Place next(at.first + step.first, at.second + step.second);
            if (nodes.contains(next) || std::abs(next.first) > kReach || std::abs(next.second) > kReach)
                continue;
            const bool along_u = step.first != 0;
            const double sign = step.first + step.second;
            const dvec2 edge = sign * (along_u ? node.e1 : node.e2);
            const dvec2 expected = patches[node.patch].centre_px + edge;
            double nearest = kStray * std::min(glm::length(node.e1), glm::length(node.e2));
            std::optional<std::size_t> best;
            for (std::size_t i = 0; i < patches.size(); ++i) {
                const double distance = glm::length(patches[i].centre_px - expected);
                if (distance < nearest && alike(patches[i].width_px, patches[node.patch].width_px) &&
                    !used.contains(i))
                    nearest = distance, best = i;
            }
            if (!best) continue;
            Node grownup{*best, node.e1, node.e2};
            const dvec2 seen = sign * (patches[*best].centre_px - patches[node.patch].centre_px);
            (along_u ? grownup.e1 : grownup.e2) = 0.5 * (seen + (along_u ? node.e1 : node.e2));
            nodes.emplace(next, grownup);
            used.insert(*best);
            open.push(next);
        }
    }
    return nodes;
}

// All patches that lie on the grid through the cells, also beyond gaps; nothing where the cells make no grid.
std::optional<PatchGrid> completed(const std::vector<FlatPatch>& patches, const Nodes& nodes) {
    PatchGrid grid;
    double width = 0;
    for (const auto& [place, node] : nodes) {
        grid.cells.push_back({place.first, place.second, patches[node.patch].centre_px});
        width += patches[node.patch].width_px / static_cast<double>(nodes.size());
    }
    for (int round = 0; round < 3; ++round) {
        std::vector<dvec2> from, to;
        for (const PatchGrid::Cell& cell : grid.cells) {
            from.emplace_back(cell.u, cell.v);
            to.push_back(cell.centre_px);
        }
        const std::optional<Homography> h = homography_through(from, to);
        if (!h) return std::nullopt;
        grid.grid_to_picture = *h;
        const Homography inverse = glm::inverse(*h);
        grid.cells.clear();
        std::map<Place, std::pair<double, dvec2>> best;
        for (const FlatPatch& patch : patches) {
            const dvec2 place = mapped(inverse, patch.centre_px);
            if (!(std::abs(place.x) < 2 * kReach && std::abs(place.y) < 2 * kReach)) continue;
            const Place cell(static_cast<int>(std::lround(place.x)), static_cast<int>(std::lround(place.y)));
            const double stray = glm::length(place - dvec2(cell.first, cell.second));
            if (stray > kGridStray || !alike(patch.width_px, width)) continue;
            const auto [slot, is_new] = best.try_emplace(cell, stray, patch.centre_px);
            if (!is_new && stray < slot->second.first) slot->second = {stray, patch.centre_px};
        }
        for (const auto& [place, found] : best)
            grid.cells.push_back({place.first, place.second, found.second});
        if (grid.cells.size() < 6) return std::nullopt;
    }
    return grid;
}

}  // namespace

std::vector<PatchGrid> patch_grids(const std::vector<FlatPatch>& all, int least) {
    // The largest: a chart is hardly ever the smallest thing in a picture.
    std::vector<FlatPatch> patches = all;
    std::sort(patches.begin(), patches.end(),
              [](const auto& a, const auto& b) { return a.width_px > b.width_px; });
    if (patches.size() > kMostPatches) patches.resize(kMostPatches);
    std::vector<PatchGrid> grids;
    std::vector<bool> taken(patches.size(), false);
    for (std::size_t seed = 0; seed < patches.size(); ++seed) {
        if (taken[seed]) continue;
        std::optional<PatchGrid> best;
        double best_edges = 0;
        const std::vector<std::size_t> near = neighbours_of(patches, seed);
        for (std::size_t j = 0; j < near.size(); ++j)
            for (std::size_t k = 0; k < j; ++k) {
                dvec2 e1 = patches[near[j]].centre_px - patches[seed].centre_px;
                dvec2 e2 = patches[near[k]].centre_px - patches[seed].centre_px;
                const double sine = std::abs(cross(e1, e2)) / (glm::length(e1) * glm::length(e2));
                if (sine < 0.78 || !alike(glm::length(e1), glm::length(e2))) continue;
                // The same grid could go eight ways: e1 goes right, and e2 clockwise from it.
                if (std::abs(e1.x) * glm::length(e2) < std::abs(e2.x) * glm::length(e1)) std::swap(e1, e2);
                if (e1.x < 0) e1 = -e1;
                if (cross(e1, e2) < 0) e2 = -e2;
                const Nodes nodes = grown(patches, seed, e1, e2);
                if (nodes.size() < 6) continue;
                std::optional<PatchGrid> grid = completed(patches, nodes);
                if (!grid || grid->cells.size() < static_cast<std::size_t>(least)) continue;
                // Of grids that hold about the same patches, the one with the shortest edges is not sheared.
                const double edges = glm::length(e1) + glm::length(e2);
                const std::size_t cells = grid->cells.size(), before = best ? best->cells.size() : 0;
                if (cells > before + 1 || (cells + 1 >= before && edges < best_edges)) {
                    best = std::move(grid);
                    best_edges = edges;
                }
            }
        if (!best) continue;
        for (const PatchGrid::Cell& cell : best->cells)
            for (std::size_t i = 0; i < patches.size(); ++i)
                if (patches[i].centre_px == cell.centre_px) taken[i] = true;
        grids.push_back(std::move(*best));
    }
    return grids;
}

}  // namespace tangi
