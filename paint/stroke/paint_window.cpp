#include "paint/stroke/paint_window.h"

#include <algorithm>
#include <cstring>

#include "surface/base/parallel.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

// Mean over 2 * radius + 1 values of a row around each, of which those beyond the ends count as the ends.
// `padded` has room for 2 * radius + 1 more.
void mean_along(const float* in, float* out, int count, int radius, std::vector<double>& padded) {
    const auto r = static_cast<std::size_t>(radius), n = static_cast<std::size_t>(count);
    padded.resize(n + 2 * r + 1);
    std::fill_n(padded.begin(), r, double(in[0]));
    std::copy_n(in, n, padded.begin() + radius);
    std::fill_n(padded.begin() + radius + count, r + 1, double(in[n - 1]));
    double sum = 0;
    for (std::size_t i = 0; i <= 2 * r; ++i) sum += padded[i];
    for (std::size_t i = 0; i < n; ++i) {
        out[i] = static_cast<float>(sum / static_cast<double>(2 * radius + 1));
        sum += padded[i + 2 * r + 1] - padded[i];
    }
}

// out = here - sum / all; and the sum goes on by a row.
TP_VECTOR_CLONES
void above_mean_row(int n, const float* __restrict here, const float* __restrict next,
                    const float* __restrict last, double all, double* __restrict sum, float* __restrict out) {
    for (int x = 0; x < n; ++x) {
        out[x] = here[x] - static_cast<float>(sum[x] / all);
        sum[x] += static_cast<double>(next[x]) - static_cast<double>(last[x]);
    }
}

TP_VECTOR_CLONES
void take_row(int n, const float* __restrict from, float* __restrict to, float* __restrict sum) {
    for (int x = 0; x < n; ++x) {
        to[x] = from[x];
        sum[x] += from[x];
    }
}

bool holds_paint(const float* row, int n) {
    return std::any_of(row, row + n, [](float mm) { return mm != 0; });
}

std::size_t in_tile(int x, int y) {
    return static_cast<std::size_t>((y % kTileSize) * kTileSize + x % kTileSize);
}

}  // namespace

template <class Body>
void PaintWindow::for_tiles(const PaintLayer& layer, const Body& body) const {
    const auto some = [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            body(i, intersection(on_canvas_, layer.region_of(tiles_[i])));
    };
    const int count = static_cast<int>(tiles_.size());
    if (region_.width() * region_.height() < kParallelPixels)
        some(0, count);
    else
        parallel_for(0, count, 1, some);
}

PaintWindow::PaintWindow(const Canvas& canvas, const Region& region, std::vector<IngredientId> ingredients,
                         int ride_px, bool upper, Memory& memory)
    : region_(region),
      on_canvas_(intersection(region, canvas.region())),
      stride_(static_cast<std::size_t>(region.width())),
      ingredients_(std::move(ingredients)),
      memory_(memory) {
    if (on_canvas_.empty()) on_canvas_ = {};
    for (int y = on_canvas_.y0 / kTileSize; y * kTileSize < on_canvas_.y1; ++y)
        for (int x = on_canvas_.x0 / kTileSize; x * kTileSize < on_canvas_.x1; ++x) tiles_.push_back({x, y});
    for (const TileIndex at : tiles_) {
        const auto& tile = canvas.wet().tile(at);
        if (!tile || tile->ingredients.empty()) continue;
        for (const IngredientId id : tile->ingredients) ingredients_.push_back(paint_of(id));
        upper = upper || is_upper(tile->ingredients.back());
    }
    std::sort(ingredients_.begin(), ingredients_.end());
    ingredients_.erase(std::unique(ingredients_.begin(), ingredients_.end()), ingredients_.end());
    for (const IngredientId id : ingredients_) {
        planes_.push_back(id);
        if (upper) planes_.push_back(upper_of(id));
    }
    const auto pixels = stride_ * static_cast<std::size_t>(region.height());
    memory_.paint.resize(std::max(memory_.paint.size(), planes_.size()));
    for (std::size_t i = 0; i < planes_.size(); ++i) memory_.paint[i].resize(pixels);
    for (auto* plane : {&memory_.total, &memory_.relief, &memory_.open}) plane->resize(pixels);
    if (!(on_canvas_ == region_)) clear();
    if (on_canvas_.empty()) return;
    find_relief(canvas, ride_px);
    for_tiles(canvas.wet(), [&](std::size_t i, const Region& part) {
        find_open(canvas, part);
        take_paint(canvas.wet(), tiles_[i], part);
    });
}

// Beside the canvas nothing lies, and nothing is open.
void PaintWindow::clear() {
    for (std::size_t i = 0; i < planes_.size(); ++i) std::ranges::fill(memory_.paint[i], 0.0f);
    for (auto* plane : {&memory_.total, &memory_.relief, &memory_.open}) std::ranges::fill(*plane, 0.0f);
}

