// alignment_pixels.cpp: the pixels that an alignment looks at.
#include <algorithm>
#include <cmath>

#include "capture/registration/alignment.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kCellSize = 24;  // [pixels of a window] errors are shared inside a cell
constexpr double kKept = 0.2;  // [1] part of a cell's pixels: those with the strongest edges

}  // namespace

// Of the mean of all pictures in the model, as they lie.
Image<float> Alignment::edge_strength(const AlignmentWindow& window) const {
    const int width = window.pictures.front().width(), height = window.pictures.front().height();
    Image<float> strength(width, height);
    parallel_for(0, height, 4, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x) {
                float dx = 0, dy = 0;
                for (std::size_t i = 0; i < pictures.size(); ++i) {
                    if (!in_model_[i]) continue;
                    const glm::dvec2 p = window.origin + window.reduction * glm::dvec2(x, y);
                    const glm::dvec2 q =
                        (mapped(pictures[i].homography, p) - window.origin) / window.reduction;
                    float value, gx, gy;
                    if (!sample_at(window.pictures[i], q, value, gx, gy)) continue;
                    dx += gx;
                    dy += gy;
                }
                strength(x, y) = dx * dx + dy * dy;
            }
    });
    return strength;
}

void Alignment::add_candidates(std::size_t w, std::vector<Cell>& cells) const {
    const AlignmentWindow& window = (*windows_)[w];
    const Image<float> strength = edge_strength(window);
    const int width = strength.width(), height = strength.height();
    const int columns = (width + kCellSize - 1) / kCellSize, rows = (height + kCellSize - 1) / kCellSize;
    const std::size_t first = cells.size();
    cells.resize(first + static_cast<std::size_t>(columns * rows));
    for (int y = 4; y < height - 4; ++y)
        for (int x = 4; x < width - 4; ++x) {
            const auto cell = first + static_cast<std::size_t>((y / kCellSize) * columns + x / kCellSize);
            cells[cell].push_back({strength(x, y),
                                   {.window = static_cast<int>(w),
                                    .cell = static_cast<int>(cell),
                                    .position = window.origin + window.reduction * glm::dvec2(x, y),
                                    .scale = 1}});
        }
}

// About so many pixels: of each cell the same part, those with the strongest edges.
void Alignment::take_strongest(std::vector<Cell>& cells, int pixels) {
    std::size_t candidates = 0;
    for (const Cell& cell : cells) candidates += cell.size();
    const double part = std::min(kKept, pixels / std::max<double>(1, static_cast<double>(candidates)));
    for (Cell& cell : cells) {
        const auto wanted = static_cast<std::ptrdiff_t>(std::ceil(part * static_cast<double>(cell.size())));
        std::partial_sort(cell.begin(), cell.begin() + wanted, cell.end(), [](const auto& a, const auto& b) {
            return a.strength != b.strength                   ? a.strength > b.strength
                   : a.pixel.position.y != b.pixel.position.y ? a.pixel.position.y < b.pixel.position.y
                                                              : a.pixel.position.x < b.pixel.position.x;
        });
        for (std::ptrdiff_t k = 0; k < wanted; ++k)
            if (cell[static_cast<std::size_t>(k)].strength > 0)
                pixels_.push_back(cell[static_cast<std::size_t>(k)].pixel);
    }
}

void Alignment::look_at(const std::vector<AlignmentWindow>& windows, int pixels) {
    windows_ = &windows;
    pixels_.clear();
    std::vector<Cell> cells;
    for (std::size_t w = 0; w < windows.size(); ++w) add_candidates(w, cells);
    cells_ = static_cast<int>(cells.size());
    take_strongest(cells, pixels);
    samples_.assign(pixels_.size() * pictures.size(), {});
    std::fill(scales_.begin(), scales_.end(), 1.0f);
    typical_scale_ = 0.1f;
}

}  // namespace tangi
