#include "fit/height.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

// One grid of the hierarchy: A z = b with A the graph Laplacian of the edge weights. The finest grid's
// unknown is the caller's height map, and its weights come from the confidence as they are needed, which
// saves memory.
struct Grid {
    int width = 0, height = 0;
    const Image<float>* confidence = nullptr;  // of the finest grid; empty right and down go with it
    float floor = 0;
    Image<float> own_z;
    Image<float>* z = nullptr;
    Image<float> b;
    Image<float> step;   // correction from the next coarser grid
    Image<float> right;  // weight of the edge (x, y) - (x + 1, y); 0 in the last column
    Image<float> down;   // weight of the edge (x, y) - (x, y + 1); 0 in the last row

    Grid(int w, int h) : width(w), height(h), b(w, h), step(w, h) {}

    // Of a pixel of the finest grid. What was measured at all counts at least a hundredth: ratios far beyond
    // that make the equations stiff and heights hardly better.
    float weight(int x, int y) const {
        const float c = (*confidence)(x, y);
        return c > 0 ? c + 0.01f : floor;
    }
    float weight_right(int x, int y) const {
        if (x < 0 || x + 1 >= width) return 0;
        return confidence ? std::min(weight(x, y), weight(x + 1, y)) : right(x, y);
    }
    float weight_down(int x, int y) const {
        if (y < 0 || y + 1 >= height) return 0;
        return confidence ? std::min(weight(x, y), weight(x, y + 1)) : down(x, y);
    }

    // Sum of weights and of weight * value over the neighbours of a pixel.
    void neighbours(const Image<float>& u, int x, int y, float& weights, float& weighted) const {
        const float l = weight_right(x - 1, y), r = weight_right(x, y);
        const float t = weight_down(x, y - 1), d = weight_down(x, y);
        weights = l + r + t + d;
        weighted = 0;
        if (x > 0) weighted += l * u(x - 1, y);
        if (x + 1 < width) weighted += r * u(x + 1, y);
        if (y > 0) weighted += t * u(x, y - 1);
        if (y + 1 < height) weighted += d * u(x, y + 1);
    }

    // (A u)(x, y)
    float applied(const Image<float>& u, int x, int y) const {
        float weights = 0, weighted = 0;
        neighbours(u, x, y, weights, weighted);
        return weights * u(x, y) - weighted;
    }
    float residual(int x, int y) const { return b(x, y) - applied(*z, x, y); }
};

// Pixels of one colour depend only on the other colour, so the order within a sweep does not matter.
void smooth(Grid& g, int sweeps) {
    for (int pass = 0; pass < 2 * sweeps; ++pass)
        parallel_for(0, g.height, 32, [&](int begin, int end) {
            for (int y = begin; y < end; ++y)
                for (int x = (y + pass) & 1; x < g.width; x += 2) {
                    float weights = 0, weighted = 0;
                    g.neighbours(*g.z, x, y, weights, weighted);
                    if (weights > 0) (*g.z)(x, y) = (g.b(x, y) + weighted) / weights;
                }
        });
}

// A coarse pixel stands for 2 x 2 fine ones. A coarse edge is twice as long and crosses two fine edges, so
// its weight is their mean.
Grid coarsened(const Grid& fine) {
    Grid coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
    coarse.right = Image<float>(coarse.width, coarse.height);
    coarse.down = Image<float>(coarse.width, coarse.height);
    parallel_for(0, coarse.height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < coarse.width; ++x) {
                for (int k = 0; k < 2; ++k) {
                    const int fy = 2 * y + k, fx = 2 * x + k;
                    if (2 * x + 2 < fine.width && fy < fine.height)
                        coarse.right(x, y) += fine.weight_right(2 * x + 1, fy) / 2;
                    if (2 * y + 2 < fine.height && fx < fine.width)
                        coarse.down(x, y) += fine.weight_down(fx, 2 * y + 1) / 2;
                }
            }
    });
    return coarse;
}

template <class Value>
void restrict_sum(int fine_width, int fine_height, const Value& value, Image<float>& coarse) {
    parallel_for(0, coarse.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < coarse.width(); ++x) {
                float sum = 0;
                for (int fy = 2 * y; fy < std::min(2 * y + 2, fine_height); ++fy)
                    for (int fx = 2 * x; fx < std::min(2 * x + 2, fine_width); ++fx) sum += value(fx, fy);
                coarse(x, y) = sum;
            }
    });
}