void PaintWindow::find_relief(const Canvas& canvas, int ride_px) {
    const Region wide = intersection(
        {on_canvas_.x0 - ride_px, on_canvas_.y0 - ride_px, on_canvas_.x1 + ride_px, on_canvas_.y1 + ride_px},
        canvas.region());
    const auto stride = static_cast<std::size_t>(wide.width());
    std::vector<float>&height = memory_.height, &mean = memory_.mean;
    height.resize(stride * static_cast<std::size_t>(wide.height()));
    mean.resize(height.size());
    constexpr int kLines = 64;  // rows or columns, before a second thread wakes up
    parallel_for(0, wide.height(), kLines, [&](int begin, int end) {
        const auto row = [&](int y) { return static_cast<std::size_t>(y) * stride; };
        std::fill_n(height.data() + row(begin), row(end - begin), 0.0f);
        canvas.relief_mm({wide.x0, wide.y0 + begin, wide.x1, wide.y0 + end}, height.data() + row(begin),
                         stride);
        std::vector<double> padded;
        for (int y = begin; y < end; ++y)
            mean_along(height.data() + row(y), mean.data() + row(y), wide.width(), ride_px, padded);
    });
    parallel_for(on_canvas_.x0, on_canvas_.x1, kLines, [&](int begin, int end) {
        // Rows of means and of heights, of which those beyond the ends count as the ends.
        const auto at = [&](int y) {
            return static_cast<std::size_t>(std::clamp(y, wide.y0, wide.y1 - 1) - wide.y0) * stride +
                   static_cast<std::size_t>(begin - wide.x0);
        };
        std::vector<double> sum(static_cast<std::size_t>(end - begin), 0.0);
        const int n = end - begin, first = on_canvas_.y0;
        for (int y = first - ride_px; y <= first + ride_px; ++y)
            for (int x = 0; x < n; ++x)
                sum[static_cast<std::size_t>(x)] += mean[at(y) + static_cast<std::size_t>(x)];
        for (int y = first; y < on_canvas_.y1; ++y)
            above_mean_row(n, height.data() + at(y), mean.data() + at(y + ride_px + 1),
                           mean.data() + at(y - ride_px), 2 * ride_px + 1, sum.data(),
                           memory_.relief.data() + index(begin, y));
    });
}

void PaintWindow::find_open(const Canvas& canvas, const Region& part) {
    for (int y = part.y0; y < part.y1; ++y) {
        float* row = memory_.open.data() + index(part.x0, y);
        if (canvas.mask())
            for (int x = part.x0; x < part.x1; ++x) *row++ = (*canvas.mask())(x, y);
        else
            std::fill_n(row, part.width(), 1.0f);
    }
}

void PaintWindow::take_paint(const PaintLayer& wet, TileIndex at, const Region& part) {
    const auto& tile = wet.tile(at);
    for (int y = part.y0; y < part.y1; ++y)
        std::fill_n(memory_.total.data() + index(part.x0, y), part.width(), 0.0f);
    for (std::size_t i = 0; i < planes_.size(); ++i) {
        const auto plane = tile ? tile->plane(planes_[i]) : std::span<const float>();
        for (int y = part.y0; y < part.y1; ++y) {
            float* row = memory_.paint[i].data() + index(part.x0, y);
            if (plane.empty())
                std::fill_n(row, part.width(), 0.0f);
            else
                take_row(part.width(), plane.data() + in_tile(part.x0, y), row,
                         memory_.total.data() + index(part.x0, y));
        }
    }
}

void PaintWindow::attach(StepBox& box, int x0, int y0) {
    const std::size_t at = index(x0, y0);
    box.relief_mm = memory_.relief.data() + at;
    box.open = memory_.open.data() + at;
    box.total_mm = memory_.total.data() + at;
    box.canvas_stride = stride_;
    box.paint.clear();
    for (std::size_t i = 0; i < planes_.size(); ++i) box.paint.push_back(memory_.paint[i].data() + at);
}

bool PaintWindow::put_back(PaintLayer& wet, TileIndex at, const Region& part) const {
    const auto row_bytes = static_cast<std::size_t>(part.width()) * sizeof(float);
    std::vector<std::size_t> occurring;  // of this window's ingredients, in this tile
    bool changed = false;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
        const auto old = wet.tile(at) ? wet.tile(at)->plane(planes_[i]) : std::span<const float>();
        bool any = !old.empty();
        for (int y = part.y0; y < part.y1 && !(any && changed); ++y) {
            const float* row = memory_.paint[i].data() + index(part.x0, y);
            if (!old.empty())
                changed = changed || std::memcmp(row, old.data() + in_tile(part.x0, y), row_bytes) != 0;
            else if (holds_paint(row, part.width()))
                any = changed = true;
        }
        if (any) occurring.push_back(i);
    }
    if (!changed) return false;
    PaintTile& tile = wet.writable(at);
    bool gone = false;  // the upper film of a paint, from here
    for (const std::size_t i : occurring) {
        const IngredientId id = planes_[i];
        float* plane = tile.writable_plane(id).data();
        bool here = false;
        for (int y = part.y0; y < part.y1; ++y) {
            const float* row = memory_.paint[i].data() + index(part.x0, y);
            std::memcpy(plane + in_tile(part.x0, y), row, row_bytes);
            here = here || holds_paint(row, part.width());
        }
        gone = gone || (is_upper(id) && !here);
    }
    if (gone) tile.drop_empty_upper();
    return true;
}

void PaintWindow::store(Canvas& canvas) const {
    if (on_canvas_.empty()) return;
    PaintLayer& wet = canvas.writable_wet();
    std::vector<Region> changed(tiles_.size(), Region{});
    for_tiles(wet, [&](std::size_t i, const Region& part) {
        if (put_back(wet, tiles_[i], part)) changed[i] = part;
    });
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (!changed[i].empty()) canvas.mark_dirty(tiles_[i], changed[i]);
}

}  // namespace tangi
