#include "fit/mosaic/mosaic_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

namespace tangi {

namespace {

using glm::dvec2;

constexpr int kCellsAlong = 48;
constexpr int kSmallestCell = 4, kLargestCell = 32;  // [pixels]
constexpr float kLeastSpecular = 1e-6f;              // [1] of the weight of alpha, where nothing is specular

Region bounds_of(const MosaicPosition& position, const Homography& to_wall, const CellGrid& grid) {
    dvec2 low(1e30), high(-1e30);
    const double right = position.width - 1, bottom = position.height - 1;
    for (const dvec2& corner : {dvec2(0), dvec2(right, 0), dvec2(right, bottom), dvec2(0, bottom)}) {
        const dvec2 cell = grid.cell_of(mapped(to_wall, corner));
        low = glm::min(low, cell), high = glm::max(high, cell);
    }
    const auto within = [](double value, int most) { return std::clamp(static_cast<int>(value), 0, most); };
    return {within(std::floor(low.x), grid.columns), within(std::floor(low.y), grid.rows),
            within(std::ceil(high.x) + 1, grid.columns), within(std::ceil(high.y) + 1, grid.rows)};
}

// Sums become means.
void divide(CellMaps& maps, const Image<float>& gloss, double pixels_in_cell) {
    for (std::size_t i = 0; i < maps.cover.size(); ++i) {
        float& count = maps.cover.pixels()[i];
        if (!(count > 0)) continue;
        maps.diffuse.pixels()[i] /= count, maps.slope.pixels()[i] /= count;
        maps.specular.pixels()[i] /= count, maps.height.pixels()[i] /= count;
        maps.ln_alpha.pixels()[i] /= gloss.pixels()[i];
        count = std::min(static_cast<float>(count / pixels_in_cell), 1.0f);
    }
}

void find_distances(const MosaicPosition& position, const Homography& to_wall, const CellGrid& grid,
                    CellMaps& maps) {
    const Homography from_wall = glm::inverse(to_wall);
    const dvec2 half = dvec2(position.width, position.height) / 2.0;
    for (int y = 0; y < maps.distance.height(); ++y)
        for (int x = 0; x < maps.distance.width(); ++x) {
            const dvec2 middle =
                (dvec2(maps.cells.x0 + x, maps.cells.y0 + y) + 0.5) * double(grid.size) - 0.5;
            const dvec2 inside = 1.0 - glm::abs((mapped(from_wall, middle) + 0.5) / half - 1.0);
            maps.distance(x, y) = static_cast<float>(std::max(std::min(inside.x, inside.y), 0.0));
        }
}

}  // namespace

CellGrid grid_of(const std::vector<MosaicPosition>& positions, const MosaicLayout& layout) {
    double smallest = std::max(layout.width, layout.height);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const PlacedPosition& placed = layout.positions[i];
        if (!placed.joined) continue;
        smallest = std::min(smallest, placed.pixel * std::min(positions[i].width, positions[i].height));
    }
    const int size = std::clamp(static_cast<int>(smallest / kCellsAlong), kSmallestCell, kLargestCell);
    return {size, layout.width, layout.height};
}

CellMaps cells_of(const MosaicPosition& position, const PlacedPosition& placed, const CellGrid& grid,
                  const Progress& progress) {
    CellMaps maps;
    maps.cells = bounds_of(position, placed.to_wall, grid);
    const int columns = maps.cells.width(), rows = maps.cells.height();
    maps.cover = maps.specular = maps.ln_alpha = maps.height = maps.distance = Image<float>(columns, rows);
    maps.diffuse = Image<Rgb>(columns, rows);
    maps.slope = Image<glm::vec2>(columns, rows);
    Image<float> gloss(columns, rows);
    const float per_height = static_cast<float>(1 / position.mm_per_pixel);
    const int band = std::max(kBandPixels / position.width, 1);
    for (int y0 = 0; y0 < position.height; y0 += band) {
        const int end = std::min(y0 + band, position.height);
        const Surface s = position.read({0, y0, position.width, end}).surface;
        for (int y = y0; y < end; ++y)
            for (int x = 0; x < position.width; ++x) {
                if (!(s.confidence(x, y - y0) > 0)) continue;
                const dvec2 cell = glm::floor(grid.cell_of(mapped(placed.to_wall, dvec2(x, y))) + 0.5);
                const int u = static_cast<int>(cell.x) - maps.cells.x0,
                          v = static_cast<int>(cell.y) - maps.cells.y0;
                if (u < 0 || v < 0 || u >= columns || v >= rows) continue;
                const Slope slope = slope_of(s.normal(x, y - y0));
                const float weight = s.specular(x, y - y0) + kLeastSpecular;
                ++maps.cover(u, v);
                maps.diffuse(u, v) += s.diffuse(x, y - y0);
                maps.slope(u, v) += glm::vec2(slope.x, slope.y);
                maps.specular(u, v) += s.specular(x, y - y0);
                maps.ln_alpha(u, v) += weight * std::log(s.roughness(x, y - y0));
                maps.height(u, v) += per_height * s.height_mm(x, y - y0);
                gloss(u, v) += weight;
            }
        report(progress, position.name, end / static_cast<double>(position.height));
    }
    const double area = placed.pixel * placed.pixel;
    divide(maps, gloss, grid.size * grid.size / area);
    for (float& z : maps.height.pixels()) z *= static_cast<float>(placed.pixel);
    find_distances(position, placed.to_wall, grid, maps);
    return maps;
}

}  // namespace tangi