// step = the coarse correction, interpolated bilinearly: centres of fine pixels lie a quarter coarse pixel
// off. A neighbour behind a weak edge has less of a say, so that nothing is smeared over the border of what
// was measured.
void prolong(const Image<float>& coarse, Grid& fine) {
    parallel_for(0, fine.height, 32, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const int cy = y / 2, ny = std::clamp(cy + (y & 1 ? 1 : -1), 0, coarse.height() - 1);
            for (int x = 0; x < fine.width; ++x) {
                const int cx = x / 2, nx = std::clamp(cx + (x & 1 ? 1 : -1), 0, coarse.width() - 1);
                const float l = fine.weight_right(x - 1, y), r = fine.weight_right(x, y);
                const float t = fine.weight_down(x, y - 1), d = fine.weight_down(x, y);
                const float strongest = std::max({l, r, t, d, 1e-20f});
                const float a = (x & 1 ? r : l) / strongest, b = (y & 1 ? d : t) / strongest;
                const float sum = 9 * coarse(cx, cy) + 3 * a * coarse(nx, cy) + 3 * b * coarse(cx, ny) +
                                  a * b * coarse(nx, ny);
                fine.step(x, y) = sum / (9 + 3 * a + 3 * b + a * b);
            }
        }
    });
}

// Sums rows one by one, then their sums in order: the same for any number of threads.
template <class Value>
double ordered_sum(int width, int height, const Value& value) {
    std::vector<double> rows(static_cast<std::size_t>(height));
    parallel_for(0, height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            double sum = 0;
            for (int x = 0; x < width; ++x) sum += value(x, y);
            rows[static_cast<std::size_t>(y)] = sum;
        }
    });
    double sum = 0;
    for (const double row : rows) sum += row;
    return sum;
}

void remove_mean(Image<float>& z) {
    const double mean = ordered_sum(z.width(), z.height(), [&](int x, int y) { return double(z(x, y)); }) /
                        static_cast<double>(z.size());
    for (float& value : z.pixels()) value -= static_cast<float>(mean);
}

// Norm of the residual, each divided by its pixel's weights: by how much a pixel differs from what its
// neighbours ask of it [mm]. Undivided, pixels of low confidence would not count.
double residual_norm(const Grid& g) {
    return std::sqrt(ordered_sum(g.width, g.height, [&](int x, int y) {
        float weights = 0, weighted = 0;
        g.neighbours(*g.z, x, y, weights, weighted);
        if (!(weights > 0)) return 0.0;
        const double r = (g.b(x, y) + weighted) / weights - (*g.z)(x, y);
        return r * r;
    }));
}

// Adds the step, as long as lowers the energy most: coarse grids do not know how weights are spread inside
// their pixels, and a step as it comes could overshoot without end.
void take_step(Grid& g) {
    const double gain =
        ordered_sum(g.width, g.height, [&](int x, int y) { return double(g.step(x, y)) * g.residual(x, y); });
    const double bend = ordered_sum(
        g.width, g.height, [&](int x, int y) { return double(g.step(x, y)) * g.applied(g.step, x, y); });
    if (!(bend > 0)) return;
    const float length = static_cast<float>(gain / bend);
    parallel_for(0, g.height, 32, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < g.width; ++x) (*g.z)(x, y) += length * g.step(x, y);
    });
}

void v_cycle(std::vector<Grid>& grids, std::size_t level) {
    Grid& g = grids[level];
    if (level + 1 == grids.size()) {
        smooth(g, 30);
        remove_mean(*g.z);
        return;
    }
    smooth(g, 2);
    Grid& coarse = grids[level + 1];
    restrict_sum(
        g.width, g.height, [&](int x, int y) { return g.residual(x, y); }, coarse.b);
    std::fill(coarse.z->pixels().begin(), coarse.z->pixels().end(), 0.0f);
    v_cycle(grids, level + 1);
    prolong(*coarse.z, g);
    take_step(g);
    smooth(g, 2);
}

// What is left of that norm when every z is rounded to a float.
double rounding_norm(const Grid& g) {
    return std::numeric_limits<float>::epsilon() *
           std::sqrt(ordered_sum(g.width, g.height,
                                 [&](int x, int y) { return double((*g.z)(x, y)) * (*g.z)(x, y); }));
}

// Mean slope of the measured pixels.
Slope mean_slope(const Image<Vec3>& normal, const Image<float>& confidence) {
    const auto mean = [&](auto component) {
        const double sum = ordered_sum(normal.width(), normal.height(), [&](int x, int y) {
            return confidence(x, y) > 0 ? double(component(slope_of(normal(x, y)))) : 0.0;
        });
        const double count = ordered_sum(normal.width(), normal.height(),
                                         [&](int x, int y) { return confidence(x, y) > 0 ? 1.0 : 0.0; });
        return static_cast<float>(count > 0 ? sum / count : 0);
    };
    return {mean([](Slope s) { return s.x; }), mean([](Slope s) { return s.y; })};
}

