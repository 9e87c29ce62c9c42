#include "paint/paint_window.h"

#include <algorithm>
#include <cstring>

#include "surface/parallel.h"
#include "surface/vector_clones.h"

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

// Calls body(tile, part of the region in it) for all tiles of a region that lies on the canvas.
template <class Body>
void for_tiles(const Region& region, const PaintLayer& layer, const Body& body) {
    for (int ty = region.y0 / kTileSize; ty * kTileSize < region.y1; ++ty)
        for (int tx = region.x0 / kTileSize; tx * kTileSize < region.x1; ++tx)
            body(TileIndex{tx, ty}, intersection(region, layer.region_of({tx, ty})));
}

bool holds_paint(const float* row, int n) {
    return std::any_of(row, row + n, [](float mm) { return mm != 0; });
}

std::size_t in_tile(int x, int y) {
    return static_cast<std::size_t>((y % kTileSize) * kTileSize + x % kTileSize);
}

}  // namespace

PaintWindow::PaintWindow(const Canvas& canvas, const Region& region, std::vector<IngredientId> ingredients,
                         int ride_px, bool upper)
    : region_(region),
      on_canvas_(intersection(region, canvas.region())),
      stride_(static_cast<std::size_t>(region.width())),
      ingredients_(std::move(ingredients)) {
    if (on_canvas_.empty()) on_canvas_ = {};
    const auto pixels = stride_ * static_cast<std::size_t>(region.height());
    total_.assign(pixels, 0.0f);
    relief_.assign(pixels, 0.0f);
    open_.assign(pixels, 0.0f);
    if (!on_canvas_.empty())
        for_tiles(on_canvas_, canvas.wet(), [&](TileIndex at, const Region&) {
            const auto& tile = canvas.wet().tile(at);
            if (!tile || tile->ingredients.empty()) return;
            for (const IngredientId id : tile->ingredients) ingredients_.push_back(paint_of(id));
            upper = upper || is_upper(tile->ingredients.back());
        });
    std::sort(ingredients_.begin(), ingredients_.end());
    ingredients_.erase(std::unique(ingredients_.begin(), ingredients_.end()), ingredients_.end());
    for (const IngredientId id : ingredients_) {
        planes_.push_back(id);
        if (upper) planes_.push_back(upper_of(id));
    }
    paint_.assign(planes_.size(), std::vector<float>(pixels, 0.0f));
    if (on_canvas_.empty()) return;
    find_relief(canvas, ride_px);
    find_open(canvas);
    take_paint(canvas.wet());
}

void PaintWindow::find_relief(const Canvas& canvas, int ride_px) {
    const Region wide = intersection(
        {on_canvas_.x0 - ride_px, on_canvas_.y0 - ride_px, on_canvas_.x1 + ride_px, on_canvas_.y1 + ride_px},
        canvas.region());
    const auto stride = static_cast<std::size_t>(wide.width());
    std::vector<float> height(stride * static_cast<std::size_t>(wide.height()), 0.0f), mean(height.size());
    canvas.relief_mm(wide, height.data(), stride);
    constexpr int kLines = 64;  // rows or columns, before a second thread wakes up
    parallel_for(0, wide.height(), kLines, [&](int begin, int end) {
        std::vector<double> padded;
        for (int y = begin; y < end; ++y) {
            const std::size_t row = static_cast<std::size_t>(y) * stride;
            mean_along(height.data() + row, mean.data() + row, wide.width(), ride_px, padded);
        }
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
                           relief_.data() + index(begin, y));
    });
}

void PaintWindow::find_open(const Canvas& canvas) {
    for (int y = on_canvas_.y0; y < on_canvas_.y1; ++y) {
        float* row = open_.data() + index(on_canvas_.x0, y);
        if (canvas.mask())
            for (int x = on_canvas_.x0; x < on_canvas_.x1; ++x) *row++ = (*canvas.mask())(x, y);
        else
            std::fill_n(row, on_canvas_.width(), 1.0f);
    }
}

void PaintWindow::take_paint(const PaintLayer& wet) {
    for_tiles(on_canvas_, wet, [&](TileIndex at, const Region& part) {
        const auto& tile = wet.tile(at);
        if (!tile) return;
        for (std::size_t i = 0; i < planes_.size(); ++i) {
            const auto plane = tile->plane(planes_[i]);
            if (plane.empty()) continue;
            for (int y = part.y0; y < part.y1; ++y)
                take_row(part.width(), plane.data() + in_tile(part.x0, y),
                         paint_[i].data() + index(part.x0, y), total_.data() + index(part.x0, y));
        }
    });
}

void PaintWindow::attach(StepBox& box, int x0, int y0) {
    const std::size_t at = index(x0, y0);
    box.relief_mm = relief_.data() + at;
    box.open = open_.data() + at;
    box.total_mm = total_.data() + at;
    box.canvas_stride = stride_;
    box.paint.clear();
    for (auto& plane : paint_) box.paint.push_back(plane.data() + at);
}

void PaintWindow::store(Canvas& canvas) const {
    if (on_canvas_.empty()) return;
    PaintLayer& wet = canvas.writable_wet();
    for_tiles(on_canvas_, wet, [&](TileIndex at, const Region& part) {
        const auto row_bytes = static_cast<std::size_t>(part.width()) * sizeof(float);
        std::vector<std::size_t> occurring;  // of this window's ingredients, in this tile
        bool changed = false;
        for (std::size_t i = 0; i < planes_.size(); ++i) {
            const auto old = wet.tile(at) ? wet.tile(at)->plane(planes_[i]) : std::span<const float>();
            bool any = !old.empty();
            for (int y = part.y0; y < part.y1 && !(any && changed); ++y) {
                const float* row = paint_[i].data() + index(part.x0, y);
                if (!old.empty())
                    changed = changed || std::memcmp(row, old.data() + in_tile(part.x0, y), row_bytes) != 0;
                else if (holds_paint(row, part.width()))
                    any = changed = true;
            }
            if (any) occurring.push_back(i);
        }
        if (!changed) return;
        PaintTile& tile = wet.writable(at);
        bool gone = false;  // the upper film of a paint, from here
        for (const std::size_t i : occurring) {
            const IngredientId id = planes_[i];
            float* plane = tile.writable_plane(id).data();
            bool here = false;
            for (int y = part.y0; y < part.y1; ++y) {
                const float* row = paint_[i].data() + index(part.x0, y);
                std::memcpy(plane + in_tile(part.x0, y), row, row_bytes);
                here = here || holds_paint(row, part.width());
            }
            gone = gone || (is_upper(id) && !here);
        }
        if (gone) tile.drop_empty_upper();
        canvas.mark_dirty(at, part);
    });
}

}  // namespace tangi
