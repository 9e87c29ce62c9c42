#include "fit/height_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

// Pixels of one colour depend only on the other colour, so the order within a sweep does not matter.
void smooth(HeightGrid& g, int sweeps) {
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

// [1] An edge inside a coarse pixel counts as this part of the one between it and the next, at least: beside
// a hole, a coarse grid that knows of no way across says less than one that knows of too good a one. Without
// it weights that jump a thousandfold do not converge; with 1 the waves of fit_bench's 7 megapixels are right
// to 0.016 pixels instead of 0.007.
constexpr float kWayAcross = 0.5f;

// [1] Weight of three edges in a row, of which the outer two count half, as conductances in series: what long
// waves see of weights that change from pixel to pixel. 1/2 where all are 1.
float in_series(float before, float between, float after) {
    if (!(between > 0)) return 0;
    const float least = kWayAcross * between;
    return 1 / (0.5f / std::max(before, least) + 1 / between + 0.5f / std::max(after, least));
}

// A coarse pixel stands for 2 x 2 fine ones. A coarse edge leads from the middle of one to the middle of the
// next, along two rows of fine edges side by side. At the border, where a coarse pixel has but one fine one,
// there is no edge inside it.
void coarsen_weights(const HeightGrid& fine, HeightGrid& coarse) {
    const auto right_or = [&](int x, int y, float other) {
        return x + 1 < fine.width ? fine.weight_right(x, y) : other;
    };
    const auto down_or = [&](int x, int y, float other) {
        return y + 1 < fine.height ? fine.weight_down(x, y) : other;
    };
    parallel_for(0, coarse.height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < coarse.width; ++x) {
                float right = 0, down = 0;
                for (int k = 0; k < 2; ++k) {
                    const int fy = 2 * y + k, fx = 2 * x + k;
                    if (2 * x + 2 < fine.width && fy < fine.height) {
                        const float between = fine.weight_right(2 * x + 1, fy);
                        right += in_series(fine.weight_right(2 * x, fy), between,
                                           right_or(2 * x + 2, fy, between));
                    }
                    if (2 * y + 2 < fine.height && fx < fine.width) {
                        const float between = fine.weight_down(fx, 2 * y + 1);
                        down +=
                            in_series(fine.weight_down(fx, 2 * y), between, down_or(fx, 2 * y + 2, between));
                    }
                }
                coarse.right(x, y) = right;
                coarse.down(x, y) = down;
            }
    });
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
void prolong(const Image<float>& coarse, HeightGrid& fine) {
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

// Adds the step, as long as lowers the energy most: coarse grids do not know how weights are spread inside
// their pixels, and a step as it comes could overshoot without end.
void take_step(HeightGrid& g) {
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

void v_cycle(std::vector<HeightGrid>& grids, std::size_t level) {
    HeightGrid& g = grids[level];
    if (level + 1 == grids.size()) {
        smooth(g, 30);
        remove_mean(*g.z);
        return;
    }
    smooth(g, 2);
    HeightGrid& coarse = grids[level + 1];
    restrict_sum(
        g.width, g.height, [&](int x, int y) { return g.residual(x, y); }, coarse.b);
    std::fill(coarse.z->pixels().begin(), coarse.z->pixels().end(), 0.0f);
    v_cycle(grids, level + 1);
    prolong(*coarse.z, g);
    take_step(g);
    smooth(g, 2);
}

}  // namespace

void remove_mean(Image<float>& z) {
    const double mean = ordered_sum(z.width(), z.height(), [&](int x, int y) { return double(z(x, y)); }) /
                        static_cast<double>(z.size());
    for (float& value : z.pixels()) value -= static_cast<float>(mean);
}

HeightMultigrid::HeightMultigrid(const Image<HalfError>& right, const Image<HalfError>& down,
                                 Image<float>& z) {
    TP_REQUIRE(right.region() == z.region() && down.region() == z.region(), "maps of one size");
    grids_.emplace_back(z.width(), z.height());
    grids_[0].half_right = &right;
    grids_[0].half_down = &down;
    grids_[0].z = &z;
    while (grids_.back().width > 2 || grids_.back().height > 2) {
        const HeightGrid& fine = grids_.back();
        HeightGrid coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
        coarse.right = Image<float>(coarse.width, coarse.height);
        coarse.down = Image<float>(coarse.width, coarse.height);
        coarse.own_z = Image<float>(coarse.width, coarse.height);
        grids_.push_back(std::move(coarse));
    }
    for (std::size_t i = 1; i < grids_.size(); ++i) grids_[i].z = &grids_[i].own_z;
}

void HeightMultigrid::coarsen() {
    for (std::size_t i = 1; i < grids_.size(); ++i) coarsen_weights(grids_[i - 1], grids_[i]);
}

void HeightMultigrid::start() {
    for (std::size_t i = 1; i < grids_.size(); ++i) {
        const Image<float>& fine = grids_[i - 1].b;
        restrict_sum(
            fine.width(), fine.height(), [&](int x, int y) { return fine(x, y); }, grids_[i].b);
    }
    for (HeightGrid& g : grids_) std::fill(g.z->pixels().begin(), g.z->pixels().end(), 0.0f);
    for (std::size_t i = grids_.size(); i-- > 1;) {
        // The coarser right-hand sides are used up by the cycle below, finer ones are still those of the
        // problem.
        v_cycle(grids_, i);
        prolong(*grids_[i].z, grids_[i - 1]);
        *grids_[i - 1].z = grids_[i - 1].step;
    }
}

void HeightMultigrid::cycle() { v_cycle(grids_, 0); }

double HeightMultigrid::residual_norm() const {
    const HeightGrid& g = grids_[0];
    return std::sqrt(ordered_sum(g.width, g.height, [&](int x, int y) {
        float weights = 0, weighted = 0;
        g.neighbours(*g.z, x, y, weights, weighted);
        if (!(weights > 0)) return 0.0;
        const double r = (g.b(x, y) + weighted) / weights - (*g.z)(x, y);
        return r * r;
    }));
}

double HeightMultigrid::rounding_norm() const {
    const HeightGrid& g = grids_[0];
    return std::numeric_limits<float>::epsilon() *
           std::sqrt(ordered_sum(g.width, g.height,
                                 [&](int x, int y) { return double((*g.z)(x, y)) * (*g.z)(x, y); }));
}

}  // namespace tangi
