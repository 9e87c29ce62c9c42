// mosaic_cells.h: positions in small, in cells of the wall: what is compared where they overlap, and what
// seams are sought in.
#pragma once

#include <vector>

#include "fit/mosaic/mosaic_layout.h"
#include "surface/base/progress.h"

namespace tangi {

// Cells of size x size pixels of the wall; cell (0, 0) begins at pixel (0, 0).
struct CellGrid {
    int size = 16, columns = 0, rows = 0;
    CellGrid(int cell_size, int width, int height)
        : size(cell_size),
          columns((width + cell_size - 1) / cell_size),
          rows((height + cell_size - 1) / cell_size) {}
    // [cells] of a pixel of the wall; whole numbers are the middles of cells.
    glm::dvec2 cell_of(const glm::dvec2& pixel) const { return (pixel + 0.5) / double(size) - 0.5; }
};

// By the smallest side of a position: some 48 cells along it, of 4 to 32 pixels.
CellGrid grid_of(const std::vector<MosaicPosition>& positions, const MosaicLayout& layout);

// Means of the measured pixels whose middles lie in a cell, in the position's own frame and scale.
struct CellMaps {
    Region cells;            // of the grid
    Image<float> cover;      // [1] part of the cell that was measured, up to 1
    Image<Rgb> diffuse;      // [1] rho_d
    Image<glm::vec2> slope;  // [1]
    Image<float> specular;   // [1] rho_s
    Image<float> ln_alpha;   // [1] weighted by rho_s
    Image<float> height;     // [pixels of the wall]
    Image<float> distance;   // [1] of the cell from the rim of the picture, in half sides; 0 outside

    bool has(int column, int row) const {
        return column >= cells.x0 && row >= cells.y0 && column < cells.x1 && row < cells.y1;
    }
    // Whether it was photographed as good as whole.
    bool covers(int column, int row) const {
        return has(column, row) && cover(column - cells.x0, row - cells.y0) > kCovered;
    }
    static constexpr float kCovered = 0.9f;
};

// Of a cell that the maps have.
template <class T>
const T& value_at(const Image<T>& map, const CellMaps& maps, const glm::ivec2& cell) {
    return map(cell.x - maps.cells.x0, cell.y - maps.cells.y0);
}

// Reads the position band by band.
CellMaps cells_of(const MosaicPosition& position, const PlacedPosition& placed, const CellGrid& grid,
                  const Progress& progress = {});

}  // namespace tangi
