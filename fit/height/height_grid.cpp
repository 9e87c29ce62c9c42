#include "fit/height/height_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// A u of a row.
void apply(const HeightGrid& g, const Image<float>& u, int y, float* applied) {
    g.with_row(u, y, [&](const auto& row) { apply_row(row, applied); });
}

// What the pixels of a row are to be.
void solve(const HeightGrid& g, int y, float* solved) {
    g.with_row(*g.z, y, [&](const auto& row) { solve_row(row, g.b.row(y).data(), solved); });
}

// Passes over the pixels of one colour, then of the other, as on a chequerboard: those of a colour depend
// only on the other, so the order within a pass does not matter. Four passes go through a band of rows
// together, each a row behind the one before, so that what they look at stays in the processor's caches; at
// the border of two bands, where a pass has to wait for both, rows are left for the end. Bands side by side
// are never worked on at once.
void smooth(HeightGrid& g, int rounds) {
    constexpr int kPasses = 4, kBand = 64;
    const int bands = std::max(g.height / kBand, 1);
    const auto begin_of = [&](int band) {
        return static_cast<int>(static_cast<std::int64_t>(g.height) * band / bands);
    };
    const auto relax = [&](int y, int pass, float* solved) {
        solve(g, y, solved);
        float* z = g.z->row(y).data();
        for (int x = (y + pass) & 1; x < g.width; x += 2) z[x] = solved[x];
    };
    const auto inside = [&](int band, float* solved) {
        const int first = begin_of(band), end = begin_of(band + 1);
        for (int front = first; front < end + kPasses - 1; ++front)
            for (int pass = 0; pass < kPasses; ++pass) {
                const int y = front - pass;
                if (y >= first + (band > 0 ? pass : 0) && y < end - (band + 1 < bands ? pass : 0))
                    relax(y, pass, solved);
            }
    };
    const auto at_border = [&](int band, float* solved) {  // with the band above
        for (int pass = 1; pass < kPasses; ++pass)
            for (int y = begin_of(band) - pass; y < begin_of(band) + pass; ++y) relax(y, pass, solved);
    };
    const auto every_second = [&](int first, int count, const auto& work) {
        parallel_for(0, (count - first + 1) / 2, 1, [&](int begin, int end) {
            std::vector<float> scratch(static_cast<std::size_t>(g.width));
            for (int i = begin; i < end; ++i) work(first + 2 * i, scratch.data());
        });
    };
    for (int round = 0; round < rounds; ++round) {
        every_second(0, bands, inside);
        every_second(1, bands, inside);
        every_second(1, bands, at_border);
        every_second(2, bands, at_border);
    }
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

// Sums of 2 x 2 values; row(y, scratch) gives a row of them.
template <class Row>
void restrict_sum(const HeightGrid& fine, const Row& row, Image<float>& coarse) {
    parallel_for(0, coarse.height(), 16, [&](int begin, int end) {
        std::vector<float> scratch(static_cast<std::size_t>(fine.width));
        for (int y = begin; y < end; ++y) {
            float* sums = coarse.row(y).data();
            std::fill_n(sums, coarse.width(), 0.0f);
            for (int fy = 2 * y; fy < std::min(2 * y + 2, fine.height); ++fy) {
                const float* values = row(fy, scratch.data());
                for (int x = 0; x < fine.width / 2; ++x)
                    sums[x] = sums[x] + values[2 * x] + values[2 * x + 1];
                if (fine.width & 1) sums[fine.width / 2] += values[fine.width - 1];
            }
        }
    });
}

// Each pixel of a fine row has that of the coarse row it lies in, and the coarse pixel beside that which is
// nearer.
void spread_row(const Image<float>& coarse, int y, int width, float* own, float* beside) {
    const float* from = coarse.row(y).data();
    const int last = coarse.width() - 1;
    for (int x = 0; x < width; ++x) own[x] = from[x / 2];
    for (int x = 0; x < width; x += 2) beside[x] = from[std::max(x / 2 - 1, 0)];
    for (int x = 1; x < width; x += 2) beside[x] = from[std::min(x / 2 + 1, last)];
}

// step = the coarse correction, interpolated.
void prolong(const Image<float>& coarse, HeightGrid& fine) {
    const auto n = static_cast<std::size_t>(fine.width);
    parallel_for(0, fine.height, 32, [&](int begin, int end) {
        std::vector<float> scratch(4 * n);
        float *own = scratch.data(), *along = own + n, *across = along + n, *both = across + n;
        for (int y = begin; y < end; ++y) {
            const int row_of = y / 2, beside = std::clamp(row_of + (y & 1 ? 1 : -1), 0, coarse.height() - 1);
            spread_row(coarse, row_of, fine.width, own, along);
            spread_row(coarse, beside, fine.width, across, both);
            fine.with_row(fine.step, y, [&](const auto& row) {
                interpolate_row(row, {own, along, across, both}, y & 1, fine.step.row(y).data());
            });
        }
    });
}

using TwoSums = std::array<double, 2>;

// Sums rows one by one, row(y, scratch of one row), then their sums in order: the same for any number of
// threads.
template <class Row>
TwoSums ordered_sums(int width, int height, const Row& row) {
    std::vector<TwoSums> rows(static_cast<std::size_t>(height));
    parallel_for(0, height, 16, [&](int begin, int end) {
        std::vector<float> scratch(static_cast<std::size_t>(width));
        for (int y = begin; y < end; ++y) rows[static_cast<std::size_t>(y)] = row(y, scratch.data());
    });
    TwoSums sums{};
    for (const TwoSums& some : rows)
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += some[i];
    return sums;
}

// Adds the step, as long as lowers the energy most: coarse grids do not know how weights are spread inside
// their pixels, and a step as it comes could overshoot without end.
void take_step(HeightGrid& g) {
    const auto [gain, bend] = ordered_sums(g.width, g.height, [&](int y, float* applied) {
        const float *step = g.step.row(y).data(), *b = g.b.row(y).data();
        apply(g, *g.z, y, applied);
        const double gained = product_of_rest(g.width, step, b, applied);
        apply(g, g.step, y, applied);
        return TwoSums{gained, product(g.width, step, applied)};
    });
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
        smooth(g, 15);
        remove_mean(*g.z);
        return;
    }
    smooth(g, 1);
    HeightGrid& coarse = grids[level + 1];
    restrict_sum(
        g,
        [&](int y, float* residual) {
            apply(g, *g.z, y, residual);
            const float* b = g.b.row(y).data();
            for (int x = 0; x < g.width; ++x) residual[x] = b[x] - residual[x];
            return residual;
        },
        coarse.b);
    std::fill(coarse.z->pixels().begin(), coarse.z->pixels().end(), 0.0f);
    v_cycle(grids, level + 1);
    prolong(*coarse.z, g);
    take_step(g);
    smooth(g, 1);
}

}  // namespace

