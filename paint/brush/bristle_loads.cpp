#include "paint/brush/bristle_loads.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"
#include "surface/base/vector_clones.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr int kRounds = 2;        // of balancing
constexpr float kUnseen = 1e-3f;  // [1] cells at the border, which hold nothing, are seen less than this

// The four cells around a place between cells (u, v > 0), and their shares.
struct Around {
    int first;  // of the upper two; the lower ones follow a row further on
    float w00, w10, w01, w11;
};

TP_INLINE Around around(float u, float v, float last_u, float last_v, int width) {
    u = std::min(std::max(u, 0.0f), last_u);
    v = std::min(std::max(v, 0.0f), last_v);
    const int iu = static_cast<int>(u), iv = static_cast<int>(v);
    const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
    return {iv * width + iu, (1 - fu) * (1 - fv), fu * (1 - fv), (1 - fu) * fv, fu * fv};
}

TP_INLINE float mean(const Around& a, const float* cells, int width) {
    return a.w00 * cells[a.first] + a.w10 * cells[a.first + 1] + a.w01 * cells[a.first + width] +
           a.w11 * cells[a.first + width + 1];
}

bool empty(const std::vector<float>& plane) {
    return std::all_of(plane.begin(), plane.end(), [](float mm) { return mm == 0; });
}

TP_INLINE void add(const Around& a, float amount, float* cells, int width) {
    cells[a.first] += amount * a.w00;
    cells[a.first + 1] += amount * a.w10;
    cells[a.first + width] += amount * a.w01;
    cells[a.first + width + 1] += amount * a.w11;
}

}  // namespace

// Pixels of a row of the view that see cells.
struct BristleLoads::Row {
    std::size_t first;  // in the view
    int count;
    float u, v, du, dv;    // [cells] of the first pixel, from the corner, and from pixel to pixel
    float last_u, last_v;  // [cells] at most
    int width;             // [cells]

    Around cells(int x) const {
        const auto at = static_cast<float>(x);
        return around(u + at * du, v + at * dv, last_u, last_v, width);
    }
};

namespace {

// What pixels see of cells that were multiplied by seen_.
TP_VECTOR_CLONES
void look_row(int n, float u0, float v0, float du, float dv, float last_u, float last_v, int width,
              const float* __restrict cells, const float* __restrict even, float* __restrict out,
              float* __restrict total) {
    for (int x = 0; x < n; ++x) {
        const auto at = static_cast<float>(x);
        const float mm =
            even[x] * mean(around(u0 + at * du, v0 + at * dv, last_u, last_v, width), cells, width);
        out[x] = mm;
        total[x] += mm;
    }
}

// What makes pixels see as much as others; at the border, where they see few cells, no more than that.
TP_VECTOR_CLONES
void even_row(int n, float u0, float v0, float du, float dv, float last_u, float last_v, int width,
              const float* __restrict seen, float* __restrict even) {
    for (int x = 0; x < n; ++x) {
        const auto at = static_cast<float>(x);
        const float sum = mean(around(u0 + at * du, v0 + at * dv, last_u, last_v, width), seen, width);
        even[x] = 1 / std::min(std::max(sum, 0.5f), 2.0f);
    }
}

}  // namespace

BristleLoads::BristleLoads(int half_u, int half_v, int half)
    : half_u_(half_u),
      half_v_(half_v),
      half_(half),
      total_(static_cast<std::size_t>(2 * half + 1) * static_cast<std::size_t>(2 * half + 1), 0.0f),
      seen_(static_cast<std::size_t>(2 * half_u + 1) * static_cast<std::size_t>(2 * half_v + 1)),
      even_(total_.size()),
      scaled_(seen_.size()) {}

template <class Body>
void BristleLoads::for_rows(const Body& body) const {
    const double c = portable::cos(rotation_rad_), s = portable::sin(rotation_rad_);
    for (int y = -half_; y <= half_; ++y) {
        double low = -half_, high = half_;
        const auto within = [&](double slope, double offset, double half) {  // |slope x + offset| <= half
            if (std::abs(slope) < 1e-9) {
                if (std::abs(offset) > half) high = low - 1;
                return;
            }
            const double one = (-half - offset) / slope, other = (half - offset) / slope;
            low = std::max(low, std::min(one, other));
            high = std::min(high, std::max(one, other));
        };
        within(c, y * s, half_u_ - 0.01);
        within(-s, y * c, half_v_ - 0.01);
        const int begin = static_cast<int>(std::ceil(low)), end = static_cast<int>(std::floor(high)) + 1;
        if (end <= begin) continue;
        body(Row{static_cast<std::size_t>(y + half_) * static_cast<std::size_t>(2 * half_ + 1) +
                     static_cast<std::size_t>(begin + half_),
                 end - begin, static_cast<float>(begin * c + y * s + half_u_),
                 static_cast<float>(y * c - begin * s + half_v_), static_cast<float>(c),
                 static_cast<float>(-s), static_cast<float>(2 * half_u_) - 0.001f,
                 static_cast<float>(2 * half_v_) - 0.001f, 2 * half_u_ + 1});
    }
}

