#include "fit/height.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

// One grid of the hierarchy: A z = b with A the graph Laplacian of the edge weights. The finest grid's unknown is
// the caller's height map.
struct Grid {
    int width = 0, height = 0;
    Image<float> own_z;
    Image<float>* z = nullptr;
    Image<float> b;
    Image<float> right;  // weight of the edge (x, y) - (x + 1, y); 0 in the last column
    Image<float> down;   // weight of the edge (x, y) - (x, y + 1); 0 in the last row

    Grid(int w, int h) : width(w), height(h), b(w, h), right(w, h), down(w, h) {}

    float weight_left(int x, int y) const { return x > 0 ? right(x - 1, y) : 0; }
    float weight_up(int x, int y) const { return y > 0 ? down(x, y - 1) : 0; }

    // Sum of weights and of weight * z over the neighbours of a pixel.
    void neighbours(int x, int y, float& weights, float& weighted) const {
        const Image<float>& u = *z;
        const float l = weight_left(x, y), r = right(x, y), t = weight_up(x, y), d = down(x, y);
        weights = l + r + t + d;
        weighted = 0;
        if (x > 0) weighted += l * u(x - 1, y);
        if (x + 1 < width) weighted += r * u(x + 1, y);
        if (y > 0) weighted += t * u(x, y - 1);
        if (y + 1 < height) weighted += d * u(x, y + 1);
    }

    float residual(int x, int y) const {
        float weights = 0, weighted = 0;
        neighbours(x, y, weights, weighted);
        return b(x, y) - weights * (*z)(x, y) + weighted;
    }
};

// Pixels of one colour depend only on the other colour, so the order within a sweep does not matter.
void smooth(Grid& g, int sweeps) {
    for (int pass = 0; pass < 2 * sweeps; ++pass)
        parallel_for(0, g.height, 32, [&](int begin, int end) {
            for (int y = begin; y < end; ++y)
                for (int x = (y + pass) & 1; x < g.width; x += 2) {
                    float weights = 0, weighted = 0;
                    g.neighbours(x, y, weights, weighted);
                    if (weights > 0) (*g.z)(x, y) = (g.b(x, y) + weighted) / weights;
                }
        });
}