void remove_mean(Image<float>& z) {
    const auto [sum, unused] = ordered_sums(z.width(), z.height(), [&](int y, float*) {
        const std::span<const float> row = std::as_const(z).row(y);
        return TwoSums{std::accumulate(row.begin(), row.end(), 0.0), 0};
    });
    const double mean = sum / static_cast<double>(z.size());
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
        const HeightGrid& fine = grids_[i - 1];
        restrict_sum(
            fine, [&](int y, float*) { return fine.b.row(y).data(); }, grids_[i].b);
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

HeightMultigrid::Norms HeightMultigrid::norms() const {
    const HeightGrid& g = grids_[0];
    const auto [residual, value] = ordered_sums(g.width, g.height, [&](int y, float* solved) {
        solve(g, y, solved);
        const float* z = std::as_const(*g.z).row(y).data();
        return TwoSums{squared_difference(g.width, solved, z), product(g.width, z, z)};
    });
    return {std::sqrt(residual), std::numeric_limits<float>::epsilon() * std::sqrt(value)};
}

double HeightMultigrid::flat() const {
    const HeightGrid& g = grids_[0];
    const std::vector<float> zeros(static_cast<std::size_t>(g.width));
    const auto [residual, unused] = ordered_sums(g.width, g.height, [&](int y, float* solved) {
        g.with_row(*g.z, y, [&](auto row) {
            row.above = row.here = row.below = zeros.data();
            solve_row(row, g.b.row(y).data(), solved);
        });
        return TwoSums{product(g.width, solved, solved), 0};
    });
    return std::sqrt(residual);
}

}  // namespace tangi