void BristleLoads::clear() {
    ids_.clear();
    cells_.clear();
    views_.clear();
    viewed_ = false;
}

std::vector<std::vector<float>> BristleLoads::cells() const {
    auto cells = cells_;
    if (viewed_) settle(cells);
    return cells;
}

void BristleLoads::set(std::vector<IngredientId> ingredients, std::vector<std::vector<float>> cells) {
    TP_REQUIRE(ingredients.size() == cells.size(), "cells of each ingredient");
    TP_REQUIRE(std::is_sorted(ingredients.begin(), ingredients.end()), "paints are in order");
    for (const auto& plane : cells) TP_REQUIRE(plane.size() == seen_.size(), "cells of this brush");
    ids_ = std::move(ingredients);
    cells_ = std::move(cells);
    views_.assign(cells_.size(), {});
    viewed_ = false;
}

void BristleLoads::rest() {
    if (viewed_) settle(cells_);
    viewed_ = false;
}

void BristleLoads::turn_to(float rotation_rad) {
    if (viewed_ && rotation_rad == rotation_rad_) return;
    rest();
    rotation_rad_ = rotation_rad;
    look();
}

// Rows and columns of the weights in turn, cells last (Sinkhorn 1964, "A relationship between arbitrary
// positive matrices and doubly stochastic matrices"): every cell is seen completely, and pixels see equally
// much but for a hundredth.
void BristleLoads::balance() {
    std::fill(even_.begin(), even_.end(), 1.0f);
    for (int round = 0;; ++round) {
        std::fill(seen_.begin(), seen_.end(), 0.0f);
        for_rows([&](const Row& row) {
            const float* even = even_.data() + row.first;
            for (int x = 0; x < row.count; ++x) add(row.cells(x), even[x], seen_.data(), row.width);
        });
        for (float& sum : seen_) sum = sum > kUnseen ? 1 / sum : 0;
        if (round == kRounds) return;
        for_rows([&](const Row& row) {
            float* even = even_.data() + row.first;
            even_row(row.count, row.u, row.v, row.du, row.dv, row.last_u, row.last_v, row.width, seen_.data(),
                     even);
        });
    }
}

void BristleLoads::look() {
    viewed_ = true;
    std::fill(total_.begin(), total_.end(), 0.0f);
    balance();
    for (std::size_t i = 0; i < ids_.size(); ++i) {
        for (std::size_t k = 0; k < scaled_.size(); ++k) scaled_[k] = cells_[i][k] * seen_[k];
        views_[i].assign(total_.size(), 0.0f);
        if (empty(cells_[i])) continue;
        for_rows([&](const Row& row) {
            look_row(row.count, row.u, row.v, row.du, row.dv, row.last_u, row.last_v, row.width,
                     scaled_.data(), even_.data() + row.first, views_[i].data() + row.first,
                     total_.data() + row.first);
        });
    }
}

void BristleLoads::settle(std::vector<std::vector<float>>& cells) const {
    std::vector<float> scaled(seen_.size()), change(seen_.size());
    for (std::size_t i = 0; i < ids_.size(); ++i) {
        if (empty(cells[i]) && empty(views_[i])) continue;
        for (std::size_t k = 0; k < scaled.size(); ++k) scaled[k] = cells[i][k] * seen_[k];
        std::fill(change.begin(), change.end(), 0.0f);
        for_rows([&](const Row& row) {
            const float *now = views_[i].data() + row.first, *even = even_.data() + row.first;
            for (int x = 0; x < row.count; ++x) {
                const Around at = row.cells(x);
                const float before = even[x] * mean(at, scaled.data(), row.width), gained = now[x] - before;
                if (gained > 0) {
                    add(at, gained, change.data(), row.width);
                } else if (gained < 0 && before > 0) {
                    const float part = gained / before * even[x];
                    float* to = change.data() + at.first;
                    const float* from = scaled.data() + at.first;
                    to[0] += part * at.w00 * from[0];
                    to[1] += part * at.w10 * from[1];
                    to[row.width] += part * at.w01 * from[row.width];
                    to[row.width + 1] += part * at.w11 * from[row.width + 1];
                }
            }
        });
        for (std::size_t k = 0; k < change.size(); ++k) cells[i][k] = std::max(cells[i][k] + change[k], 0.0f);
    }
}

std::size_t BristleLoads::number_of(IngredientId ingredient) {
    if (!viewed_) look();
    const auto found = std::lower_bound(ids_.begin(), ids_.end(), ingredient);
    const auto number = found - ids_.begin();
    if (found == ids_.end() || *found != ingredient) {
        ids_.insert(found, ingredient);
        cells_.insert(cells_.begin() + number, std::vector<float>(seen_.size(), 0.0f));
        views_.insert(views_.begin() + number, std::vector<float>(total_.size(), 0.0f));
    }
    return static_cast<std::size_t>(number);
}

float* BristleLoads::view(IngredientId ingredient) { return views_[number_of(ingredient)].data(); }

float* BristleLoads::view_total() {
    if (!viewed_) look();
    return total_.data();
}

}  // namespace tangi
