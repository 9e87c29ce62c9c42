// height_grid.h: the multigrid that height.cpp and height_error.cpp solve their equations with.
//
// A z = b with A the graph Laplacian of weights of edges between horizontal and vertical neighbours; nothing
// is said at the borders of the picture (natural boundary; Horn & Brooks 1986). Cell-centred coarsening by
// two, red-black Gauss-Seidel smoothing (Briggs, Henson, McCormick 2000, ch. 3 and 6), coarse steps as long
// as lowers the energy most. The result does not depend on the number of threads.
#pragma once

#include <algorithm>
#include <vector>

#include "fit/height/height_rows.h"
#include "fit/pixel/fit_errors.h"
#include "surface/image/image.h"

namespace tangi {

// One grid of the hierarchy.
struct HeightGrid {
    int width = 0, height = 0;
    const Image<HalfError>*half_right = nullptr, *half_down = nullptr;  // weights of the finest grid
    Image<float> own_z;
    Image<float>* z = nullptr;
    Image<float> b;
    Image<float> step;   // correction from the next coarser grid
    Image<float> right;  // weight of the edge (x, y) - (x + 1, y), of coarser grids; 0 in the last column
    Image<float> down;   // weight of the edge (x, y) - (x, y + 1); 0 in the last row

    HeightGrid(int w, int h) : width(w), height(h), b(w, h), step(w, h) {}

    float weight_right(int x, int y) const {
        if (x < 0 || x + 1 >= width) return 0;
        return half_right ? float((*half_right)(x, y)) : right(x, y);
    }
    float weight_down(int x, int y) const {
        if (y < 0 || y + 1 >= height) return 0;
        return half_down ? float((*half_down)(x, y)) : down(x, y);
    }

    // Calls use(row of u with its weights), as floats or as their halves.
    template <class Use>
    void with_row(const Image<float>& u, int y, const Use& use) const {
        if (half_right)
            use(height_row(u, y, *half_right, *half_down));
        else
            use(height_row(u, y, right, down));
    }
};

// Memory beside the weights and z: 15 bytes a pixel.
class HeightMultigrid {
public:
    // Keeps references: to the weights of the edges to the right (0 in the last column) and downwards (0 in
    // the last row), in halves of a float so that both fit in the place of one map, and to the unknown.
    HeightMultigrid(const Image<HalfError>& right, const Image<HalfError>& down, Image<float>& z);

    Image<float>& b() { return grids_[0].b; }

    // To be called whenever weights have changed.
    void coarsen();
    // Nested iteration: the solution of each coarser grid starts the next finer one; z is overwritten.
    void start();
    void cycle();

    // [mm] `residual`: of the residual, each divided by its pixel's weights: by how much a pixel differs from
    // what its neighbours ask of it; undivided, pixels of low weight would not count. `rounding`: what is
    // left of it when every z is rounded to a float.
    struct Norms {
        double residual, rounding;
    };
    Norms norms() const;
    double flat() const;  // [mm] the residual of z = 0

private:
    std::vector<HeightGrid> grids_;  // from the finest
};

void remove_mean(Image<float>& z);

}  // namespace tangi