// A coarse pixel stands for 2 x 2 fine ones. A coarse edge is twice as long and crosses two fine edges, so its
// weight is their mean.
Grid coarsened(const Grid& fine) {
    Grid coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
    parallel_for(0, coarse.height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < coarse.width; ++x) {
                for (int k = 0; k < 2; ++k) {
                    const int fy = 2 * y + k, fx = 2 * x + k;
                    if (2 * x + 2 < fine.width && fy < fine.height) coarse.right(x, y) += fine.right(2 * x + 1, fy) / 2;
                    if (2 * y + 2 < fine.height && fx < fine.width) coarse.down(x, y) += fine.down(fx, 2 * y + 1) / 2;
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

// Adds the bilinearly interpolated coarse correction: centres of fine pixels lie a quarter coarse pixel off.
void prolong_add(const Image<float>& coarse, Image<float>& fine) {
    parallel_for(0, fine.height(), 32, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const int cy = y / 2, ny = std::clamp(cy + (y & 1 ? 1 : -1), 0, coarse.height() - 1);
            for (int x = 0; x < fine.width(); ++x) {
                const int cx = x / 2, nx = std::clamp(cx + (x & 1 ? 1 : -1), 0, coarse.width() - 1);
                fine(x, y) += (9 * coarse(cx, cy) + 3 * (coarse(nx, cy) + coarse(cx, ny)) + coarse(nx, ny)) / 16;
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

double residual_norm(const Grid& g) {
    return std::sqrt(ordered_sum(g.width, g.height, [&](int x, int y) {
        const double r = g.residual(x, y);
        return r * r;
    }));
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
    restrict_sum(g.width, g.height, [&](int x, int y) { return g.residual(x, y); }, coarse.b);
    std::fill(coarse.z->pixels().begin(), coarse.z->pixels().end(), 0.0f);
    v_cycle(grids, level + 1);
    prolong_add(*coarse.z, *g.z);
    smooth(g, 2);
}

// Mean slope of the measured pixels.
Slope mean_slope(const Image<Vec3>& normal, const Image<float>& confidence) {
    const auto mean = [&](auto component) {
        const double sum = ordered_sum(normal.width(), normal.height(), [&](int x, int y) {
            return confidence(x, y) > 0 ? double(component(slope_of(normal(x, y)))) : 0.0;
        });
        const double count =
            ordered_sum(normal.width(), normal.height(), [&](int x, int y) { return confidence(x, y) > 0 ? 1.0 : 0.0; });
        return static_cast<float>(count > 0 ? sum / count : 0);
    };
    return {mean([](Slope s) { return s.x; }), mean([](Slope s) { return s.y; })};
}

void set_up_finest(Grid& g, const Image<Vec3>& normal, const Image<float>& confidence, const Slope& tilt, float mm,
                   float floor) {
    parallel_for(0, g.height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < g.width; ++x) {
                const float here = confidence(x, y);
                g.right(x, y) = x + 1 < g.width ? std::min(here, confidence(x + 1, y)) + floor : 0;
                g.down(x, y) = y + 1 < g.height ? std::min(here, confidence(x, y + 1)) + floor : 0;
            }
    });
    // b = divergence of weight * gradient. Rows run down, so a step of one row is -1 in y.
    const auto flux_right = [&](int x, int y) {
        const float mean = 0.5f * (slope_of(normal(x, y)).x + slope_of(normal(x + 1, y)).x);
        return g.right(x, y) * mm * (mean - tilt.x);
    };
    const auto flux_down = [&](int x, int y) {
        const float mean = 0.5f * (slope_of(normal(x, y)).y + slope_of(normal(x, y + 1)).y);
        return -g.down(x, y) * mm * (mean - tilt.y);
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
                               Image<float>& height_mm, const HeightOptions& options, const Progress& progress) {
    TP_REQUIRE(normal.region() == confidence.region(), "normals and confidence have one size");
    TP_REQUIRE(normal.size() > 0 && mm_per_pixel > 0, "there are pixels, of a positive size");
    validate(options);
    height_mm = Image<float>(normal.width(), normal.height());

    std::vector<Grid> grids;
    grids.emplace_back(normal.width(), normal.height());
    // The tilt as a whole is a plane, known in closed form; without it heights are small and floats go further.
    const Slope tilt = mean_slope(normal, confidence);
    set_up_finest(grids[0], normal, confidence, tilt, static_cast<float>(mm_per_pixel),
                  static_cast<float>(options.weight_floor));
    while (grids.back().width > 2 || grids.back().height > 2) grids.push_back(coarsened(grids.back()));
    grids[0].z = &height_mm;
    for (std::size_t i = 1; i < grids.size(); ++i) {
        grids[i].own_z = Image<float>(grids[i].width, grids[i].height);
        grids[i].z = &grids[i].own_z;
    }

    // Nested iteration: the solution of each coarser grid starts the next finer one.
    for (std::size_t i = 1; i < grids.size(); ++i) {
        const Image<float>& fine = grids[i - 1].b;
        restrict_sum(fine.width(), fine.height(), [&](int x, int y) { return fine(x, y); }, grids[i].b);
    }
    const double flat = residual_norm(grids[0]);
    HeightReport result;
    result.converged = !(flat > 0);
    for (std::size_t i = grids.size(); i-- > 1;) {
        // The coarser right-hand sides are used up by the cycle below, finer ones are still those of the problem.
        v_cycle(grids, i);
        Image<float>& finer = *grids[i - 1].z;
        prolong_add(*grids[i].z, finer);
    }
    result.residual = result.converged ? 0 : 1;
    while (!result.converged && result.cycles < options.max_cycles) {
        report(progress, "height", result.cycles / static_cast<double>(options.max_cycles));
        v_cycle(grids, 0);
        ++result.cycles;
        const double before = result.residual;
        result.residual = residual_norm(grids[0]) / flat;
        // Once rounding of z is all that is left, cycles stop helping.
        const bool at_precision = result.residual < 1e-3 && result.residual > 0.8 * before;
        result.converged = result.residual <= options.tolerance || at_precision;
    }
    subtract({-tilt.x * mm_per_pixel, -tilt.y * mm_per_pixel, 0}, height_mm);
    remove_mean(height_mm);
    report(progress, "height", 1);
    return result;
}

}  // namespace tangi