void set_up_finest(Grid& g, const Image<Vec3>& normal, const Slope& tilt, float mm) {
    // b = divergence of weight * gradient. Rows run down, so a step of one row is -1 in y.
    const auto flux_right = [&](int x, int y) {
        const float mean = 0.5f * (slope_of(normal(x, y)).x + slope_of(normal(x + 1, y)).x);
        return g.weight_right(x, y) * mm * (mean - tilt.x);
    };
    const auto flux_down = [&](int x, int y) {
        const float mean = 0.5f * (slope_of(normal(x, y)).y + slope_of(normal(x, y + 1)).y);
        return -g.weight_down(x, y) * mm * (mean - tilt.y);
    };
    parallel_for(0, g.height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < g.width; ++x) {
                float b = 0;
                if (x > 0) b += flux_right(x - 1, y);
                if (x + 1 < g.width) b -= flux_right(x, y);
                if (y > 0) b += flux_down(x, y - 1);
                if (y + 1 < g.height) b -= flux_down(x, y);
                g.b(x, y) = b;
            }
    });
}

}  // namespace

HeightReport integrate_normals(const Image<Vec3>& normal, const Image<float>& confidence, double mm_per_pixel,
                               Image<float>& height_mm, const HeightOptions& options,
                               const Progress& progress) {
    TP_REQUIRE(normal.region() == confidence.region(), "normals and confidence have one size");
    TP_REQUIRE(normal.size() > 0 && mm_per_pixel > 0, "there are pixels, of a positive size");
    validate(options);
    if (height_mm.region() != normal.region()) height_mm = Image<float>(normal.width(), normal.height());
    std::fill(height_mm.pixels().begin(), height_mm.pixels().end(), 0.0f);

    std::vector<Grid> grids;
    grids.emplace_back(normal.width(), normal.height());
    // The tilt as a whole is a plane, known in closed form; without it heights are small and floats go
    // further.
    const Slope tilt = mean_slope(normal, confidence);
    grids[0].confidence = &confidence;
    grids[0].floor = static_cast<float>(options.weight_floor);
    set_up_finest(grids[0], normal, tilt, static_cast<float>(mm_per_pixel));
    while (grids.back().width > 2 || grids.back().height > 2) grids.push_back(coarsened(grids.back()));
    grids[0].z = &height_mm;
    for (std::size_t i = 1; i < grids.size(); ++i) {
        grids[i].own_z = Image<float>(grids[i].width, grids[i].height);
        grids[i].z = &grids[i].own_z;
    }

    // Nested iteration: the solution of each coarser grid starts the next finer one.
    for (std::size_t i = 1; i < grids.size(); ++i) {
        const Image<float>& fine = grids[i - 1].b;
        restrict_sum(
            fine.width(), fine.height(), [&](int x, int y) { return fine(x, y); }, grids[i].b);
    }
    const double flat = residual_norm(grids[0]);
    HeightReport result;
    result.converged = !(flat > 0);
    for (std::size_t i = grids.size(); i-- > 1;) {
        // The coarser right-hand sides are used up by the cycle below, finer ones are still those of the
        // problem.
        v_cycle(grids, i);
        prolong(*grids[i].z, grids[i - 1]);
        *grids[i - 1].z = grids[i - 1].step;
    }
    result.residual = result.converged ? 0 : 1;
    double before = std::numeric_limits<double>::infinity();
    while (!result.converged && result.cycles < options.max_cycles) {
        report(progress, "height", result.cycles / static_cast<double>(options.max_cycles));
        v_cycle(grids, 0);
        ++result.cycles;
        const double left = residual_norm(grids[0]);
        result.residual = left / flat;
        // A residual like that of rounding is not rounding yet while it falls: long waves are the last to
        // come right and show least in it.
        const double rounding = rounding_norm(grids[0]);
        result.converged = result.residual <= options.tolerance || left <= 0.3 * rounding ||
                           (left <= rounding && left > 0.5 * before);
        before = left;
    }
    subtract({-tilt.x * mm_per_pixel, -tilt.y * mm_per_pixel, 0}, height_mm);
    remove_mean(height_mm);
    report(progress, "height", 1);
    return result;
}

}  // namespace tangi
